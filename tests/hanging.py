"""Nothing hangs: work that could grow without bound ends within ten seconds of processor time.

That is for inputs whose size decides whether a method ends at all; how fast things are is measured by
`benchmarks`, as ratios, and not here.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["no_hang"]

HANGS = 10.0
"""Processor time [s] from which on something hangs, as for the fuzzers."""


@contextmanager
def no_hang() -> Iterator[None]:
    """Fail when what is done meanwhile takes too long; other processes do not count."""
    began = time.process_time()
    yield
    spent = time.process_time() - began
    assert spent < HANGS, f"took {spent:.1f} s of processor time, more than {HANGS:g} s"
