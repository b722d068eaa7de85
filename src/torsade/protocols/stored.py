"""Stored runs: by what key they are known, and whether one is whole, can be gone on with, or is no run."""

from __future__ import annotations

import hashlib
import json
import os
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade import places, provenance, store
from torsade.errors import TorsadeError, quoted
from torsade.results import Result

if TYPE_CHECKING:
    from torsade.protocols.base import Spec

__all__ = ["check_ours", "goes_on", "is_there", "key", "opened", "report", "sources", "whole"]

NO_NUMBERS = ("view", "figures", "export", "sweep", "cli")
"""Parts of the package that no number depends on."""


def key(spec: Spec) -> str:
    """A hash of all that decides the result of a specification, 16 hexadecimal digits.

    It covers the fields in SI units, what is in a file of nodes (its name where it cannot be read, as the run
    will say), and the sources of the package.
    """
    asked = spec.stored() | {"h": spec.h}
    if "centerline" in asked:
        asked["centerline"] = _content(asked["centerline"])
    return hashlib.sha256((json.dumps(asked, sort_keys=True) + sources()).encode()).hexdigest()[:16]


def _content(path: str) -> str:
    """A hash of what is in a file."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return path


@lru_cache(maxsize=1)
def sources() -> str:
    """A hash of the sources that results come from: another version of them gives other runs."""
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*")):
        parts = path.relative_to(package).parts
        if path.suffix in (".py", ".json") and parts[0] not in NO_NUMBERS:
            digest.update("/".join(parts).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def check_ours(path: Path) -> None:
    """Refuse what stands in the place of a run, or of a growing one, and is not one.

    Raises
    ------
    TorsadeError
        When something there is not a run: it is never replaced.
    """
    for place in (path, places.part_of(path)):
        if os.path.lexists(place) and places.attributes(place) is None:
            raise TorsadeError(f"{str(place)!r} exists and is not a run; remove it")


def is_there(path: Path) -> bool:
    """Whether a run is stored that came to its end, damaged or not."""
    return (places.attributes(path) or {}).get("status") == "complete"


def whole(path: Path) -> Result | None:
    """A stored run that came to its end, every number of it read; None where there is none, or damage."""
    if not is_there(path):
        return None
    try:
        # A file that is missing would be read as zeros.
        noted = (places.attributes(path) or {}).get("chunks")
        return _read(path) if noted == store.chunk_files(path) else None
    except Exception:  # whatever the readers of damaged files stumble over
        return None


def goes_on(part: Path) -> bool:
    """Whether a growing run can be read and be gone on with by these versions."""
    found = places.attributes(part) or {}
    try:
        if found["status"] != "complete" and store.has_restart(part):
            store.check_restart(part)
        _read(part)
        provenance.check_same(found, part)
        return True
    except Exception:
        return False


def opened(path: Path) -> Result:
    """A stored run.

    Raises
    ------
    TorsadeError
        When it cannot be read.
    """
    try:
        return _read(path)
    except Exception as error:
        reason = " ".join(str(error).split()).rstrip(".")[:120] or type(error).__name__
        raise TorsadeError(
            f"the run {str(path)!r} cannot be read ({reason}); remove it, or give --fresh to run it anew"
        ) from None


def report(result: Result) -> dict[str, Any]:
    """The numbers that a run prints, of a result from anywhere; see `Result.report`."""
    from torsade.protocols.files import PROTOCOLS

    if result.protocol not in PROTOCOLS:
        raise TorsadeError(
            f"the result is of protocol {quoted(result.protocol)}, which this version does not have; read "
            "its variables from result.dataset"
        )
    if not result.complete:
        raise TorsadeError(
            f"the run is {result.status}, and its numbers come at its end; go on with it (resume=True, "
            "--resume)"
        )
    try:
        return PROTOCOLS[result.protocol].report(result)
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError) as error:
        if isinstance(error, TorsadeError):
            raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise TorsadeError(
            f"the numbers of the run cannot be read ({reason[:120]}); it is damaged, or of another version"
        ) from None


def _read(path: Path) -> Result:
    """A run, after all of it has been read once."""
    result = Result.open(path)
    for variable in result.dataset.variables.values():
        np.asarray(variable)
    return result
