"""What all tests share: shared helpers are importable as `rod.helpers`."""

import signal
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import pytest

# A shell begins background jobs with Ctrl-C ignored, and they hand that on to what they begin.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Where the short run of a protocol is stored, which is run once; to be read, not changed."""
    from short_runs import SHORT

    @lru_cache
    def path(protocol: str) -> Path:
        out = tmp_path_factory.mktemp("stored") / f"{protocol}.zarr"
        SHORT[protocol].run(out=out)
        return out

    return path
