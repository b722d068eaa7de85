"""What is done to the fibers: ends that are free, clamped, pulled, moved or turned, and point forces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade.arrays import Bools, Floats
from torsade.assembly import Assembly
from torsade.errors import TorsadeError
from torsade.rod.skin import Skin


class Boundary(NamedTuple):
    """Loads and constraints, constant while a run advances.

    Attributes
    ----------
    held : (n_nodes,) nodes that move as prescribed
    velocity : (n_nodes, 3) velocity of held nodes [m/s], zero elsewhere
    force : (n_nodes, 3) external force [N]
    turned : (n_edges,) edges that spin as prescribed
    spin : (n_edges,) spin of turned edges [rad/s], zero elsewhere
    torque : (n_edges,) external torque about the tangent [N m]
    skin : cylinders that fibers press and drag, or ()
    """

    held: Bools
    velocity: Floats
    force: Floats
    turned: Bools
    spin: Floats
    torque: Floats
    skin: Skin | tuple[()] = ()


def free(assembly: Assembly) -> Boundary:
    """All nodes free and unloaded."""
    n, m = len(assembly.node_length), len(assembly.edges)
    return Boundary(
        np.zeros(n, bool), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(m, bool), np.zeros(m), np.zeros(m)
    )


def end_node(assembly: Assembly, fiber: int, end: int) -> int:
    """Node at end 0 (first) or end 1 (last) of an open fiber."""
    _check_open(assembly, fiber, end)
    return int(assembly.node_start[fiber] if end == 0 else assembly.node_start[fiber + 1] - 1)


def end_edge(assembly: Assembly, fiber: int, end: int) -> int:
    """Edge at end 0 (first) or end 1 (last) of an open fiber."""
    _check_open(assembly, fiber, end)
    return int(assembly.edge_start[fiber] if end == 0 else assembly.edge_start[fiber + 1] - 1)


def _check_open(assembly: Assembly, fiber: int, end: int) -> None:
    if not 0 <= fiber < len(assembly.closed) or end not in (0, 1):
        raise TorsadeError(
            f"there is no end {end} of fiber {fiber}; expected a fiber from 0 to "
            f"{len(assembly.closed) - 1} and end 0 or 1."
        )
    if assembly.closed[fiber]:
        raise TorsadeError(f"fiber {fiber} is closed and has no ends; cut it open or choose another fiber.")


def clamp(boundary: Boundary, assembly: Assembly, fiber: int, end: int, tangent: bool = False) -> Boundary:
    """Hold an end in place and keep it from spinning; with tangent=True its direction is held too."""
    return move(boundary, assembly, fiber, end, np.zeros(3), 0.0, tangent)


def move(
    boundary: Boundary,
    assembly: Assembly,
    fiber: int,
    end: int,
    velocity: Floats,
    spin: float | None = 0.0,
    tangent: bool = False,
) -> Boundary:
    """Move an end at a velocity (3,) [m/s] while it spins at a given rate [rad/s] (None: freely).

    With tangent=True the neighbouring node moves along, so that the direction of the end is kept.
    """
    nodes = [end_node(assembly, fiber, end)]
    if tangent:
        nodes.append(nodes[0] + (1 if end == 0 else -1))
    held, v = boundary.held.copy(), boundary.velocity.copy()
    held[nodes], v[nodes] = True, velocity
    moved = boundary._replace(held=held, velocity=v)
    return moved if spin is None else turn(moved, assembly, fiber, end, spin)


def turn(boundary: Boundary, assembly: Assembly, fiber: int, end: int, spin: float) -> Boundary:
    """Prescribe the spin [rad/s] of an end about its tangent (0 keeps it from turning)."""
    edge = end_edge(assembly, fiber, end)
    turned, rate = boundary.turned.copy(), boundary.spin.copy()
    turned[edge], rate[edge] = True, spin
    return boundary._replace(turned=turned, spin=rate)


def pull(boundary: Boundary, assembly: Assembly, fiber: int, end: int, force: Floats) -> Boundary:
    """Pull an end with a force (3,) [N]; it moves freely but does not spin, as a gripped end."""
    loaded = push(boundary, end_node(assembly, fiber, end), force)
    return turn(loaded, assembly, fiber, end, 0.0)


def push(boundary: Boundary, node: int, force: Floats) -> Boundary:
    """Add an external force (3,) [N] at a node."""
    total = boundary.force.copy()
    total[node] += force
    return boundary._replace(force=total)
