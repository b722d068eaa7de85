"""How fast torsade is, and how far its results are converged: one script for each question.

Run from the root of the repository, for example `python -m benchmarks.step`. Every script takes `--json`
for numbers instead of a table and `--quick` for a run of seconds that only shows that it works.
"""
