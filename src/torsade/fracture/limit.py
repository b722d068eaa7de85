"""The shape at which a twisted rod that is bent slowly breaks first."""

from __future__ import annotations

import math

import numpy as np

from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.fracture.criteria import limit_curvature, torsion_limit
from torsade.material import Material, Section
from torsade.motion.equilibrium import Bent, bent_until
from torsade.motion.supports import Fiber

__all__ = ["breaking_shape", "rod_fiber"]

ACCURACY = 1e-9
"""Relative error of the curvature at which the rod breaks."""

MOST_SHAPES = 40

SLIGHT = 1e-3
"""Curvature times length below which a rod is not told from a straight one."""


def rod_fiber(material: Material, section: Section, length: float, edges: int) -> Fiber:
    """An inextensible rod for `torsade.motion.equilibrium`, of a length [m]."""
    return Fiber(length, edges, material.E_b * section.I, material.mu * section.J)


def breaking_shape(
    fiber: Fiber,
    material: Material,
    section: Section,
    total_twist: float,
    strength: Floats,
    criterion: str = "effective",
) -> tuple[Bent, int]:
    """The rod in the twist device, bent until a hinge comes to its strength, and which hinge that is.

    Twist is uniform, so each hinge has a curvature at which it breaks. The rod is bent until the largest
    curvature anywhere is that of the weakest hinge, then further by the factor that the nearest hinge still
    bears, until that is 1; a uniform rod breaks in the middle, at the first shape.

    Parameters
    ----------
    fiber : the rod, see `rod_fiber`
    total_twist : [rad]
    strength : (n_hinges,) of the criterion named [Pa]

    Raises
    ------
    TorsadeError
        When twist alone breaks the rod, or no bending does.
    """
    E, mu, h = material.E_b, material.mu, section.h
    limit = torsion_limit(fiber.length, float(strength.min()), mu, h, criterion)
    if not abs(total_twist) < limit:
        raise TorsadeError(
            f"a twist of {math.degrees(total_twist):.4g} deg breaks the straight rod, which bears less than "
            f"{math.degrees(limit):.4g} deg; give less twist"
        )
    density = total_twist / fiber.length
    bears = np.array([float(limit_curvature(density, s, E, mu, h, criterion)) for s in strength])
    wanted = float(bears.min())
    if wanted * fiber.length < SLIGHT:
        raise TorsadeError(
            f"the rod breaks all but straight, at a curvature of {wanted:.4g} 1/m; give a larger sigma_c, or "
            "less twist"
        )
    shape: Bent | None = None
    for _ in range(MOST_SHAPES):
        try:
            shape = bent_until(fiber, wanted, total_twist, shape)
        except TorsadeError:
            raise TorsadeError(
                f"the rod would break at a curvature of {wanted:.4g} 1/m, and one of length "
                f"{1e3 * fiber.length:.4g} mm does not bend so far at this twist; give a smaller sigma_c "
                "or a longer rod"
            ) from None
        share = shape.kappa[1:-1] / bears
        weakest = int(np.argmax(share))
        if abs(share[weakest] - 1.0) <= ACCURACY:
            return shape, weakest
        wanted /= float(share[weakest])
    raise TorsadeError(
        f"no bending breaks a rod of length {fiber.length:g} m at a twist of "
        f"{math.degrees(total_twist):.4g} deg; give less disorder, or a smaller sigma_c"
    )
