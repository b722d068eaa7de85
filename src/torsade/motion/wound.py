"""Fibers around skin: cylinders put among them, and the forces that they exert on each other.

The law is in `torsade.rod.skin`; see docs/sutures.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from torsade.arrays import Floats
from torsade.assembly import Assembly, State, with_points
from torsade.errors import TorsadeError
from torsade.motion.ends import Boundary
from torsade.motion.overdamped import Motion
from torsade.rod.skin import MOST_CYLINDERS, Skin, skin_energy, skin_on, weigh_skin

__all__ = ["SkinForces", "Tissue", "measure_skin", "tied_around"]


@dataclass(frozen=True)
class Tissue:
    """What cylinders of skin are made of.

    Attributes
    ----------
    radius : h_s [m]
    stiffness : of the spring that holds each, k_s [N/m]
    ground : drag of each with the ground, zeta [N s/m], above 0: by it forces on the skin are balanced
    drag : collision drag of fiber on skin over that of fiber on fiber
    friction : coefficient of dry friction on skin
    slip_speed : v_0, far below which dry friction holds [m/s]
    """

    radius: float
    stiffness: float
    ground: float
    drag: float = 1.0
    friction: float = 0.0
    slip_speed: float = 1e-6


def tied_around(
    assembly: Assembly, state: State, boundary: Boundary, axes: Floats, tissue: Tissue
) -> tuple[Assembly, State, Boundary]:
    """Fibers with cylinders among them, at rest where their axes meet z = 0; axes (n_cylinders, 3) [m].

    Each cylinder is one node, after those of the fibers, and moves freely.

    Raises
    ------
    TorsadeError
        When there are more cylinders than can be solved for together, or nothing drags them.
    """
    if not 1 <= len(axes) <= MOST_CYLINDERS:
        raise TorsadeError(f"skin of {len(axes)} cylinders was asked for; give 1 to {MOST_CYLINDERS}")
    if not tissue.ground > 0:
        raise TorsadeError(f"the drag of skin with the ground is {tissue.ground:g} N s/m; give one above 0")
    count, n_nodes, n_fibers = len(axes), len(assembly.node_length), len(assembly.closed)
    skin = skin_on(
        len(assembly.edges),
        np.arange(n_nodes, n_nodes + count),
        np.arange(n_fibers, n_fibers + count),
        np.array(axes, np.float64),
        radius=tissue.radius,
        stiffness=tissue.stiffness,
        ground=tissue.ground,
        drag=tissue.drag,
        friction=tissue.friction,
        slip_speed=tissue.slip_speed,
    )
    none = np.zeros((count, 3))
    boundary = boundary._replace(
        held=np.append(boundary.held, np.zeros(count, np.bool_)),
        velocity=np.concatenate([boundary.velocity, none]),
        force=np.concatenate([boundary.force, none]),
        skin=skin,
    )
    state = state._replace(x=np.concatenate([state.x, axes]), v=np.concatenate([state.v, none]))
    return with_points(assembly, count), state, boundary


class SkinForces(NamedTuple):
    """What fibers do to each cylinder, and what holds it.

    normal, around, along (n_cylinders, n_edges) are the forces of each edge on the skin, per rest length
    [N/m]: into it, around it counterclockwise as seen from +z, and along z. total (n_cylinders, 3) is
    their sum [N], spring (n_cylinders, 3) the force -k_s (w - w_0) [N], contact and stored the energies of
    contacts and springs [J].
    """

    normal: Floats
    around: Floats
    along: Floats
    total: Floats
    spring: Floats
    contact: float
    stored: float


def measure_skin(motion: Motion) -> SkinForces:
    """Forces and energies at the present state and velocities of a motion with skin.

    To be called after `motion.measure()`, which finds where fibers touch.
    """
    a, state, skin = motion.assembly, motion.state, motion.boundary.skin
    assert isinstance(skin, Skin)
    weigh_skin(a, motion.model, skin, state.v)
    n = int(skin.count[0])
    edge, cylinder, inward = skin.edge[:n], skin.cylinder[:n], skin.direction[:n]
    own = state.v[a.edges[edge]].mean(axis=1)
    drag = skin.weight[:n, None] * (own - state.v[skin.node[cylinder]])
    force = drag.copy()
    force[:, :2] += skin.push[:n, None] * inward
    # Seen from +z, counterclockwise is a quarter turn clockwise from inward.
    counterclockwise = np.column_stack([inward[:, 1], -inward[:, 0]])
    shape = (len(skin.node), len(a.edges))
    parts = (
        np.sum(force[:, :2] * inward, axis=1),
        np.sum(force[:, :2] * counterclockwise, axis=1),
        force[:, 2],
    )
    normal, around, along = (np.zeros(shape) for _ in parts)
    for density, part in zip((normal, around, along), parts, strict=True):
        density[cylinder, edge] = part / a.rest_length[edge]
    total = np.zeros((len(skin.node), 3))
    np.add.at(total, cylinder, force)
    spring = -skin.stiffness * (state.x[skin.node] - skin.rest)
    contact, stored = skin_energy(a, motion.model, skin, state.x, _midpoints(a, state))
    return SkinForces(normal, around, along, total, spring, contact, stored)


def _midpoints(a: Assembly, state: State) -> Floats:
    return np.ascontiguousarray(state.x[a.edges].mean(axis=1))
