"""The rod that breaks: its material, its radius, its length, and what theory makes of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from torsade.errors import TorsadeError
from torsade.material import Material, Section, named_material

__all__ = ["Rod", "spaghetti"]


@dataclass(frozen=True)
class Rod:
    """A straight rod of circular section, inextensible, unstressed when straight.

    Attributes
    ----------
    E, mu : Young's modulus in bending and shear modulus [Pa]
    rho : density [kg/m^3]
    h, L : radius and length [m]
    """

    E: float
    mu: float
    rho: float
    h: float
    L: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not 0 < value < math.inf:
                raise TorsadeError(f"a rod has {field.name} = {value!r}; give a finite number above 0")
        if 2 * self.h > self.L:
            raise TorsadeError(
                f"a rod of radius h = {self.h:g} m has length L = {self.L:g} m, less than its diameter; "
                "give a longer one"
            )

    @classmethod
    def of(cls, material: Material, h: float, L: float) -> Rod:
        """The rod of a material with radius h and length L [m]."""
        return cls(material.E_b, material.mu, material.rho, h, L)

    @property
    def nu(self) -> float:
        """Poisson's ratio E/(2 mu) - 1."""
        return self.E / (2 * self.mu) - 1

    @property
    def section(self) -> Section:
        return Section(self.h)

    @property
    def B(self) -> float:
        """Stiffness in bending E I [N m^2]."""
        return self.E * self.section.I

    @property
    def C(self) -> float:
        """Stiffness in twist mu J [N m^2]."""
        return self.mu * self.section.J

    @property
    def c_s(self) -> float:
        """Speed of sound along the rod, sqrt(E/rho) [m/s]."""
        return math.sqrt(self.E / self.rho)

    @property
    def c_theta(self) -> float:
        """Speed of twist waves without damping, sqrt(mu/rho) [m/s]."""
        return math.sqrt(self.mu / self.rho)


def spaghetti(set_: int = 1) -> Rod:
    """The thesis's rods: set 1 is 24 cm long and 1.4 mm thick, set 2 is 20 cm and 1.7 mm."""
    h, L = {1: (7e-4, 0.24), 2: (8.5e-4, 0.20)}[set_]
    return Rod.of(named_material("spaghetti"), h, L)
