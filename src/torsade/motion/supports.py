"""How a fiber's two ends are held, made into a chain of edges.

An end that is held in direction has an edge of no length before it, which stands for the grip: fixed for
a clamp, turning in a plane for a pivot. Half the neighbouring edge bends against it, so that the end
itself, and not the middle of its edge, has the direction asked for, and results converge with the square
of the edges. The grip's director is what an end's rotation is measured from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from torsade.arrays import Floats
from torsade.assembly import Assembly, assemble
from torsade.errors import TorsadeError
from torsade.motion.chain import FIXED, FREE, PLANE, SPHERE, Chain, Controls, Shape

__all__ = ["Fiber", "Support", "chain", "controls_at", "shape_along"]

GRIP_MASS = 1e-3
"""Of the neighbouring edge: grips count for nothing in the norm of a motion, but they must count."""


@dataclass(frozen=True)
class Support:
    """An end of a fiber.

    Attributes
    ----------
    tangent : "free"; "plane", confined to the plane across `normal` and free of moment in it, as by a pivot;
        "fixed", clamped in the direction that it is given
    position : which of x, y, z are held; the first end is always held in all three
    normal : of the plane
    """

    tangent: Literal["free", "plane", "fixed"] = "free"
    position: tuple[bool, bool, bool] = (True, True, True)
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)

    @property
    def gripped(self) -> bool:
        return self.tangent != "free"


@dataclass(frozen=True)
class Fiber:
    """A naturally straight fiber, in any units.

    Attributes
    ----------
    length : L [m]
    edges : number of edges, all of one length
    B, C, EA : stiffness in bending, twist [N m^2] and stretch [N]; EA = 0 for an inextensible one
    """

    length: float = 1.0
    edges: int = 200
    B: float = 1.0
    C: float = 1.0
    EA: float = 0.0


def chain(
    fiber: Fiber,
    ends: tuple[Support, Support],
    *,
    nodes: Sequence[tuple[int, int]] = (),
    angles: bool = False,
    rotation_held: bool = False,
) -> Chain:
    """The problem of a fiber between two supports; grips are edges at its ends.

    nodes are further ones that are held, each with the coordinate (0, 1 or 2) that is. What is held comes in
    this order: the coordinates of the last end, then those of nodes.
    """
    first, last = ends
    before, after = int(first.gripped), int(last.gripped)
    n = fiber.edges + before + after
    if fiber.edges < 3:
        raise TorsadeError(f"a fiber of {fiber.edges} edges cannot bend; give at least 3.")
    l = np.full(n, fiber.length / fiber.edges)
    mass = l.copy()
    freedom = np.full(n, FREE if fiber.EA > 0 else SPHERE)
    normal = np.zeros((n, 3))
    kinds = {"plane": PLANE, "fixed": FIXED}
    for e, end in ((0, first), (n - 1, last)):
        if end.gripped:
            l[e], mass[e] = 0.0, GRIP_MASS * l[1]
            freedom[e], normal[e] = kinds[end.tangent], end.normal
    held = [(fiber.edges, c) for c in range(3) if last.position[c]] + list(nodes)
    weight = np.zeros((len(held), n, 3))
    for k, (node, c) in enumerate(held):
        weight[k, before : before + node, c] = 1.0
    assembly = _assembly(l)
    return Chain(
        assembly=assembly,
        EA=float(fiber.EA),
        B=float(fiber.B),
        C=float(fiber.C),
        freedom=freedom,
        normal=normal,
        mass=mass,
        weight=weight,
        twisted_length=float(assembly.hinge_length.sum()),
        angles=angles,
        rotation_held=rotation_held,
    )


def _assembly(l: Floats) -> Assembly:
    """A straight fiber of these rest lengths (n_edges,) [m]."""
    x = np.concatenate([[0.0], np.cumsum(np.where(l > 0, l, l.max()))])
    return assemble([np.outer(x, [1.0, 0.0, 0.0])], rest_lengths=[l])


def shape_along(chain: Chain, tangent: Floats) -> Shape:
    """A shape whose edges have these unit tangents (n_edges, 3), grips among them.

    Reference directors are those carried along the fiber from its first edge, so that the reference twist
    begins at zero; it is the whole fiber's, and of ends confined to one plane the rotation's, if all
    tangents lie in that plane.
    """
    l = chain.assembly.rest_length
    edge = np.where(l > 0, l, l.max())[:, None] * tangent
    hinges = len(chain.assembly.hinges)
    return Shape(edge, np.zeros(len(l)), np.zeros(hinges), np.zeros(len(chain.weight)), 0.0)


def controls_at(
    chain: Chain,
    value: tuple[float, ...] = (),
    *,
    force: tuple[float, float, float] = (0.0, 0.0, 0.0),
    torque: float = 0.0,
    rotation: float = 0.0,
) -> Controls:
    """What is given: where the last end is held, and the dead force (3,) [N] and the torque [N m] on it."""
    held = np.zeros(len(chain.weight))
    held[: len(value)] = value
    load = np.where(chain.assembly.rest_length[:, None] > 0, np.array(force), 0.0)
    return Controls(held, load, float(torque), float(rotation))
