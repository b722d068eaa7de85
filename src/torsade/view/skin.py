"""Skin in pictures: parts of cylinders that let see through them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.view.tube import Mesh, tube

if TYPE_CHECKING:
    import xarray

__all__ = [
    "COLOUR",
    "FROM_ABOVE",
    "Skin",
    "skin_at",
    "skin_colour",
    "skin_meshes",
    "skin_over_time",
]

Floats = NDArray[np.float64]

COLOUR = np.array([0.98, 0.80, 0.70])

FROM_ABOVE = np.array([0.20, 0.34, 0.92]) / np.linalg.norm([0.20, 0.34, 0.92])
"""From the wound to the camera: along the skin, from a little above and from the right."""

HALF_LENGTH = 9.0
"""Of the part of a cylinder that is drawn, in radii of the fiber."""

SIDES, RINGS = 192, 0.5  # of the mesh: around, and apart along it in radii of the fiber


class Skin(NamedTuple):
    """Cylinders along z: where their axes are, (n, 3) [m], and their radius [m]."""

    centres: Floats
    radius: float

    def meshes(self, origin: Floats, unit: float, sides: int = SIDES, rings: float = RINGS) -> list[Mesh]:
        """One mesh for each cylinder, in units [m] from an origin (3,) [m]; rings are so many units apart."""
        along = np.array([[0.0, 0.0, -HALF_LENGTH], [0.0, 0.0, 0.0], [0.0, 0.0, HALF_LENGTH]])
        r = self.radius / unit
        return [
            tube((centre - origin) / unit + along, r, sides=sides, spacing=rings / r, rounding=0.6 / r)
            for centre in self.centres
        ]


def skin_colour(mesh: Mesh) -> Floats:
    """Colour (n, 3) of every vertex, before it is lit."""
    return np.tile(COLOUR, (len(mesh.vertices), 1))


def _radius(dataset: xarray.Dataset) -> float:
    """Radius of the skin [m]."""
    try:
        radius = float(json.loads(dataset.attrs["model"])["skin_radius"])
    except (LookupError, TypeError, ValueError):
        radius = math.nan
    if not 0 < radius < math.inf:
        raise TorsadeError(
            "this result cannot be drawn: its attribute model does not say how thick its skin is; give one "
            "written by a protocol"
        )
    return radius


def skin_at(dataset: xarray.Dataset, frame: int) -> Skin | None:
    """The skin in a stored frame of a result; None where there is none.

    Raises
    ------
    TorsadeError
        When the result does not say how thick it is.
    """
    if "skin_position" not in dataset:
        return None
    return Skin(np.asarray(dataset["skin_position"][frame], np.float64), _radius(dataset))


def skin_meshes(dataset: xarray.Dataset, frame: int, sides: int = SIDES, rings: float = RINGS) -> list[Mesh]:
    """One mesh [m] for each cylinder in a stored frame of a result, none where there is no skin.

    Parameters
    ----------
    sides : of each mesh, around it
    rings : how far they are apart along it, at most, in radii of the fiber

    Raises
    ------
    TorsadeError
        When the result does not say how thick the skin is.
    """
    skin, radius = skin_at(dataset, frame), float(dataset.attrs["radius"])
    bodies = [] if skin is None else skin.meshes(np.zeros(3), radius, sides, rings)
    return [mesh._replace(vertices=radius * mesh.vertices) for mesh in bodies]


def skin_over_time(dataset: xarray.Dataset) -> Callable[[float], Skin] | None:
    """The skin at any time [s], moving straight between stored frames; None where there is none."""
    if "skin_position" not in dataset:
        return None
    time = np.asarray(dataset["time"], np.float64)
    where = np.asarray(dataset["skin_position"], np.float64)
    radius = _radius(dataset)

    def at(t: float) -> Skin:
        after = int(np.clip(np.searchsorted(time, t), 1, len(time) - 1))
        share = (t - time[after - 1]) / (time[after] - time[after - 1])
        return Skin((1 - share) * where[after - 1] + share * where[after], radius)

    return at
