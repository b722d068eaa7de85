"""Breaking: stress criteria, the cascade and its theory, statistics of trials, material from measurements.

| module | what it does |
| --- | --- |
| `criteria` | which bend and twist break a rod |
| `stress_kernels` | the same for compiled kernels |
| `limit`, `breaking`, `cascade` | where a rod breaks first, and how it breaks on, simulated |
| `phase` | the same for a grid of twists and curvatures |
| `rod` | the rod that theory is about |
| `theory` | waves and scalings: what is expected of a cascade |
| `trials` | broken rods in a file |
| `statistics`, `fits` | means, shares, sectors, curves through what was measured |
| `analysis` | all of that for one file |
| `measured`, `pendulum` | material of a rod from a laboratory's numbers |
"""
