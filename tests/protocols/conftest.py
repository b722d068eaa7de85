"""Where the reference data lies, and runs that several tests look at."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[3] / "shared"))


@pytest.fixture(scope="session")
def bends() -> Path:
    """Folder of the published centerlines."""
    folder = SHARED / "data" / "bends"
    if not folder.is_dir():
        pytest.skip("the reference bends are not here; give their folder in TORSADE_SHARED")
    return folder
