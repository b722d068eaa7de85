"""Movies of fibers in motion: one camera that stays, tubes that move, time and scale on every picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.curve import perpendicular
from torsade.errors import TorsadeError
from torsade.stopping import Patience
from torsade.view.battery import bar_of_density, density_colour
from torsade.view.camera import SAMPLE, View, best_side, frame, knot_body, level_right
from torsade.view.captions import EVER_FASTER, Captions, Clock, Ring, pace
from torsade.view.cascade import THICKER
from torsade.view.colours import strain_colour, strand_colour, stress_colour
from torsade.view.encode import ENDINGS, encoder
from torsade.view.moments import Moment, Moments, colours_of
from torsade.view.overlay import STRAIN, STRESS
from torsade.view.scene import lit_by_lamp, shadow_pieces
from torsade.view.skin import FROM_ABOVE, Skin, skin_colour, skin_over_time
from torsade.view.stage import Stage
from torsade.view.tube import SmoothCurve, divisions, smooth_centerline, tube

if TYPE_CHECKING:
    import xarray

__all__ = ["COLOURS", "movie", "sides"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Pixels = NDArray[np.uint8]

COLOURS = ("strain", "stress", "energy", "strands")
"""What colours can say: strain of fibers, stress over strength of rods that break, energy per length of
batteries, which strand or piece."""

PALETTES = {"strain": strain_colour, "stress": stress_colour, "energy": density_colour}

SIZE, FPS, SECONDS = (1280, 720), 30.0, 8.0

LEAD, TAIL = 0.08, 0.08
"""How long a rod is seen before it breaks, and the last moment of any movie, as shares of the movie."""

FLASH = 0.05
"""How long a break is marked, as a share of the movie."""

SIDES, SPACING, ROUNDING = 24, 0.4, 0.3
"""Of tubes: vertices around, distance of rings and radius of the edges of caps, in radii."""

WIDE, HIGH = 0.82, 0.68
"""Largest shares of the frame's width and height that what is shown takes."""

ALONG, ACROSS = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
"""The sides from which a rod bent in its device, and moves, are seen."""

LOOKED_AT = 40
"""Moments that the camera of a knot is chosen by."""


def movie(
    dataset: xarray.Dataset,
    path: str | Path,
    *,
    seconds: float = SECONDS,
    fps: float = FPS,
    size: tuple[int, int] = SIZE,
    frames: tuple[int, int] | None = None,
    colour: str | None = None,
    whole: bool = False,
    progress: Callable[[float, str], None] | None = None,
) -> Path:
    """Write a movie of a result that goes on in time, such as a knot being pulled or a rod that breaks.

    Time runs evenly, of batteries ever faster; between stored frames nodes move straight. The camera stays
    where it is. Rods that break are drawn three times as thick as they are, as in their pictures.

    Parameters
    ----------
    dataset : with `position (time, node, space)` [m]
    path : the file to write: .mp4 (H.264, plays everywhere) or .gif
    seconds : how long the movie lasts
    fps : pictures a second
    size : width and height [pixels], rounded to multiples of 16
    frames : first and last stored frame to show, from 0, or from the last one if negative; without it all, or
        of a rod that breaks those from just before its first break on
    colour : `strain`, `stress` over strength, `energy` per length, or `strands`, one colour for each strand
        or piece; by default strain, stress of rods that break, energy of batteries
    whole : hold all of every fiber in view, not the knot alone
    progress : called with the share done and what is going on

    Returns
    -------
    The path of the file.

    Raises
    ------
    TorsadeError
        When there is nothing that moves, an option makes no sense, or the file cannot be written.
    """
    path, tell = Path(path), progress or (lambda share, note: None)
    pictures = _pictures(path, seconds, fps)
    Moments(dataset, frames)  # refuses what cannot be shown
    colour = _colour(dataset, colour)
    moments = Moments(dataset, frames, None if colour == "strands" else colour)
    shots = list(_shots(moments, pictures))
    skin = skin_over_time(dataset)
    shooting = _Shooting(moments, sides(size), colour, whole, _held(dataset), skin)
    captions = _captions(dataset, moments, shooting, colour, seconds)
    # A signal that comes while others draw would be lost in what they call back.
    with (
        Patience(lambda: None) as patience,
        encoder(path, shooting.view.size, fps) as add,
        Stage(shooting.view, samples=8, glass=0 if skin is None else 2) as stage,
    ):
        for k, shot in enumerate(shots):
            tell(k / pictures, f"picture {k + 1} of {pictures}")
            moment = moments.before_the_break() if shot.before else moments.at(shot.time)
            picture = shooting.picture(stage, moment)
            note = moments.note(shot.time)
            add(captions.on(picture, shot.time - moments.origin, note, shooting.rings(moment, shot)))
            patience.end()
    return path


def _captions(
    dataset: xarray.Dataset, moments: Moments, shooting: _Shooting, colour: str, seconds: float
) -> Captions:
    """What is written on the pictures."""
    begin, end = (float(moments.times[k]) - moments.origin for k in (0, -1))
    if moments.battery:
        clock, how = Clock.in_units(float(dataset.attrs["T0_s"]), "$T_0$", begin, end), EVER_FASTER
    else:
        shares = LEAD * moments.broken_at_first + TAIL
        clock, how = Clock.over(begin, end), pace(seconds * (1.0 - shares) / (end - begin))
    bar = bar_of_density(dataset) if colour == "energy" else {"strain": STRAIN, "stress": STRESS}.get(colour)
    return Captions(shooting.view, shooting.unit, clock, how, bar)


def sides(size: tuple[int, int]) -> tuple[int, int]:
    """A width and a height [pixels] rounded to multiples of 16, as codecs want them.

    Raises
    ------
    TorsadeError
        When they are not from 64 to 8192.
    """
    width, height = (16 * round(side / 16) if math.isfinite(side) else 0 for side in size)
    if not (64 <= width <= 8192 and 64 <= height <= 8192):
        raise TorsadeError(
            f"the size of the movie is {size[0]} x {size[1]}; give a width and a height from 64 to 8192 "
            "pixels, such as 1280x720"
        )
    return width, height


class _Shot(NamedTuple):
    """One picture: the time it shows [s], whether before the break there, and how old breaks are by then.

    `ages` are in movies, by number of the break, of those that happened.
    """

    time: float
    before: bool
    ages: list[float]


def _shots(moments: Moments, pictures: int) -> Iterator[_Shot]:
    """What every picture of the movie shows: a rod before it breaks, motion, the end."""
    lead = LEAD if moments.broken_at_first else 0.0
    moving = 1.0 - lead - TAIL
    when = [lead + moving * moments.share(b.time) for b in moments.breaks]
    for k in range(pictures):
        at = k / max(pictures - 1, 1)
        share = min(max((at - lead) / moving, 0.0), 1.0)
        yield _Shot(moments.when(share), at < lead, [at - w for w in when if w <= at])


class _Shooting:
    """A camera chosen once, and tubes that keep their triangles from picture to picture.

    Lengths of the view are in `unit` [m], the radius of the tubes, from `_origin`.
    """

    def __init__(
        self,
        moments: Moments,
        size: tuple[int, int],
        colour: str,
        whole: bool,
        held: float,
        skin: Callable[[float], Skin] | None = None,
    ) -> None:
        self._colour, self._closed, self._breaks = colour, moments.closed, moments.breaks
        self.unit = moments.radius * (THICKER if moments.breaking else 1.0)
        self._origin = np.concatenate(moments.at(moments.times[0]).strands).mean(axis=0)
        self._parts: dict[tuple[int, ...], list[Ints]] = {}
        self._skin = skin
        looked = [(moment.time, self._nodes(moment)) for moment in moments.spread()]
        if moments.flat or moments.battery or whole:
            body = np.concatenate([x for _, strands in looked for x in strands])
        else:
            body = self._knots(looked[:: max(1, len(looked) // LOOKED_AT)], held)
        if moments.flat:
            right, toward = ALONG, ACROSS
        elif moments.battery:
            right, toward = self._side_along(looked[0][1], looked[-1][1][0])
        else:
            right, toward = self._side(self._nodes(moments.at(held)))
        self.view = _framed(body, size, right, toward)

    def _curves(self, nodes: Sequence[Floats]) -> list[SmoothCurve]:
        loops = self._closed or [False] * len(nodes)
        return [smooth_centerline(x, loop, SAMPLE) for x, loop in zip(nodes, loops, strict=True)]

    def _knots(self, looked: Sequence[tuple[float, list[Floats]]], held: float) -> Floats:
        """Points (n, 3) of the knot at all times; when it has slipped, as long as it is not undone."""
        bodies = [
            (time <= held * (1 + 1e-9), np.concatenate(knot_body(self._curves(nodes), self._closed, 1.0)))
            for time, nodes in looked
        ]
        longest = max((len(x) for holds, x in bodies if holds), default=math.inf)
        return np.concatenate([x for holds, x in bodies if holds or len(x) <= longest])

    def _side(self, nodes: Sequence[Floats]) -> tuple[Floats, Floats]:
        """Directions right and toward the camera from which a knot is plainest."""
        if self._skin is not None:
            return level_right(FROM_ABOVE), FROM_ABOVE
        curves = self._curves(nodes)
        body = np.concatenate(knot_body(curves, self._closed, 1.0))
        return best_side([c.x for c in curves], body, 1.0, level=not all(self._closed))

    def _side_along(self, nodes: Sequence[Floats], last: Floats) -> tuple[Floats, Floats]:
        """Where the last shape of a strand lies level, and of such sides the one that shows a knot best."""
        right = last[-1] - last[0]
        right /= np.linalg.norm(right)
        up = perpendicular(right)
        axes = np.stack([right, up, np.cross(right, up)])
        curves = [c.x @ axes.T for c in self._curves(nodes)]
        level, toward = best_side(curves, np.concatenate(curves), 1.0, level=True)
        return level @ axes, toward @ axes

    def _nodes(self, moment: Moment) -> list[Floats]:
        return [(x - self._origin) / self.unit for x in moment.strands]

    def picture(self, stage: Stage, moment: Moment) -> Pixels:
        """The strands at a moment, lit, in pixels (height, width, 3), 0 to 255."""
        nodes = self._nodes(moment)
        loops = self._closed or [False] * len(nodes)
        key = tuple(len(x) for x in nodes)
        if key not in self._parts:
            self._parts[key] = [divisions(x, loop, SPACING) for x, loop in zip(nodes, loops, strict=True)]
        meshes = [
            tube(x, 1.0, loop, sides=SIDES, rounding=ROUNDING, parts=parts)
            for x, loop, parts in zip(nodes, loops, self._parts[key], strict=True)
        ]
        if self._colour == "strands":
            colours = [np.tile(strand_colour(s), (len(m.vertices), 1)) for s, m in enumerate(meshes)]
        else:
            palette = PALETTES[self._colour]
            colours = [palette(m.at_vertices(v)) for m, v in zip(meshes, moment.values, strict=True)]
        if self._skin is not None:
            bodies = self._skin(moment.time).meshes(self._origin, self.unit)
            meshes, colours = meshes + bodies, colours + [skin_colour(m) for m in bodies]
        pieces = shadow_pieces(self._curves(nodes), loops)
        return stage.shown(meshes, lit_by_lamp(meshes, colours, pieces, self.view))

    def rings(self, moment: Moment, shot: _Shot) -> list[Ring]:
        """Marks at the breaks that just happened."""
        nodes = self._nodes(moment)
        last = np.cumsum([len(x) - 1 for x in nodes]).tolist()
        rings = []
        for b, age in zip(self._breaks, shot.ages, strict=False):
            if age < FLASH and b.node in (0, *last[:-1]):
                p = last.index(b.node) if b.node else -1  # the ends of a strand that was closed
                middle = 0.5 * (nodes[p][-1] + nodes[p + 1][0])
                rings.append(Ring(self.view.pixels(middle[None])[0], age / FLASH))
        return rings


def _framed(body: Floats, size: tuple[int, int], right: Floats, toward: Floats) -> View:
    """The view that the body (n, 3) fills as far as what is written above and below leaves room."""
    view = frame(body, 1.0, size, right, toward, WIDE)
    tall = np.ptp(view.pixels(body)[:, 1]) + 2.0 * view.scale(view.focus[None])[0]
    return view if tall < HIGH * size[1] else frame(body, 1.0, size, right, toward, HIGH)


def _held(dataset: xarray.Dataset) -> float:
    """When a knot is tightest [s]: at the end, or just before it slips."""
    time = np.asarray(dataset["time"], np.float64)
    slipped = dataset.attrs.get("slipped_at_s")
    if slipped is None:
        return float(time[-1])
    return float(time[max(0, int(np.searchsorted(time, slipped * (1 - 1e-9))) - 1)])


def _pictures(path: Path, seconds: float, fps: float) -> int:
    """How many pictures there are, of a movie that can be made."""
    if path.suffix.lower() not in ENDINGS:
        raise TorsadeError(
            f"cannot make a movie called {str(path)!r}; give a name that ends in {' or '.join(ENDINGS)}"
        )
    if not (0.1 <= seconds <= 3600 and 1 <= fps <= 120):
        raise TorsadeError(
            f"a movie of {seconds:g} s with {fps:g} pictures a second was asked for; give 0.1 to 3600 s and "
            "1 to 120 pictures a second"
        )
    return max(2, round(seconds * fps))


def _colour(dataset: xarray.Dataset, colour: str | None) -> str:
    known = colours_of(dataset)
    if colour is None:
        return (*known, "strands")[0]
    if colour not in (*known, "strands"):
        can = " or ".join(repr(name) for name in (*known, "strands"))
        raise TorsadeError(
            f"the colour is to show {colour!r}; of this result it can be {can}, one colour for each "
            f"{'piece' if 'piece_start' in dataset else 'strand'}"
        )
    return colour
