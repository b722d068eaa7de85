"""The table that `torsade topology` prints for people."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

from torsade.errors import counted
from torsade.topology.diagram import strand_name

__all__ = ["rows"]


TITLED = ("bend", "strand", "suture", "torus", "variant")
"""Kinds of things whose title says more than their name."""


def rows(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and values of a report."""
    yield from _what(found)
    yield from _counts(found)
    if found["ends"]:
        yield from _tangle(found)
    else:
        yield from _closed(found)
    if found["projection"]:
        yield from _space(found)


def _what(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    read = (
        "" if not found["kind"].endswith(("code", "word", "centerline")) else f", read as a {found['kind']}"
    )
    yield "given", found["input"] + read
    if found["kind"] in TITLED:
        yield found["kind"], found["title"]
    if found["names"] is not None:
        yield "name" if not found["ends"] else "closed", _name(found)
        if found["reason"]:
            yield "", found["reason"]
    for note in found["notes"]:
        yield "note", note
    open_strands = len(found["ends"]) // 2
    closed = found["strands"] - open_strands
    parts = [
        *([f"{open_strands} open, ends {' '.join(found['ends'])} around it"] if open_strands else []),
        *([f"{closed} closed"] if closed else []),
    ]
    yield "strands", ", ".join(parts)
    if found["pulled"]:
        name = next((p["name"] for p in found["pulls"] if p["pulled"] == found["pulled"]), None)
        yield "pulled", found["pulled"] + (f": {name}" if name else "")


def _counts(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    n, wr = found["crossings"], found["writhe"]
    right = found["charges"].count(1)
    hands = f", {right} right-handed and {n - right} left-handed" if n else ""
    led = found["projection"]["led_out"] if found["projection"] else 0
    yield "crossings N", f"{n}{hands}" + (f"; {led} made by leading out ends" if led else "")
    yield "writhe Wr", _signed(wr)
    if found["linking"]:
        yield "linking, half-sum", _matrix(found["linking"])
    yield "twist fluctuation tau", f"{found['tau']:.4g}"
    outside = ", the longest face taken to lie outside" if found["outside"] == "longest face" else ""
    yield "circulation Gamma", f"{found['circulation']:.4g}{outside}"
    spread = found["circulation_range"]
    if spread:
        yield "", _spread(spread)
    yield "Whitney index", _signed(found["whitney"])
    fewest = found["fewest"]
    if fewest["crossings"] < n:
        yield (
            "with fewest crossings",
            f"N {fewest['crossings']}, Wr {_signed(fewest['writhe'])}, tau {fewest['tau']:.4g}, "
            f"Gamma {fewest['circulation']:.4g}, Whitney {_signed(fewest['whitney'])}",
        )


def _spread(spread: dict[str, Any]) -> str:
    low, high = f"{spread['least']:.4g}", f"{spread['greatest']:.4g}"
    drawn = f"{counted(spread['drawings'], 'drawing')} of {counted(spread['crossings'], 'crossing')}"
    value = low if low == high else f"{low} to {high}"
    more = "all that were found" if spread["complete"] else "there may be more: see --drawings"
    return f"{value} over {drawn}, ends swinging freely; {more}"


def _tangle(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for pull in found["pulls"]:
        if pull["pulled"] != found["pulled"]:
            name = f": {pull['name']}" if pull["name"] else ""
            numbers = (
                f"Wr {_signed(pull['writhe'])}, tau {pull['tau']:.4g}, "
                f"Gamma {pull['circulation']:.4g}, Whitney {_signed(pull['whitney'])}"
            )
            yield f"  pulled {pull['pulled']}", f"{numbers}{name}"
    yield from _strands(found["strand_types"])
    if found["alexander"]:
        yield from _invariants(found)
    for closure in found["closures"] if len(found["closures"]) > 1 else ():
        lk = f", Lk {_signed(closure['linking'][0][1])}" if _is_pair(closure["linking"]) else ""
        yield f"joined {' '.join(closure['joins'])}", _name(closure) + lk


def _strands(types: Iterable[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    for k, one in enumerate(types):
        yield f"strand {strand_name(k)} alone", _name(one)


def _is_pair(linking: list[list[int]] | None) -> bool:
    return linking is not None and len(linking) == 2


def _closed(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield from _strands(found["strand_types"] or ())
    yield from _invariants(found)


def _invariants(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield "Alexander polynomial", found["alexander"]["text"]
    yield "determinant", str(found["determinant"])
    yield "signature", _signed(found["signature"])
    yield "Jones polynomial", found["jones"]["text"] if found["jones"] else "not computed: too wide"
    if found["fewest"]["crossings"] and found["codes"]["conway"]:
        yield "Conway notation", found["codes"]["conway"]
    if found["fewest"]["crossings"] and found["codes"]["dt"]:
        yield "Dowker-Thistlethwaite", found["codes"]["dt"].removeprefix("DT: ")


def _space(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    seen = found["projection"]
    direction = ", ".join(f"{x:.3g}" for x in seen["direction"])
    refused = len(seen["refused"])
    others = f" ({counted(refused, 'direction')} showed no clear drawing)" if refused else ""
    yield "seen along", f"({direction}){others}"
    yield "writhe in space", f"{found['writhe_3d']:+z.4f}"
    yield "average crossing number", f"{found['acn']:.4f}"
    if found["linking_3d"]:
        yield "linking in space", _matrix(found["linking_3d"])
    for k, fractions in enumerate(found["closed_at_infinity"]):
        if fractions:
            shares = ", ".join(
                f"{_shown(name)} {100 * share:.0f} %" for name, share in list(fractions.items())[:4]
            )
            yield f"strand {strand_name(k)}, at infinity", shares


def _name(one: dict[str, Any]) -> str:
    """The names, and whether they are proven."""
    if not one["names"]:
        return "not in the table"
    names = " or ".join(map(_shown, one["names"]))
    return names if one["certain"] else f"{names} (not certain)"


def _shown(name: str) -> str:
    """A name as people read it: the unknot is called so."""
    return re.sub(r"(?<!\d)0_1(?!\d)", "unknot", name)


def _matrix(rows: list[list[float]]) -> str:
    """The numbers above the diagonal, with the strands they belong to if there are several."""
    pairs = [(i, j) for i in range(len(rows)) for j in range(i + 1, len(rows))]
    if len(pairs) == 1:
        return _signed(rows[0][1])
    return ", ".join(f"{strand_name(i)}-{strand_name(j)}: {_signed(rows[i][j])}" for i, j in pairs)


def _signed(number: float) -> str:
    return f"{number:+.4g}" if number else "0"
