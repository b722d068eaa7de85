"""Reef, thief, granny and grief: two strands bent into bights and hooked, one throw on another.

A throw is three half turns of two strands about each other. Here throw 1 lies at y < 0, throw 2 at
y > 0, and the bight of each strand, its apex in the plane y = 0, leads from the first into the second.
Throw 1 is throw 2

- reflected in the plane y = 0, so of the opposite hand: the reef, crossings O U O O U O along A;
- turned by half a turn about x, so of the same hand: the granny, crossings O U O U O U along A.

Strand B is strand A turned by half a turn about y. So a quarter of the tangle, from the apex of the
bight of A to its leg, says everything: five control points of a uniform cubic B-spline, `_THROWS`. The
legs of A run to -x, those of B to +x; A1 and B1, the standing ends, leave throw 2, A0 and B0 throw 1.

Pulled by A1 and B1, or by A0 and B0, the tangles are the reef and the granny; pulled by A1 and B0, or by
A0 and B1, they are the thief and the grief. The pull changes only how the ends are led away.

With both strands oriented from end 0 to end 1 the granny's crossings are all positive (right-handed), as
in the catalogue; the granny and the grief published with the thesis are its mirror images.
"""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from torsade.centerline import Centerline
from torsade.curve import resample
from torsade.errors import TorsadeError, quoted
from torsade.knots.drawing import SAMPLES, SPACING, SPACING_RANGE, in_radii, known_radius, spline

__all__ = ["BENDS", "PULLS", "BuiltBend", "bend", "known_name"]

FloatArray = NDArray[np.float64]

PULLS = ("A1B1", "A1B0", "A0B1", "A0B0")
"""Pairs of ends: the first is clamped, the second pulled."""

_NAMES = MappingProxyType(
    {
        "reef": ("reef", "A1B1"),
        "thief": ("reef", "A1B0"),
        "granny": ("granny", "A1B1"),
        "grief": ("granny", "A1B0"),
    }
)

BENDS = tuple(_NAMES)
"""Names that `bend` knows."""

_OTHER_NAMES = MappingProxyType({"square": "reef", "hercules": "reef", "bread bag": "thief", "what": "grief"})

# Control points [radii] from the apex of the bight of A to its leg, chosen to use the least fiber, to the
# digit given, with strands 2.1 radii apart and radius * kappa below 0.47.
_THROWS = MappingProxyType(
    {
        "reef": ((3.7, 0.0, 3.1), (2.9, 3.5, 1.7), (1.1, 3.2, -1.2), (-1.1, 1.0, -1.1), (-2.8, 1.1, 0.0)),
        "granny": ((5.1, 0.0, 0.0), (3.5, 3.2, -0.2), (0.8, 3.3, 1.3), (-0.9, 1.1, 1.2), (-3.2, 0.8, -2.4)),
    }
)

_OTHER_THROW = MappingProxyType({"reef": (1.0, -1.0, 1.0), "granny": (1.0, -1.0, -1.0)})  # throw 2 → throw 1
_OTHER_STRAND = (-1.0, 1.0, -1.0)  # A → B

_STEP = 2.5  # distance between control points on the way out [radii]
_WAY_OUT = 6  # control points on the way out
_STEPS_TO_AXIS = 4  # of a clamped or pulled end, from its leg to the line of pull
_TAIL_TURN = tuple(math.radians(a) for a in (0, 20, 40, 60, 60, 60))  # of a free end, away from that line

# What slips through the knot comes from the tails: at 15 N in nylon a reef's last for a second. The granny
# tangle lets its tails go faster than the reef's, and starts with longer ones.
_TAIL = 2.5  # lengths of the free ends [leads]
_LEAD = MappingProxyType({"reef": 16.0, "granny": 20.0})  # [radii]
_LEAD_RANGE = (14.0, 1e4)  # [radii]


@dataclass(frozen=True, eq=False)
class BuiltBend(Centerline):
    """A two-strand tangle with free ends, ready to be pulled or written to a file.

    Attributes:
        strands: nodes [m] of strands A and B, shapes (n, 3), each from its end 0 to its end 1.
        name: one of `BENDS`.
        pulled: one of `PULLS`; the first end is clamped at -x, the second pulled along +x.
    """

    name: str = ""
    pulled: str = ""


def bend(
    name: str,
    radius: float | str = 0.2e-3,
    lead: float | str | None = None,
    spacing: float | str | None = None,
    pulled: str | None = None,
) -> BuiltBend:
    """A loose, smooth centerline of one of the `BENDS`.

    The clamped and the pulled end lie on the x axis and leave along it, so nothing turns the knot as a
    whole; the free ends turn away from it by 60°. Nothing touches: parts that are not neighbours are
    2.1 radii apart (2.04 at the coarsest spacing), and radius * kappa stays below 0.48.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        name: one of `BENDS`; upper and lower case are the same.
        radius: fiber radius h [m].
        lead: length from the knot to the clamped end and to the pulled end [m], 14 radii or more; the
            free ends are two and a half times as long. By default 16 radii for reef and thief, 20 for
            granny and grief.
        spacing: greatest distance between nodes along a strand [m], one radius or less; half a radius
            by default.
        pulled: one of `PULLS`, the clamped end first; by default "A1B1" for the reef and the granny,
            "A1B0" for the thief and the grief.

    Raises:
        TorsadeError: a name or a pull that is not in the list, or a length out of range.
    """
    name = known_name(name)
    tangle, usual = _NAMES[name]
    pulled = usual if pulled is None else pulled.strip().upper()
    if pulled not in PULLS:
        raise TorsadeError(
            f"pulled ends {pulled!r} are unknown; choose one of {', '.join(PULLS)}, clamped end first"
        )
    h = known_radius(radius)
    straight = _LEAD[tangle] if lead is None else in_radii("lead", lead, _LEAD_RANGE, h)
    apart = SPACING if spacing is None else in_radii("spacing", spacing, SPACING_RANGE, h)
    a = _strand(tangle, int(pulled[1]), straight)
    b = _strand(tangle, int(pulled[3]), straight) * _OTHER_STRAND
    a, b = (h * resample(x, spacing=apart, method="linear") for x in (a, b))
    return BuiltBend((a, b), name=name, pulled=pulled)


def _strand(tangle: str, pulled: int, lead: float) -> FloatArray:
    """Strand A [radii], sampled finely, from end 0 to end 1; end `pulled` is led out along -x."""
    throw_2 = np.array(_THROWS[tangle])
    throw_1 = throw_2 * _OTHER_THROW[tangle]
    out_1 = _way_out(throw_1[-1], pulled == 0)
    out_2 = _way_out(throw_2[-1], pulled == 1)
    x = spline(np.concatenate([out_1[::-1], throw_1[:0:-1], throw_2, out_2]))
    x = _lengthened(x, out_2, lead if pulled == 1 else _TAIL * lead)
    return _lengthened(x[::-1], out_1, lead if pulled == 0 else _TAIL * lead)[::-1]


def _way_out(leg: FloatArray, pulled: bool) -> FloatArray:
    """Control points [radii] that lead on from the leg of a throw, which runs along -x.

    The last three are on a line: the x axis for a pulled end, one that leaves it for a free end.
    """
    if pulled:
        s = np.minimum(np.arange(1, _WAY_OUT + 1) / _STEPS_TO_AXIS, 1.0)
        off_axis = (1 - s) ** 2 * (1 + 2 * s)
        return np.column_stack(
            [leg[0] - _STEP * np.arange(1, _WAY_OUT + 1), leg[1] * off_axis, leg[2] * off_axis]
        )
    outwards = leg * (0, 1, 1) / math.hypot(leg[1], leg[2])
    turn = np.array(_TAIL_TURN)[:, None]
    steps = np.cos(turn) * (-1, 0, 0) + np.sin(turn) * outwards
    return leg + _STEP * np.cumsum(steps, axis=0)


def _lengthened(x: FloatArray, out: FloatArray, reach: float) -> FloatArray:
    """The curve `x`, which ends on the control points `out`, continued to `reach` [radii] from the leg."""
    ahead = (out[-1] - out[-2]) / np.linalg.norm(out[-1] - out[-2])
    so_far = np.linalg.norm(np.diff(x[-(_WAY_OUT - 1) * SAMPLES - 1 :], axis=0), axis=1).sum()
    return np.concatenate([x, x[-1:] + (reach - so_far) * ahead])


def known_name(name: str) -> str:
    """The name as `BENDS` has it, or an error that says which one is meant or what there is."""
    plain = re.sub(r"[\s_-]+(knot|bend)$", "", name.strip().lower())
    if plain in _NAMES:
        return plain
    near = [_OTHER_NAMES[plain]] if plain in _OTHER_NAMES else difflib.get_close_matches(plain, BENDS, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise TorsadeError(
        f"no bend is called {quoted(name)}; {hint}choose one of {', '.join(BENDS)}, or pull a centerline of "
        "your own (--centerline FILE.csv)"
    )
