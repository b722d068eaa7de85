"""Colours that carry meaning: the measured strain colours of photonic fibers, and strands told apart.

The strain map is a measurement, not a design: the colour that a colour-changing photonic fiber shows at
logarithmic strain 0, 0.05, ..., 0.70 (thesis figure 4-2C), linear in between and held outside. It is
absolute: one colour is one strain, in every picture, whatever the range of the data.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.view._extra import require

if TYPE_CHECKING:
    from matplotlib.colors import LinearSegmentedColormap, ListedColormap

STRAIN_MAX = 0.70

STRAIN_TABLE: NDArray[np.uint8] = np.array(
    [
        (255, 0, 65),
        (255, 0, 40),
        (255, 0, 17),
        (255, 0, 5),
        (255, 23, 0),
        (255, 96, 0),
        (255, 135, 0),
        (238, 174, 0),
        (189, 207, 0),
        (111, 231, 0),
        (0, 245, 0),
        (0, 251, 84),
        (0, 238, 138),
        (0, 211, 178),
        (0, 172, 206),
    ],
    dtype=np.uint8,
)
"""(15, 3) sRGB colour at log strain 0, 0.05, ..., 0.70."""

STRAND_COLOURS: tuple[str, ...] = (
    "#3475b0",
    "#e39a2d",
    "#43276b",
    "#41a08d",
    "#bf4560",
    "#cfd3d7",
    "#37451a",
    "#efdc82",
)
"""sRGB colours for telling strands apart, also by the colour-blind, and one from the next in grey."""

DISTINCT = 5
"""Colours after which the pieces of a rod begin anew: the others are too pale."""


def strain_colour(log_strain: ArrayLike) -> NDArray[np.float64]:
    """Measured colour of a photonic fiber at the given strain.

    Parameters
    ----------
    log_strain : (...,) logarithmic strain, dimensionless; held at 0 and 0.70 outside the measured range

    Returns
    -------
    (..., 3) sRGB colour, each channel 0..1
    """
    strain = np.asarray(log_strain, dtype=np.float64)
    measured = np.linspace(0.0, STRAIN_MAX, len(STRAIN_TABLE))
    channels = [np.interp(strain, measured, STRAIN_TABLE[:, c] / 255.0) for c in range(3)]
    return np.stack(channels, axis=-1)


SRGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""From linear sRGB to CIE 1931 tristimulus values (IEC 61966-2-1), white at D65."""

PRIMARIES = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
"""Chromaticities x, y of red, green and blue of sRGB, the corners of what it can show."""


def linear_rgb(rgb: ArrayLike) -> NDArray[np.float64]:
    """Linear light (..., 3) of sRGB colours (..., 3), each channel 0..1 (IEC 61966-2-1)."""
    c = np.asarray(rgb, dtype=np.float64)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def chromaticity(rgb: ArrayLike) -> NDArray[np.float64]:
    """CIE 1931 chromaticities x = X/(X + Y + Z), y = Y/(X + Y + Z) of sRGB colours.

    Parameters
    ----------
    rgb : (..., 3) sRGB colours, each channel 0..1, none of them black

    Returns
    -------
    (..., 2) x and y
    """
    xyz = linear_rgb(rgb) @ SRGB_TO_XYZ.T
    return np.asarray(xyz[..., :2] / xyz.sum(axis=-1, keepdims=True))


def strand_colour(strand: int) -> NDArray[np.float64]:
    """sRGB colour (3,), each channel 0..1, of the strand with this number; the list repeats."""
    code = STRAND_COLOURS[strand % len(STRAND_COLOURS)]
    return np.array([int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5)])


def strain_colormap() -> LinearSegmentedColormap:
    """The strain colours as a matplotlib colormap over 0..0.70, for colour bars and plots."""
    require("matplotlib")
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("torsade.strain", list(STRAIN_TABLE / 255.0), N=1401)


def stress_colormap() -> ListedColormap:
    """Stress over strength, 0 to 1: yellow without stress, black at the strength."""
    shades = require("matplotlib").colormaps["inferno_r"](np.linspace(0.13, 1.0, 256))
    from matplotlib.colors import ListedColormap

    return ListedColormap(shades, name="torsade.stress")


def stress_colour(ratio: ArrayLike) -> NDArray[np.float64]:
    """sRGB colour (..., 3), each channel 0..1, of stress over strength (...,), held outside 0 to 1."""
    return np.asarray(stress_colormap()(np.asarray(ratio, dtype=np.float64))[..., :3])
