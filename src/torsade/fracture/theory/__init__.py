"""Theory of the cascade of breaks: what chapter 3 derives, with its formulas corrected.

| module | what it does |
| --- | --- |
| `scales` | times of twist and of bending; energies (3.10, 3.14-3.16, 3.21, 3.22) |
| `twist_wave` | how twist leaves a rod that has just broken (3.11-3.13) |
| `bending_wave` | how curvature grows at the new end (3.20), and in a rod of finite length |
| `binary` | when a rod breaks into exactly two pieces (3.3, 3.4, 3.23) |
| `elastica` | the planar shape of a bent rod with pivoting ends, without twist |
| `quench` | rods bent at a given speed: scalings, saturation (3.7, 3.8) |
"""
