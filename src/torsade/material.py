"""What a fiber is made of and how thick it is: `Material`, circular `Section`, and named presets.

>>> nylon = named_material("nylon")
>>> round(nylon.mu / 1e6, 3)
38.462
>>> Section(h=2e-4).J == 2 * Section(h=2e-4).I
True
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from torsade.errors import TorsadeError, quoted

__all__ = ["MATERIALS", "Material", "Preset", "Section", "named_material", "preset"]


@dataclass(frozen=True)
class Material:
    """An isotropic elastic material with internal damping.

    Attributes:
        name: what messages call it.
        E: Young's modulus in stretch [Pa].
        E_b: Young's modulus in bending [Pa]; below E for yarns and braids, whose filaments slide.
        nu: Poisson's ratio, -1 < nu < 0.5.
        rho: density [kg/m^3].
        eta: internal damping [Pa s]; 0 where only inertial motion is meant.
        twist_damping: decay rate b of twist waves [1/s].
        source: where the numbers come from.
    """

    name: str
    E: float
    E_b: float
    nu: float
    rho: float
    eta: float
    twist_damping: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        what = f"material {self.name!r}"
        for symbol, unit in (("E", "Pa"), ("E_b", "Pa"), ("rho", "kg/m^3")):
            _require_positive(what, symbol, getattr(self, symbol), unit)
        for symbol, unit in (("eta", "Pa s"), ("twist_damping", "1/s")):
            value = getattr(self, symbol)
            if not 0 <= value < math.inf:
                raise TorsadeError(
                    f"{what} has {symbol} = {value!r}; give a finite number of at least 0 [{unit}]"
                )
        if not -1 < self.nu < 0.5:
            raise TorsadeError(
                f"{what} has Poisson's ratio nu = {self.nu!r}; give a number above -1 and below 0.5"
            )

    @property
    def mu(self) -> float:
        """Shear modulus E_b/(2 + 2 nu) [Pa]: twist, like bending, is soft where filaments slide."""
        return self.E_b / (2 + 2 * self.nu)

    @property
    def K(self) -> float:
        """Bulk modulus E/(3 - 6 nu) [Pa], the stiffness of contacts."""
        return self.E / (3 - 6 * self.nu)


@dataclass(frozen=True)
class Section:
    """A circular cross section of radius h [m]."""

    h: float

    def __post_init__(self) -> None:
        _require_positive("a fiber's section", "radius h", self.h, "m")

    @property
    def A(self) -> float:
        """Area pi h^2 [m^2]."""
        return math.pi * self.h**2

    @property
    def I(self) -> float:  # noqa: E743 - the field's letter
        """Second moment about a diameter, pi h^4/4 [m^4]: bending."""
        return math.pi * self.h**4 / 4

    @property
    def J(self) -> float:
        """Second moment about the axis, pi h^4/2 [m^4]: twist."""
        return math.pi * self.h**4 / 2


@dataclass(frozen=True)
class Preset:
    """A material and the radius h [m] of the fiber it was used in."""

    material: Material
    radius: float

    @property
    def section(self) -> Section:
        return Section(self.radius)


def _require_positive(what: str, symbol: str, value: float, unit: str) -> None:
    if not 0 < value < math.inf:
        raise TorsadeError(f"{what} has {symbol} = {value!r}; give a finite number above 0 [{unit}]")


_NYLON = Material(
    name="nylon",
    E=1e9,
    E_b=1e8,
    nu=0.3,
    rho=1000.0,
    eta=1e5,
    source="thesis 4.6, prison escape: a thin, flexible nylon fiber (eta = 1e6 g/(cm s), rho = 1 g/cm^3)",
)
_OPTOMECHANICAL = Material(
    name="optomechanical",
    E=1e6,
    E_b=1e6,
    nu=0.3,
    rho=1000.0,
    eta=1e3,
    source="thesis 4.3: colour-changing elastomer fiber; also used for sutures in chapter 6",
)
_SPAGHETTI = Material(
    name="spaghetti",
    E=3.8e9,
    E_b=3.8e9,
    nu=0.3,
    rho=1500.0,
    eta=0.0,
    twist_damping=1.68e4,
    source=(
        "thesis 3.2: dry spaghetti, 2h = 1.4 mm; twist damping b = 1.3 pi c_theta/L at L = 24 cm; "
        "the thesis gives no bulk damping eta, since fracture is inertial"
    ),
)
_SILICONE = Material(
    name="silicone",
    E=5e7,
    E_b=1e7,
    nu=0.3,
    rho=1100.0,
    eta=1e4,
    source=(
        "thesis 5.2: thin lubricated silicone fibers, nu = 0.3, E/E_b = 5, eta = 10 kPa s, E_b = 10 MPa; "
        "h and rho are not in the thesis: h = 0.2 mm as in chapter 4, rho = 1100 kg/m^3 as usual for silicone"
    ),
)

MATERIALS: Mapping[str, Preset] = MappingProxyType(
    {
        p.material.name: p
        for p in (
            Preset(_NYLON, radius=2e-4),
            Preset(_OPTOMECHANICAL, radius=2e-4),
            Preset(_SPAGHETTI, radius=7e-4),
            Preset(_SILICONE, radius=2e-4),
        )
    }
)


def preset(name: str) -> Preset:
    """Return the named material with its radius.

    Raises:
        TorsadeError: no such name; the message gives the nearest and all of them.
    """
    if name in MATERIALS:
        return MATERIALS[name]
    from difflib import get_close_matches

    near = get_close_matches(str(name).lower(), MATERIALS, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise TorsadeError(f"unknown material {quoted(name)}; {hint}choose one of {', '.join(sorted(MATERIALS))}")


def named_material(name: str) -> Material:
    """Return the named material; see `preset`."""
    return preset(name).material
