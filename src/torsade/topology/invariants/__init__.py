"""Invariants of knots and links from their diagrams, exact and in integers.

Every function takes an oriented PD code (see `code`), and most of them a number of circles, components
that cross nothing. They agree on what is positive: the right-handed trefoil has three positive crossings,
signature -2 and Jones polynomial t + t^3 - t^4.
"""

from torsade.topology.invariants.alexander import alexander
from torsade.topology.invariants.code import Code, oriented
from torsade.topology.invariants.colourings import (
    QUANDLES,
    Quandle,
    colouring_polynomial,
    dihedral_colourings,
)
from torsade.topology.invariants.goeritz import determinant, signature
from torsade.topology.invariants.jones import jones
from torsade.topology.invariants.laurent import Laurent

__all__ = [
    "QUANDLES",
    "Code",
    "Laurent",
    "Quandle",
    "alexander",
    "colouring_polynomial",
    "determinant",
    "dihedral_colourings",
    "jones",
    "oriented",
    "signature",
]
