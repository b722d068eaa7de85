"""Breaking: stress criteria, theory of the cascade, statistics of trials, material from measurements.

| module | what it does |
| --- | --- |
| `criteria` | which bend and twist break a rod |
| `stress_kernels` | the same for compiled kernels |
"""
