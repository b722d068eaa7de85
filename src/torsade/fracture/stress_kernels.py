"""The stress criteria for compiled kernels: `squared_stress` of `criteria`, compiled.

    from torsade.fracture.stress_kernels import squared_stress

    squared_stress(criterion, E * h * kappa, mu * h * abs(theta_prime)) > sigma_c**2

with `criterion` one of `criteria.CRITERIA`, numbers for a and b, and the strength of that criterion.
"""

from __future__ import annotations

from torsade._compile import compiled
from torsade.fracture import criteria

__all__ = ["squared_stress"]

squared_stress = compiled(criteria.squared_stress)
