"""Tight knots: the shortest closed fiber of a given radius that makes a knot or a link.

Length is made smallest under the constraint that a tube of the radius h fits around the fiber: no part comes
nearer to another than 2h, none bends more sharply than 1/h. L/h of the shape found is an upper bound of the
ropelength of its knot (other books divide by the diameter, and have half of it). The method is in `shrink`,
what is measured in `ropelength`, and the search for a better shape in `shake`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Floats, Ints
from torsade.centerline import Centerline
from torsade.curve import length, smooth
from torsade.errors import TorsadeError
from torsade.knots.ropelength import thickness
from torsade.knots.shake import Strands, inverted, loosened, shaken, spaced
from torsade.knots.shrink import Relaxed, Settings, loops_of, relax
from torsade.topology.identify import identify_curves

__all__ = ["Interrupted", "TightKnot", "tighten"]

SPACING = 0.2
"""Edges of the final polygon [radii]; see the convergence study in docs/tight.md."""

TRIES = 14
"""Shapes looked at besides the first, by inversion and by shaking in turn."""

TOLERANCE = 3e-3
"""Residual force per force of tension."""

_COARSE = 0.7
_COARSE_STIFFNESS = 30.0
_COARSE_TOLERANCE = 2e-2
_CHANGES = 4
_ROUND = 10  # steps before nodes are spread anew, while the curve shrinks much
_MOST_ROUNDS = 60
_LONG_STEP = 0.8
_SHORT_STEP = 0.3
_FINE_STEPS = 25
_SWELL = 1.5  # before shaking
_SHAKE = 0.9  # of the radius swollen so: strands are two of them apart
_TREMBLE = 0.3  # [radii]: of the first shape and of inverted ones, so that no symmetry holds them
_WAVES = 6
_LONGEST_INVERTED = 4.0  # times the length before
_WORTH = 1.03  # times the best: what is longer is not gone on from
_SMOOTHING = (0.5, 0.25, 0.1, 0.0)  # scales, in half distances of strands
_LONGEST = 3000.0
_LOOSER = 1.3  # than a ropelength that is asked for, at the start
_NEARLY = 1.05  # times it: from there on nodes stand as in the result
_SPACING_RANGE = (0.03, 0.5)

Progress = Callable[[float, str], None]


@dataclass(frozen=True, eq=False)
class TightKnot:
    """A knot or link pulled tight.

    Attributes:
        strands: nodes [m] of closed polygons, shapes (n, 3). The shape is that of their inscribed arcs
            (`thickness`), which touch the edges halfway; the polygons themselves are longer by 0.1 %.
        radius: h [m], the reach of the shape.
        length: L [m] of all strands.
        bend: smallest radius of curvature [m], h or more.
        contacts: pairs of nodes (m, 2), counted through all strands, where the fiber presses on itself.
        forces: with which it does (m,), in units of the tension.
        kinks: nodes (k,) where the curvature is as large as the radius allows.
        residual: force that is not balanced per force of tension, both as root mean squares over nodes: 0 at
            a critical shape.
        iterations: Newton steps at the final resolution.
        reached: whether a ropelength that was asked for has been reached; True if none was. The knot is then
            not tight: `contacts`, `kinks` and `residual` are those of a moment on the way.
    """

    strands: tuple[Floats, ...]
    radius: float
    length: float
    bend: float
    contacts: Ints
    forces: Floats
    kinks: Ints
    residual: float
    iterations: int
    reached: bool = True

    @property
    def ropelength(self) -> float:
        """L/h, an upper bound of the ropelength of this knot."""
        return self.length / self.radius

    @property
    def centerline(self) -> Centerline:
        """The strands, closed."""
        return Centerline(self.strands, (True,) * len(self.strands))


class Interrupted(KeyboardInterrupt):
    """Tightening was stopped; `best` is the best shape found so far."""

    def __init__(self, best: TightKnot) -> None:
        super().__init__("interrupted while tightening")
        self.best = best


def tighten(
    strands: Sequence[ArrayLike],
    *,
    radius: float = 1.0,
    nodes: int | None = None,
    ropelength: float | None = None,
    tries: int = TRIES,
    tolerance: float = TOLERANCE,
    seed: int = 0,
    progress: Progress | None = None,
) -> TightKnot:
    """Shrink closed strands until they are tight, and keep the shortest shape found.

    The knot stays what it is: each step is shorter than 0.4 times the distance of strands, and the knot is
    named before and after. With the same arguments the result is the same to the bit.

    Args:
        strands: nodes of closed curves, shapes (n, 3), in any unit; they need not be smooth.
        radius: h [m] of the result.
        nodes: of the result, all strands together; by default one every fifth of the radius.
        ropelength: stop where L/h falls to this value, with the fiber in contact or at its sharpest bend. A
            curve that is shorter is first made longer. `reached` is False if the knot is tight before.
        tries: how many other shapes to look at on the way; with 0 it is a matter of luck which of several
            local minima is found. Where a ropelength is given, only if the first does not get there.
        tolerance: residual at which Newton's method stops.
        seed: of the random numbers that other shapes come from.
        progress: called with the share done and what is being done.

    Raises:
        TorsadeError: no strand, one that is not closed or passes through itself; a radius, ropelength, number
            of nodes or tries out of range.
        Interrupted: by Ctrl-C, once there is a shape to keep.
    """
    _check(radius, nodes, ropelength, tries, tolerance)
    tell = progress or (lambda share, note: None)
    tell(0.0, "smoothing")
    given = [np.array(x, dtype=np.float64) for x in strands]
    loose, names = _smoothed(given)
    if ropelength is not None:
        stopped = _stopped(loose, ropelength, radius, nodes, tell)
        if stopped is not None:
            return stopped
    tell(0.05, "shrinking")
    best, found = _coarse(shaken(spaced(loose, _COARSE), _TREMBLE, _WAVES, np.random.default_rng(seed)))
    try:
        best, found = _search(best, found, names, tries, seed, tell)
        if ropelength is not None:
            stopped = _stopped(best, ropelength, radius, nodes, tell)
            if stopped is not None:
                return stopped
        tight = _finished(best, names, radius, nodes, tolerance, tell)
        return replace(tight, reached=ropelength is None)
    except KeyboardInterrupt:
        raise Interrupted(_result(best, found, radius)) from None


def _check(radius: float, nodes: int | None, ropelength: float | None, tries: int, tolerance: float) -> None:
    if not 0 < radius < np.inf:
        raise TorsadeError(f"the radius of the fiber is {radius:g} m; give a finite length above 0")
    if nodes is not None and not 3 * 16 <= nodes <= 4000:
        raise TorsadeError(f"{nodes} nodes are asked for; give 48 to 4000")
    if ropelength is not None and not 2 * np.pi < ropelength <= _LONGEST / 10:
        raise TorsadeError(
            f"the ropelength asked for is {ropelength:g}; give a number above 2 pi, that of a circle, "
            f"and up to {_LONGEST / 10:g}"
        )
    if tries < 0:
        raise TorsadeError(f"{tries} tries are asked for; give 0 or more")
    if not 0 < tolerance < 1:
        raise TorsadeError(f"the tolerance is {tolerance:g}; give a number between 0 and 1, such as 3e-3")


def _smoothed(given: Strands) -> tuple[Strands, tuple[str, ...]]:
    """The curves at radius one, smoothed as far as it makes them thicker and leaves the knot; and its
    names."""
    names = _names(given)
    measured = thickness(given, 1)
    scale = measured.half_distance if np.isfinite(measured.half_distance) else measured.length / (2 * np.pi)
    if not scale > 0:
        raise TorsadeError("the curve passes through itself; move its strands apart")
    best, shortest = given, np.inf
    for share in _SMOOTHING:
        curves = spaced([smooth(x, share * scale, True) for x in given], 0.2 * scale)
        found = thickness(curves, 1)
        if found.ropelength < shortest and _names(curves) == names:
            best, shortest = [x / found.radius for x in curves], found.ropelength
    if shortest > _LONGEST:
        raise TorsadeError(
            f"the curve has L/h = {shortest:.0f} even when smoothed, too much to shrink; give one with L/h "
            f"up to {_LONGEST:g}, without near misses"
        )
    return best, names


def _names(strands: Strands) -> tuple[str, ...]:
    return identify_curves(strands).names


def _relaxed(strands: Strands, how: Settings) -> tuple[Strands, Relaxed]:
    sizes = np.array([len(x) for x in strands])
    found = relax(np.concatenate(strands), loops_of(sizes), how)
    return np.split(found.x, np.cumsum(sizes)[:-1]), found


def _whole(strands: Strands) -> float:
    return sum(length(x, True) for x in strands)


def _coarse(strands: Strands) -> tuple[Strands, Relaxed]:
    """Shrunk with few nodes, spread anew as the curve shortens."""
    how = Settings(_COARSE_STIFFNESS, _LONG_STEP, _ROUND, _COARSE_TOLERANCE, _CHANGES)
    last = np.inf
    for _ in range(_MOST_ROUNDS):
        strands, found = _relaxed(strands, how)
        now = _whole(strands)
        if found.residual < _COARSE_TOLERANCE or now > 0.9995 * last:
            break
        last = now
        strands = spaced(strands, _COARSE)
    return strands, found


def _search(
    best: Strands, found: Relaxed, names: tuple[str, ...], tries: int, seed: int, tell: Progress
) -> tuple[Strands, Relaxed]:
    """The best of other shapes, each made from one before it that was hardly longer than the best."""
    random = np.random.default_rng([seed, 1])
    current = best
    for k in range(tries):
        tell(0.1 + 0.6 * k / tries, f"L/h about {_whole(best):.2f}")
        if k % 2 == 0:
            start = inverted(current, _LONGEST_INVERTED * _whole(current), random)
            if start is None:
                continue
            start = shaken(spaced(start, _COARSE), _TREMBLE, _WAVES, random)
        else:
            swollen = spaced([_SWELL * x for x in current], _COARSE)
            start = shaken(swollen, _SHAKE * _SWELL, _WAVES, random)
        other, result = _coarse(start)
        if result.energy < _WORTH * found.energy and _names(other) == names:
            current = other
            if result.energy < found.energy:
                best, found = other, result
    return best, found


def _finished(
    strands: Strands,
    names: tuple[str, ...],
    radius: float,
    nodes: int | None,
    tolerance: float,
    tell: Progress,
) -> TightKnot:
    """Tightened at the final resolution, with constraints made stiffer step by step."""
    spacing = _final_spacing(strands, nodes)
    if spacing < 0.3:
        strands, _ = _relaxed(spaced(strands, 0.35), Settings(100.0, _SHORT_STEP, _FINE_STEPS, tolerance))
    strands = spaced(strands, spacing)
    iterations = 0
    for k, stiffness in enumerate(_stiffnesses(spacing)):
        tell(0.75 + 0.08 * k, f"L/h about {_whole(strands):.2f}, {sum(map(len, strands))} nodes")
        strands, found = _relaxed(strands, Settings(stiffness, _SHORT_STEP, _FINE_STEPS, tolerance))
        iterations += found.iterations
    if _names(strands) != names:
        raise TorsadeError(
            "the knot changed while it was tightened, which is a fault of the program; please report the "
            "curve"
        )
    return _result(strands, found._replace(iterations=iterations), radius)


def _final_spacing(strands: Strands, nodes: int | None) -> float:
    spacing = SPACING if nodes is None else _whole(strands) / nodes
    low, high = _SPACING_RANGE
    if not low <= spacing <= high:
        raise TorsadeError(
            f"{nodes} nodes would stand {spacing:.2g} radii apart; give {_whole(strands) / high:.0f} to "
            f"{_whole(strands) / low:.0f} for this knot"
        )
    return spacing


def _stiffnesses(spacing: float) -> tuple[float, float, float]:
    """Overlaps shall be as small as the square of the spacing."""
    last = 120 / spacing**2
    return last / 10, last / 3, last


def _result(strands: Strands, found: Relaxed, radius: float) -> TightKnot:
    """The shape scaled to the radius, as measured."""
    measured = thickness(strands)
    scale = radius / measured.radius
    scaled = tuple(scale * x for x in strands)
    for x in scaled:
        x.flags.writeable = False
    return TightKnot(
        strands=scaled,
        radius=radius,
        length=scale * measured.length,
        bend=scale * measured.bend,
        contacts=found.contacts,
        forces=found.forces,
        kinks=found.kinks,
        residual=found.residual,
        iterations=found.iterations,
    )


def _stopped(
    loose: Strands, ropelength: float, radius: float, nodes: int | None, tell: Progress
) -> TightKnot | None:
    """Shrunk until L/h is what was asked for, None if it stays above; the last step is divided."""
    strands = spaced(loosened(loose, _LOOSER * ropelength), _COARSE)
    step = Settings(_COARSE_STIFFNESS, _LONG_STEP, 1, _COARSE_TOLERANCE, _CHANGES)
    for _ in range(_MOST_ROUNDS * _ROUND):
        after = spaced(_relaxed(strands, step)[0], _COARSE)
        near = thickness(spaced(after, SPACING), 1).ropelength < _NEARLY * ropelength
        if near or _whole(after) > 0.9999 * _whole(strands):
            break
        strands = after
    strands = spaced(strands, _final_spacing(strands, nodes))
    step = Settings(_stiffnesses(SPACING)[0], _SHORT_STEP, 1, _COARSE_TOLERANCE)
    for _ in range(_MOST_ROUNDS):
        tell(0.1, f"L/h about {_whole(strands):.2f}")
        after, found = _relaxed(strands, step)
        if thickness(after).ropelength <= ropelength:
            return _result(_between(strands, after, ropelength), found, radius)
        if found.residual < _COARSE_TOLERANCE or _whole(after) > 0.99999 * _whole(strands):
            break
        strands = after
    return None


def _between(longer: Strands, shorter: Strands, ropelength: float) -> Strands:
    """Between two shapes, the one that has this ropelength."""
    low, high = 0.0, 1.0
    for _ in range(40):
        share = (low + high) / 2
        shape = [a + share * (b - a) for a, b in zip(longer, shorter, strict=True)]
        if thickness(shape).ropelength > ropelength:
            low = share
        else:
            high = share
    return shape
