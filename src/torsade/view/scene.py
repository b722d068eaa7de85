"""Pictures of fibers in space, fit to print: PyVista draws, no window or graphics card is needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.errors import TorsadeError, reason_of
from torsade.view._extra import require
from torsade.view.arrows import Arrow
from torsade.view.camera import (
    SAMPLE,
    View,
    best_side,
    frame,
    knot_body,
    level_right,
)
from torsade.view.colours import strain_colour, strand_colour
from torsade.view.overlay import Mark, draw_over
from torsade.view.shading import LAMP, Pieces, lit, occlusion
from torsade.view.skin import FROM_ABOVE, Skin, skin_at, skin_colour
from torsade.view.stage import Stage, averaged
from torsade.view.strands import strands_at
from torsade.view.tube import Mesh, SmoothCurve, smooth_centerline, tube

if TYPE_CHECKING:
    import xarray

Floats = NDArray[np.float64]

SUPERSAMPLING = 2

TURNED_AWAY = -0.3
"""Cosine to the camera below which a vertex of a tube is in no triangle that is seen."""


def render(
    strands: Sequence[ArrayLike],
    closed: bool | Sequence[bool],
    radius: float,
    path: str | Path,
    *,
    values: Sequence[ArrayLike] | None = None,
    size: tuple[int, int] = (1600, 1200),
    direction: ArrayLike | None = None,
    fill: float | None = None,
    fade: float = 0.0,
    marks: Sequence[Mark] = (),
    arrows: Sequence[Arrow] = (),
    palette: Callable[[Floats], Floats] = strain_colour,
    bar: bool = True,
    skin: Skin | None = None,
) -> Path:
    """Write a picture (PNG) of strands, framed tightly on the knot that they form.

    Parameters
    ----------
    strands : node positions (n, 3) [m] of each strand
    closed : whether strands are closed, one answer for all or one for each
    radius : h [m]
    path : the file to write
    values : log strain (n,) of each strand: measured strain colours and a colour bar; without it every
        strand has its own colour; other values with another palette
    size : width and height [pixels], multiples of 16
    direction : (3,) from the knot to the camera; without it the side is taken that shows the knot best,
        with the x axis horizontal when a strand has ends to be pulled
    fill : share of the frame that the knot takes, in width or in height; without it 0.68 when strands run
        out of the frame, 0.84 when all of them is in it
    fade : share of the frame's width over which strands fade away toward its borders
    marks : names and arrows at the ends of strands
    arrows : on strands, where they are in sight
    palette : colour (..., 3) of values (...,); by default the measured one of strain
    bar : whether strain colours are explained by a colour bar
    skin : cylinders that the strands lie around

    Returns
    -------
    The path of the file.
    """
    options: dict[str, Any] = {"values": values, "size": size, "direction": direction, "fill": fill}
    options |= {"marks": marks, "arrows": arrows, "palette": palette, "bar": bar, "skin": skin}
    image = picture(strands, closed, radius, fade=fade, **options)
    path = Path(path)
    pixels = np.round(255.0 * image).astype(np.uint8)
    try:
        require("matplotlib.image").imsave(path, pixels, dpi=300, format="png")
    except OSError as error:
        raise TorsadeError(
            f"the picture cannot be written to {path} ({reason_of(error)}); give a path in a folder "
            "that exists and can be written."
        ) from error
    return path


def render_result(dataset: xarray.Dataset, path: str | Path, frame: int = -1, **options: Any) -> Path:
    """Write a picture of one stored frame of a result, coloured by strain; options as in `render`.

    The dataset holds what `strands_at` draws, the attribute `radius` [m], and, for the colours,
    `log_strain (time, node)`.
    """
    strands = strands_at(dataset, frame)
    if "radius" not in dataset.attrs:
        raise TorsadeError(
            "this result cannot be drawn: it lacks the attribute radius; give one of a protocol."
        )
    if "log_strain" in dataset and "values" not in options:
        strain = np.asarray(dataset["log_strain"].isel(time=frame))
        options["values"] = [strand.of(strain) for strand in strands]
    closed = [strand.closed for strand in strands]
    if skin := skin_at(dataset, frame):
        options = {"skin": skin, "direction": FROM_ABOVE} | options
    return render([s.x for s in strands], closed, float(dataset.attrs["radius"]), path, **options)


def picture(
    strands: Sequence[ArrayLike],
    closed: bool | Sequence[bool],
    radius: float,
    *,
    values: Sequence[ArrayLike] | None = None,
    size: tuple[int, int] = (1600, 1200),
    direction: ArrayLike | None = None,
    fill: float | None = None,
    fade: float = 0.0,
    marks: Sequence[Mark] = (),
    arrows: Sequence[Arrow] = (),
    palette: Callable[[Floats], Floats] = strain_colour,
    bar: bool = True,
    whole: bool = False,
    skin: Skin | None = None,
) -> Floats:
    """The picture that `render` writes, as an array (height, width, 3) of sRGB from 0 to 1.

    With whole=True all of the strands is in the frame, not the knot that they form.
    """
    nodes, loops = _checked(strands, closed, radius, values, size)
    origin = np.concatenate(nodes).mean(axis=0)
    nodes = [(x - origin) / radius for x in nodes]
    curves = [smooth_centerline(x, loop, SAMPLE) for x, loop in zip(nodes, loops, strict=True)]
    view = _view(curves, loops, size, direction, fill, whole)
    meshes = [
        tube(x, 1.0, loop, sides=64, spacing=0.125, rounding=0.3)
        for x, loop in zip(nodes, loops, strict=True)
    ]
    if values is None:
        colours = [np.tile(strand_colour(s), (len(m.vertices), 1)) for s, m in enumerate(meshes)]
    else:
        colours = [palette(m.at_vertices(v)) for m, v in zip(meshes, values, strict=True)]
    bodies = [] if skin is None else skin.meshes(origin, radius)
    meshes, colours = meshes + bodies, colours + [skin_colour(m) for m in bodies]
    colours = lit_by_lamp(meshes, colours, shadow_pieces(curves, loops), view)
    with Stage(view, SUPERSAMPLING, glass=len(bodies)) as stage:
        image = averaged(stage.shown(meshes, colours), SUPERSAMPLING)
    if fade > 0:
        image = _faded(image, fade)
    explained = bar and values is not None and palette is strain_colour
    return draw_over(image, view, nodes, 1.0, marks, arrows, bar=explained)


def _checked(
    strands: Sequence[ArrayLike],
    closed: bool | Sequence[bool],
    radius: float,
    values: Sequence[ArrayLike] | None,
    size: tuple[int, int],
) -> tuple[list[Floats], list[bool]]:
    """Strands as arrays and one flag each, or a clear refusal."""
    nodes = [np.asarray(x, dtype=np.float64) for x in strands]
    loops = [bool(closed)] * len(nodes) if isinstance(closed, (bool, np.bool_)) else [bool(c) for c in closed]
    if not nodes or len(loops) != len(nodes):
        raise TorsadeError(
            f"a picture was asked of {len(nodes)} strands with {len(loops)} answers to whether they are "
            "closed; give at least one strand and one answer for each."
        )
    for s, x in enumerate(nodes):
        if x.ndim != 2 or x.shape[1] != 3 or not np.all(np.isfinite(x)):
            raise TorsadeError(f"strand {s} has shape {x.shape}; give finite node positions (n, 3) [m].")
    if not (radius > 0 and np.isfinite(radius)):
        raise TorsadeError(f"the radius is {radius} m; it must be positive.")
    if any(side <= 0 or side % 16 for side in size):
        raise TorsadeError(f"the picture size is {size[0]} x {size[1]}; both sides must be multiples of 16.")
    if values is not None:
        given, wanted = [np.shape(v) for v in values], [(len(x),) for x in nodes]
        if given != wanted:
            raise TorsadeError(f"values have shapes {given}; one value per node is needed: {wanted}.")
        if not all(np.all(np.isfinite(v)) for v in values):
            raise TorsadeError("some values are not finite; give the log strain of every node.")
    return nodes, loops


def _view(
    curves: Sequence[SmoothCurve],
    loops: Sequence[bool],
    size: tuple[int, int],
    direction: ArrayLike | None,
    fill: float | None,
    whole: bool,
) -> View:
    """The camera, in radii."""
    body = np.concatenate([c.x for c in curves] if whole else knot_body(curves, loops, 1.0))
    if fill is None:
        fill = 0.68 if len(body) < sum(len(c.x) for c in curves) else 0.84
    if direction is None:
        right, toward = best_side([c.x for c in curves], body, 1.0, level=not all(loops))
    else:
        toward = np.asarray(direction, dtype=np.float64)
        if toward.shape != (3,) or not np.linalg.norm(toward) > 0:
            raise TorsadeError(f"the direction {direction} is no vector; give three numbers, not all zero.")
        toward = toward / np.linalg.norm(toward)
        right = level_right(toward)
    return frame(body, 1.0, size, right, toward, fill)


def shadow_pieces(curves: Sequence[SmoothCurve], loops: Sequence[bool]) -> Pieces:
    """The strands as short pieces that cast shadows, one around each point of the sampled curves."""
    lengths = []
    for curve, loop in zip(curves, loops, strict=True):
        after = np.roll(curve.x, -1, axis=0) - curve.x
        gap = np.linalg.norm(after if loop else after[:-1], axis=1)
        before = np.roll(gap, 1) if loop else np.append(0.0, gap)
        lengths.append(0.5 * (before + (gap if loop else np.append(gap, 0.0))))
    return Pieces(
        np.concatenate([c.x for c in curves]), np.concatenate([c.t for c in curves]), np.concatenate(lengths)
    )


def lit_by_lamp(
    meshes: Sequence[Mesh], colours: Sequence[Floats], pieces: Pieces, view: View
) -> list[Floats]:
    """sRGB colours (n, 3) of all vertices as the camera sees them, lit and in each other's shadow."""
    axes = np.array([view.right, view.up, view.toward])
    camera = view.focus + view.distance * view.toward
    result = []
    for mesh, rgb in zip(meshes, colours, strict=True):
        sky, shade = np.zeros((2, len(rgb)))
        eye = camera - mesh.vertices
        eye /= np.linalg.norm(eye, axis=1, keepdims=True)
        seen = _near_frame(view, mesh.vertices) & (np.sum(mesh.normals * eye, axis=1) > TURNED_AWAY)
        sky[seen], shade[seen] = occlusion(mesh.vertices[seen], mesh.normals[seen], pieces, 1.0, LAMP @ axes)
        result.append(lit(rgb, mesh.normals, eye, axes, sky, shade))
    return result


def _near_frame(view: View, x: Floats) -> NDArray[np.bool_]:
    """Which points (n, 3) fall in the frame or within a tenth of it outside."""
    place = view.pixels(x) / np.array(view.size)
    return np.asarray(np.all((place > -0.1) & (place < 1.1), axis=1))


def _faded(image: Floats, fade: float) -> Floats:
    """Blend into white toward the borders over a share of the width."""
    height, width = image.shape[:2]
    row, column = np.arange(height) + 0.5, np.arange(width) + 0.5
    inset = np.minimum(np.minimum(row, height - row)[:, None], np.minimum(column, width - column)[None])
    s = np.clip(inset / (fade * width), 0.0, 1.0)
    return np.asarray(1.0 - (s * s * (3.0 - 2.0 * s))[:, :, None] * (1.0 - image))
