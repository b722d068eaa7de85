"""The pulled bends that the figures of chapter 4 share: what is run, and one table of all that is measured.

27 of them: the 22 variants of the thesis and five further bends of the catalogue, as `--knot LABEL` pulls
them, so that no figure runs what another has run.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures.base import Cell, Choice, Preset, Table
from torsade.knots.entries import variants
from torsade.knots.finding import find
from torsade.protocols.prison_escape import PrisonEscape
from torsade.topology.canonical import canonical_form
from torsade.topology.counting import Range, State, circulation_range, state
from torsade.topology.diagram import Diagram
from torsade.topology.simplify import simplify

if TYPE_CHECKING:
    import xarray

    from torsade.results import Result

__all__ = [
    "BY_CHANCE",
    "COLUMNS",
    "FURTHER",
    "QUICK",
    "counts",
    "distinct",
    "drawn",
    "family",
    "fewest_crossings",
    "gamma_range",
    "kinds",
    "label_of",
    "labels",
    "over_window",
    "specs",
    "table",
    "window",
]

FURTHER = ("water_knot", "figure_eight_bend", "fisherman", "double_fisherman", "zeppelin_min10")
"""Bends of the catalogue that the thesis does not pull."""

QUICK = ("reef", "thief", "granny", "grief", "carrick14")
"""Bends of a quick look, pulled for `QUICK_DURATION` [s]."""

QUICK_DURATION, QUICK_FRAMES = 0.02, 4

PULLED_OTHERWISE: Mapping[str, str] = {"thief": "reef", "grief": "granny"}

BY_CHANCE = ("reef",)
"""Bends that turned round are themselves, and that give in either way: which one, and so their twist and how
far they turn, rounding decides, so that these move by radians as mesh or tolerance are refined."""

DRAWINGS = 200
"""Drawings looked at for the range of Gamma; with 2000, ten times slower, no range of the 27 is wider."""

COLUMNS = (
    "knot",
    "preset",
    "pulled",
    "N",
    "N_fewest",
    "Wr",
    "tau",
    "Gamma",
    "Gamma_least",
    "Gamma_greatest",
    "Whitney",
    "c_f",
    "pull_speed_m_per_s",
    "c_f_from_s",
    "slipped_at_s",
    "holds",
    "compression_N",
    "twist_A_rad",
    "twist_B_rad",
    "log_strain_max",
    "rotation_rad",
)
"""What `table` tells of each bend and preset.

N and Gamma are those of the catalogue's drawing; N_fewest, Gamma_least and Gamma_greatest belong to drawings
with the fewest crossings that moves lead to, so that Gamma may lie outside. pull_speed and compression (the
sum over all edges of the contact forces on them) are means over the same time, from c_f_from_s to the end or
to slipping; twist, the largest log strain and the rotation of the knot's body are those at its end.
"""


def labels(choice: Choice) -> tuple[str, ...]:
    """Catalogue names of the bends that are pulled."""
    return QUICK if choice.quick else (*variants(), *FURTHER)


def specs(choice: Choice, chosen: Iterable[str] | None = None) -> dict[str, PrisonEscape]:
    """What is run: every bend, or those chosen, with every preset; see `label_of` for the labels."""
    short = {"duration": QUICK_DURATION, "frames": QUICK_FRAMES} if choice.quick else {}
    wanted = labels(choice) if chosen is None else [k for k in chosen if k in labels(choice)]
    return {
        label_of(knot, preset): PrisonEscape(knot=knot, preset=preset, **short)
        for preset, knot in product(choice.presets, wanted)
    }


def label_of(knot: str, preset: Preset) -> str:
    """The label of a run, such as "reef, published"."""
    return f"{knot}, {preset}"


@lru_cache(maxsize=64)
def drawn(knot: str) -> Diagram:
    """The catalogue's drawing of a bend, strands running towards the pulled ends."""
    entry = find(knot)
    return entry.diagram.pulled(str(entry.pulled))


@lru_cache(maxsize=64)
def counts(knot: str) -> State:
    """What is counted on that drawing."""
    return state(drawn(knot))


@lru_cache(maxsize=64)
def gamma_range(knot: str) -> Range:
    """Gamma over drawings of the same pulled bend with so few crossings."""
    return circulation_range(simplify(drawn(knot)), limit=DRAWINGS)


def fewest_crossings(knot: str) -> int:
    """The fewest crossings that moves, of the ends too, take that drawing to."""
    return gamma_range(knot).crossings


def kinds(knots: Iterable[str]) -> dict[str, str]:
    """Each bend's namesake: the first of those that are certainly the same, mirror images included.

    Two are the same when their simplest drawings are, with pulled and free ends where the other has them;
    which end is clamped and which strand is called A does not matter, nor from which side one looks.
    """
    first: dict[object, str] = {}
    return {knot: first.setdefault(_kind(knot), knot) for knot in knots}


@lru_cache(maxsize=64)
def _kind(knot: str) -> object:
    """A value that the same bends share: the smallest of what their symmetric images are written as."""
    simplest, pulled = simplify(drawn(knot)), str(find(knot).pulled)
    forms = []
    for strands in ("AB", "BA"):
        named = str.maketrans("AB", strands)
        role = [f"{end[0].translate(named)}{int(end in (pulled[:2], pulled[2:]))}" for end in simplest.ends]
        one = simplest.renamed(role)
        forms += [canonical_form(d) for d in (one, one.mirror(), one.reflected(), one.mirror().reflected())]
    return min(forms, key=str)


def window(data: xarray.Dataset) -> tuple[float, float]:
    """From when to when c_f and the pull speed are means [s]."""
    slipped = data.attrs.get("slipped_at_s")
    end = data["sample_time"].values[-1] if slipped is None else slipped
    return float(data.attrs.get("c_f_from_s", 0.0)), float(end)


def over_window(data: xarray.Dataset, name: str) -> float:
    """The mean over that time of a history that is linear between frames."""
    start, end = window(data)
    t = data["time"].values
    inside = t[(t > start) & (t < end)]
    at = np.concatenate([[start], inside, [end]])
    values = np.interp(at, t, data[name].values)
    return float(np.trapezoid(values, at) / (end - start)) if end > start else float(values[0])


def table(results: Mapping[str, Result], choice: Choice) -> Table:
    """All that is counted and measured, one row for each bend and preset that was run, strongest first."""
    rows: list[tuple[Cell, ...]] = []
    for preset in choice.presets:
        found = [(k, results[label_of(k, preset)]) for k in labels(choice) if label_of(k, preset) in results]
        found.sort(key=lambda pair: -(pair[1].c_f or 0.0))
        rows += [_row(knot, result) for knot, result in found]
    return Table(COLUMNS, rows)


def family(knot: str) -> str:
    """The knot that a bend is, however it is pulled: "hunter" of hunter13 and of hunter14."""
    return PULLED_OTHERWISE.get(knot, knot.rstrip("0123456789").removesuffix("_min"))


def distinct(table: Table, preset: Preset) -> dict[str, dict[str, list[Any]]]:
    """Columns of a table like `table`, of one preset, each bend once though some have several names.

    "thesis": its variants. "phase diagram": those of them that its figure 4-5G shows, pulled by their first
    strand's end 1 and the second's 3 or 4. "all": further ones too. What would repeat another is left out.
    """
    rows = [row for row in table.rows if row[table.columns.index("preset")] == preset]
    at, c_f = table.columns.index("knot"), table.columns.index("c_f")
    same = kinds(knot for knot in (*variants(), *FURTHER) if knot in {row[at] for row in rows})
    single = [row for row in rows if same[str(row[at])] == row[at] and row[c_f] is not None]
    thesis = [row for row in single if row[at] in variants()]
    shown = [row for row in thesis if str(row[at])[-2:] not in ("23", "24")]
    found = {"thesis": thesis}
    found |= {"phase diagram": shown} if len(shown) < len(thesis) else {}
    found |= {"all": single} if len(single) > len(thesis) else {}
    return {
        which: {name: [row[k] for row in chosen] for k, name in enumerate(table.columns)}
        for which, chosen in found.items()
    }


def _row(knot: str, result: Result) -> tuple[Cell, ...]:
    """A row of the table."""
    data, counted, spread = result.dataset, counts(knot), gamma_range(knot)
    _, end = window(data)
    twist = [float(np.interp(end, data["time"].values, angle)) for angle in data["twist"].values.T]
    rotation = data["rotation"].values if "rotation" in data else None
    return (
        knot,
        str(result.spec["preset"]),
        str(data.attrs["pulled"]),
        counted.crossings,
        fewest_crossings(knot),
        counted.writhe,
        counted.tau,
        counted.gamma,
        spread.least,
        spread.greatest,
        counted.whitney,
        result.c_f,
        _number(data, "pull_speed_m_per_s"),
        _number(data, "c_f_from_s"),
        result.slipped_at,
        result.slipped_at is None,
        over_window(data, "compression"),
        *twist,
        float(data["log_strain"].values[result.last_held].max()),
        None if rotation is None else float(np.interp(end, data["time"].values, rotation)),
    )


def _number(data: xarray.Dataset, name: str) -> float | None:
    value = data.attrs.get(name)
    return None if value is None else float(value)
