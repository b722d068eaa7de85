"""A result looked at: all frames in a window that can be turned, or one of them in a picture."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.errors import TorsadeError
from torsade.view._extra import require
from torsade.view.battery import draw_battery
from torsade.view.camera import best_side, level_right
from torsade.view.cascade import draw_pieces
from torsade.view.scene import render_result
from torsade.view.skin import FROM_ABOVE, skin_colour, skin_meshes
from torsade.view.stage import OPACITY
from torsade.view.strands import frame_index, strands_at, tubes_at
from torsade.view.tube import Mesh

if TYPE_CHECKING:
    import xarray

    from torsade.arrays import Floats
    from torsade.results import Result

__all__ = ["Window", "draw_result", "has_display", "show"]

INK = "#333333"

CLOSER = 1.3
"""How much nearer the camera comes than to see a sphere around the fibers, which fill it in one direction."""


def show(result: Result, picture: str | Path | None = None, frame: int | None = None) -> None:
    """Show all frames in a window, until it is closed, or draw one of them to a picture.

    Parameters
    ----------
    picture : PNG file to draw to, in place of a window
    frame : which to draw, or to begin with; by default the last one, or the last before a pulled knot
        slipped, and of a rod that broke some moments in one picture

    Raises
    ------
    TorsadeError
        When there is nothing to be drawn, or no display for a window.
    """
    if picture is not None:
        draw_result(result, picture, frame)
        return
    shown = frame_index(result.last_held if frame is None else frame, result.frames)
    strands_at(result.dataset, shown)
    if not has_display():
        raise TorsadeError(
            "there is no display to open a window on; give --picture FILE.png to draw to a file"
        )
    Window(result.dataset, shown).open()


def draw_result(result: Result, path: str | Path, frame: int | None = None) -> Path:
    """Draw a frame to a PNG file; of a battery, or a rod that breaks, without a frame, some moments."""
    if frame is None and "charge_position" in result.dataset:
        return draw_battery(result.dataset, path)
    if "piece_start" in result.dataset:
        return draw_pieces(result.dataset, path, frame)
    return render_result(result.dataset, path, frame=result.last_held if frame is None else frame)


def has_display() -> bool:
    """Whether a window can be opened here."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


class Window:
    """Fibers as tubes, coloured by strain or each in its own colour, with a slider over the frames.

    Skin lets see through it. Left and Right go one frame back and forth.

    Parameters
    ----------
    dataset : of a result
    frame : to begin with
    hidden : draw without a window, for pictures of it
    """

    def __init__(self, dataset: xarray.Dataset, frame: int = 0, hidden: bool = False) -> None:
        self._dataset = dataset
        self._frames = dataset.sizes["time"]
        self._pyvista = require("pyvista")
        self.frame = frame
        self.plotter = self._pyvista.Plotter(off_screen=hidden, window_size=(1280, 960))
        self.plotter.background_color = "white"
        self._slider: Any = None
        self._draw(frame)
        if self._frames > 1:
            self._slider = self.plotter.add_slider_widget(
                lambda value: self.go_to(round(value)),
                (0, self._frames - 1),
                value=frame,
                pointa=(0.3, 0.07),
                pointb=(0.7, 0.07),
                fmt="%.0f",
                color=INK,
                tube_width=0.004,
                slider_width=0.02,
                title_height=0.02,
            )
            for key, step in (("Left", -1), ("Right", 1)):
                self.plotter.add_key_event(key, lambda step=step: self.go_to(self.frame + step))
        self._look()

    def go_to(self, frame: int) -> None:
        """Show another frame; beyond the first and the last there is none."""
        frame = min(max(frame, 0), self._frames - 1)
        if frame == self.frame:
            return
        self._draw(frame)
        self.frame = frame
        if self._slider is not None:
            self._slider.GetRepresentation().SetValue(frame)
        self.plotter.render()

    def open(self) -> None:
        """Show the window until it is closed."""
        self.plotter.show(title=f"torsade: {self._dataset.attrs['protocol']}")

    def _draw(self, frame: int) -> None:
        t = float(self._dataset["time"][frame])
        note = f"frame {frame} of {self._frames - 1}, t = {t:.4g} s" if self._frames > 1 else ""
        self._put("fibers", tubes_at(self._dataset, frame))
        if bodies := skin_meshes(self._dataset, frame):
            # Of glass only the side toward the camera is drawn, so that it needs no sorting.
            self._put("skin", [(m, skin_colour(m)) for m in bodies], opacity=OPACITY, culling="back")
        self.plotter.add_text(
            note, position=(0.02, 0.95), viewport=True, font_size=11, color=INK, name="note"
        )

    def _put(self, name: str, parts: Sequence[tuple[Mesh, Floats]], **options: Any) -> None:
        """Draw tubes, with sRGB colours (n, 3) of their vertices, in place of what had this name."""
        points, normals, faces, colours, first = [], [], [], [], 0
        for mesh, rgb in parts:
            points.append(mesh.vertices)
            normals.append(mesh.normals)
            faces.append(mesh.faces + first)
            colours.append(np.round(255 * rgb).astype(np.uint8))
            first += len(mesh.vertices)
        surface = self._pyvista.PolyData.from_regular_faces(np.concatenate(points), np.concatenate(faces))
        surface.point_data["Normals"] = np.concatenate(normals)
        surface.point_data["colour"] = np.concatenate(colours)
        surface.point_data.active_normals_name = "Normals"
        self.plotter.add_mesh(
            surface, scalars="colour", rgb=True, name=name, smooth_shading=True, reset_camera=False, **options
        )

    def _look(self) -> None:
        """From the side that shows most, as in pictures, with everything in the window."""
        radius = float(self._dataset.attrs["radius"])
        curves = [s.x / radius for s in strands_at(self._dataset, self.frame)]
        x = np.concatenate(curves)
        bodies = skin_meshes(self._dataset, self.frame)
        right, toward = np.eye(3)[[0, 2]]  # across the plane in which rods break
        if bodies:
            right, toward = level_right(FROM_ABOVE), FROM_ABOVE
        elif "piece_start" not in self._dataset:
            right, toward = best_side(curves, x, 1.0, level=True)
        camera, focus = self.plotter.camera, 0.5 * radius * (x.min(axis=0) + x.max(axis=0))
        camera.focal_point, camera.position = focus, focus + radius * np.ptp(x) * toward
        camera.up = np.cross(toward, right)
        drawn = np.concatenate([radius * (x - 1), radius * (x + 1), *(mesh.vertices for mesh in bodies)])
        bounds = np.stack([drawn.min(axis=0), drawn.max(axis=0)], axis=1)
        self.plotter.reset_camera(bounds=tuple(bounds.ravel().tolist()))
        camera.zoom(CLOSER)
