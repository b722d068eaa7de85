"""Shadows where strands touch, computed from the fibers themselves.

A short piece ds of a fiber of radius h, at distance r and at angle gamma to the line of sight, hides
2 h ds sin(gamma) / r² of solid angle. Weighted with the cosine to the surface normal and summed along the
fiber this is the light a surface point loses; for a straight fiber the sum is exactly h cos(theta) / d, the
view factor of a long cylinder. The result has no noise, does not depend on the camera and takes a
fraction of a second, which screen-space occlusion cannot offer.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]

GAMMA = 2.2
LAMP = np.array([-0.36, 0.60, 0.71])
"""Direction toward the lamp in the frame of the camera: right, up, toward it."""

REACH = 10.0
"""Fibers further away than this many radii cast no shadow."""


class Pieces(NamedTuple):
    """Short pieces of fiber that cast shadows: middle x (m, 3), tangent t (m, 3), length ds (m,)."""

    x: Floats
    t: Floats
    ds: Floats


def occlusion(
    vertices: Floats, normals: Floats, pieces: Pieces, radius: float, light: Floats
) -> tuple[Floats, Floats]:
    """Share of the sky and of one soft light that the fibers hide from each vertex.

    Parameters
    ----------
    vertices, normals : (n, 3) surface points and their outward unit normals
    pieces : the fibers, in pieces no longer than about half a radius
    radius : h, in the unit of the vertices
    light : (3,) unit vector toward the light

    Returns
    -------
    sky : (n,) hidden share of the hemisphere, cosine-weighted, 0 to 1
    shade : (n,) hidden share of a lamp half as wide as its distance, 0 to 1
    """
    sky, shade = np.zeros(len(vertices)), np.zeros(len(vertices))
    tree = cKDTree(pieces.x)
    for first in range(0, len(vertices), 1024):
        block = slice(first, first + 1024)
        sky[block], shade[block] = _block(vertices[block], normals[block], pieces, tree, radius, light)
    return 1.0 - np.exp(-1.6 * sky), shade


def _block(
    x: Floats, n: Floats, pieces: Pieces, tree: cKDTree, radius: float, light: Floats
) -> tuple[Floats, Floats]:
    near = tree.query_ball_point(x.mean(axis=0), REACH * radius + np.ptp(x, axis=0).max())
    q, t, ds = (a[near].astype(np.float32) for a in pieces)
    r = q[None] - x[:, None].astype(np.float32)
    distance = np.maximum(np.linalg.norm(r, axis=2), radius)
    r /= distance[:, :, None]
    cosine = np.einsum("ijk,ik->ij", r, n.astype(np.float32))
    along = np.einsum("ijk,jk->ij", r, t)
    above = np.where(distance < REACH * radius, np.maximum(cosine, 0.0), 0.0)
    sine = np.sqrt(np.maximum(1.0 - along * along, 0.0))
    sky = np.sum(2.0 * radius / np.pi * ds * sine * above / distance**2, axis=1)
    off = np.arccos(np.clip(r @ light.astype(np.float32), -1.0, 1.0))
    lamp = 0.25
    cover = np.clip((np.arcsin(np.minimum(radius / distance, 1.0)) + lamp - off) / (2.0 * lamp), 0.0, 1.0)
    cover = cover * cover * (3.0 - 2.0 * cover) * np.clip(4.0 * above, 0.0, 1.0)
    return sky, np.max(cover, axis=1, initial=0.0)


def lit(srgb: Floats, normals: Floats, eye: Floats, axes: Floats, sky: Floats, shade: Floats) -> Floats:
    """Colour of a satin surface under a broad lamp, a bright sky and weaker light from all sides.

    Parameters
    ----------
    srgb : (n, 3) colour of the material, 0 to 1
    normals, eye : (n, 3) outward unit normals and unit vectors toward the camera
    axes : (3, 3) right, up and toward the camera, in rows
    sky, shade : (n,) what `occlusion` says

    Returns
    -------
    (n, 3) sRGB, 0 to 1
    """
    albedo = srgb**GAMMA
    n = normals @ axes.T
    open_sky = 1.0 - sky
    lamp = LAMP @ axes
    ambient = 0.31 + 0.12 * n[:, 1] + 0.17 * n[:, 2] + 0.03 * n[:, 0]
    direct = 0.60 * np.maximum((normals @ lamp + 0.25) / 1.25, 0.0) ** 1.4 * (1.0 - 0.85 * shade)
    light = ambient[:, None] * _bounced(0.75 * albedo, open_sky[:, None]) + (direct * open_sky**0.8)[:, None]
    facing = np.clip(np.sum(normals * eye, axis=1), 0.0, 1.0)
    mirrored = 2.0 * facing[:, None] * normals - eye
    fresnel = 0.04 + 0.96 * (1.0 - facing) ** 5
    box = 0.26 * _step(mirrored @ lamp, np.cos(np.radians(46.0)), 1.0) ** 2
    surroundings = 0.30 + 0.25 * (mirrored @ axes[1])
    gloss = box * (1.0 - shade) * open_sky + 0.14 * fresnel * surroundings * open_sky**2
    return np.asarray(np.clip(albedo * light + gloss[:, None], 0.0, 1.0) ** (1.0 / GAMMA))


def _bounced(albedo: Floats, open_sky: Floats) -> Floats:
    """Share of the sky's light that reaches a surface, after bounces between surfaces of that albedo.

    Bright surfaces light each other, so creases stay coloured: the fit of Jimenez et al. (2016).
    """
    a, b, c = 2.0404 * albedo - 0.3324, -4.7951 * albedo + 0.6417, 2.7552 * albedo + 0.6903
    return np.asarray(np.maximum(open_sky, ((open_sky * a + b) * open_sky + c) * open_sky))


def _step(x: Floats, low: float, high: float) -> Floats:
    """0 below low, 1 above high, smooth in between."""
    s = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))
