"""A white stage before one camera: PyVista draws coloured meshes; no window or graphics card is needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsade.view._extra import require
from torsade.view.camera import VIEW_ANGLE, View
from torsade.view.tube import Mesh

__all__ = ["Stage", "averaged"]

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]

MARGIN = 16
"""Rendered beyond the frame on each side [pixels] and cut off, so that no filter meets the border."""

OPACITY = 0.5
"""Of what lets see through it."""


class Stage:
    """Meshes that may move: while they keep their triangles, points and colours are changed in place.

    Parameters
    ----------
    view : the camera
    supersampling : pixels rendered for each one of the frame, along each side
    samples : of each pixel at its edges, which is faster and coarser than supersampling
    glass : so many meshes, the last ones, let see through them
    """

    def __init__(self, view: View, supersampling: int = 1, samples: int = 0, glass: int = 0) -> None:
        self._view, self._k, self._samples, self._glass = view, supersampling, samples, glass
        self._open = ExitStack()
        self._surfaces: list[Any] = []

    def __enter__(self) -> Stage:
        with self._open:
            self._open.enter_context(_quiet_vtk())
            self._plotter = self._built()
            self._open.callback(self._plotter.close)
            self._open = self._open.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        self._open.close()

    def _built(self) -> Any:
        """A plotter with the camera of the view and room for the margin."""
        view, k = self._view, self._k
        wide, high = (side + 2 * MARGIN for side in view.size)
        plotter = require("pyvista").Plotter(
            off_screen=True, window_size=(k * wide, k * high), lighting="none"
        )
        if self._samples:
            plotter.enable_anti_aliasing("msaa", multi_samples=self._samples)
        plotter.background_color = "white"
        camera = plotter.camera
        camera.focal_point, camera.up = view.focus, view.up
        camera.position = view.focus + view.distance * view.toward
        camera.view_angle = 2.0 * np.degrees(np.arctan(np.tan(0.5 * VIEW_ANGLE) * high / view.size[1]))
        return plotter

    def shown(self, meshes: Sequence[Mesh], colours: Sequence[Floats]) -> Pixels:
        """Pixels of meshes whose vertices have sRGB colours (n, 3) from 0 to 1.

        Returns
        -------
        (supersampling height, supersampling width, 3), 0 to 255
        """
        rgb = [np.round(255.0 * c).astype(np.uint8) for c in colours]
        now = [len(m.vertices) for m in meshes]
        if now != [s.n_points for s in self._surfaces]:
            self._placed(meshes, rgb)
        else:
            for surface, mesh, values in zip(self._surfaces, meshes, rgb, strict=True):
                surface.points = mesh.vertices
                surface.point_data["colour"] = values
        plotter = self._plotter
        plotter.renderer.reset_camera_clipping_range()
        plotter.render()  # once it has been, a screenshot takes what is there
        cut = slice(self._k * MARGIN, -self._k * MARGIN)
        return np.asarray(plotter.screenshot(None, return_img=True))[cut, cut, :3]

    def _placed(self, meshes: Sequence[Mesh], rgb: Sequence[Pixels]) -> None:
        """Put other meshes on the stage."""
        pyvista, plotter = require("pyvista"), self._plotter
        camera = plotter.camera.copy()
        plotter.clear_actors()
        self._surfaces = []
        for k, (mesh, values) in enumerate(zip(meshes, rgb, strict=True)):
            surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
            surface.point_data["colour"] = values
            through = {"opacity": OPACITY, "culling": "back"} if k >= len(meshes) - self._glass else {}
            plotter.add_mesh(
                surface, scalars="colour", rgb=True, lighting=False, reset_camera=False, **through
            )
            self._surfaces.append(surface)
        plotter.camera = camera


def averaged(pixels: Pixels, k: int) -> Floats:
    """A picture (height, width, 3), 0 to 1, from one with k times as many pixels along each side."""
    height, width, _ = pixels.shape
    total = np.zeros((height // k, width // k, 3))
    for row in range(k):
        for column in range(k):
            total += pixels[row::k, column::k]
    return total / (255.0 * k * k)


@contextmanager
def _quiet_vtk() -> Iterator[None]:
    """Keep VTK's remarks about displays and drivers off the console."""
    logger = require("vtkmodules.vtkCommonCore").vtkLogger
    before = logger.GetCurrentVerbosityCutoff()
    logger.SetStderrVerbosity(logger.VERBOSITY_OFF)
    try:
        yield
    finally:
        logger.SetStderrVerbosity(before)
