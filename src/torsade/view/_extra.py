"""The plotting libraries, imported when a picture is asked for and not before."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from torsade.errors import TorsadeError


def require(module: str) -> Any:
    """Import a module of the `view` extra, or say how to install it."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise TorsadeError(
            f"pictures need {package}, which cannot be imported here ({error}); "
            'install it with: pip install "torsade[view]".'
        ) from error
