"""Fibers at rest to test on, in units of their length and bending stiffness unless said otherwise."""

from __future__ import annotations

import numpy as np

from torsade.arrays import Floats
from torsade.motion.chain import Chain, Controls, Shape
from torsade.motion.supports import Support, shape_along
from torsade.rod.elasticity import hinge_curvature

PIVOT, CLAMP, HINGE = Support("plane"), Support("fixed"), Support("free")
ACROSS = (False, True, True)
"""What is held of an end that slides along x."""

NOWHERE = (False, False, False)


def straight(chain: Chain) -> Shape:
    """Along x."""
    return shape_along(chain, np.tile([1.0, 0.0, 0.0], (len(chain.mass), 1)))


def arch(chain: Chain, slope: float) -> Shape:
    """In the plane xy, rising at this angle [rad] at its start and falling at its end."""
    angle = slope * np.cos(np.pi * np.clip(chain.assembly.edge_arclength / chain.twisted_length, 0.0, 1.0))
    return shape_along(chain, np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle]))


def waving(chain: Chain, seed: int, size: float = 0.6) -> Shape:
    """A smooth curve in space that grips allow, with twist, stretch and reactions at random."""
    rng = np.random.default_rng(seed)
    n = len(chain.mass)
    s = np.linspace(0.0, 1.0, n)
    a, b = (
        sum(c * np.sin(np.pi * k * s + p) for k, (c, p) in enumerate(size * rng.normal(size=(4, 2)), 1))
        for _ in range(2)
    )
    b = b * (np.sin(np.pi * s) if chain.freedom[0] < 2 else 1.0)
    tangent = np.column_stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])
    shape = shape_along(chain, tangent)
    stretch = np.where(chain.spheres, 1.0, 1.0 + 0.05 * rng.normal(size=n))
    return shape._replace(
        edge=shape.edge * stretch[:, None],
        theta=np.concatenate([[0.0], rng.normal(size=n - 1)]),
        reference_twist=0.1 * rng.normal(size=n - 1),
        reaction=rng.normal(size=len(chain.weight)),
        torque=1.7,
    )


def curvature(chain: Chain, shape: Shape) -> Floats:
    """At every hinge (n_hinges,)."""
    kappa = np.empty(len(chain.assembly.hinges))
    hinge_curvature(chain.assembly, shape.edge / np.linalg.norm(shape.edge, axis=1)[:, None], kappa)
    return kappa


def nodes(chain: Chain, shape: Shape) -> Floats:
    """Nodes (n_nodes, 3) without grips."""
    edge = shape.edge[chain.assembly.rest_length > 0]
    return np.concatenate([np.zeros((1, 3)), np.cumsum(edge, axis=0)])


def lagrangian(chain: Chain, shape: Shape, controls: Controls) -> float:
    """Potential less reactions times gaps, and for a rotation that is held its moment times its gap."""
    total = chain.potential(shape, controls) - float(shape.reaction @ chain.gap(shape, controls))
    if chain.rotation_held:
        assert chain.angles
        total -= shape.torque * (float(shape.theta[-1]) - controls.rotation)
    return total


def order(sizes: list[int], errors: Floats) -> float:
    """Order of convergence by regression: errors fall as size to the power of minus it."""
    return float(-np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
