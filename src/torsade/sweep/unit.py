"""The unit of work of a sweep: a specification and its key in, numbers or the reason of a failure out.

This is what a worker imports. What it computes depends on the specification alone.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from torsade.errors import TorsadeError, reason_of
from torsade.sweep.processes import heed

if TYPE_CHECKING:
    from torsade.protocols.base import Progress, Spec

__all__ = ["OTHER_VERSION", "Outcome", "Unit", "flat", "run_batch"]

OTHER_VERSION = "other sources"
"""Status of units that a worker with another version of the package was given."""

_ONE_AT_A_TIME = threading.Lock()
"""Runs use one thread; a worker with several would let them share a core."""


class Unit(NamedTuple):
    """A specification to run, and the key of its result."""

    key: str
    spec: Spec


class Outcome(NamedTuple):
    """What became of a unit.

    Attributes
    ----------
    key : of the unit
    status : "done", "failed", or `OTHER_VERSION`
    reason : one sentence when it failed, otherwise None
    numbers : what the protocol reports, without nesting
    wall : how long it took [s]
    versions : of what it was computed with
    """

    key: str
    status: str
    reason: str | None
    numbers: Mapping[str, Any]
    wall: float
    versions: Mapping[str, str]


def run_batch(units: Sequence[Unit], sources: str, folder: str | None) -> list[Outcome]:
    """Run units one after another; those that are through when this process is asked to stop.

    Parameters
    ----------
    units : what to run
    sources : the hash of the package's sources where the keys were made
    folder : where whole results are kept as KEY.zarr, or None
    """
    from torsade.protocols import stored

    if stored.sources() != sources:
        return [Outcome(unit.key, OTHER_VERSION, None, {}, 0.0, {}) for unit in units]
    _versions()  # imports what runs need, which is not their time
    done: list[Outcome] = []
    with _ONE_AT_A_TIME:
        try:
            for unit in units:
                heed(0.0, "")
                done.append(_run(unit, folder))
        except KeyboardInterrupt:
            pass
    return done


def _run(unit: Unit, folder: str | None) -> Outcome:
    began = time.perf_counter()
    numbers: dict[str, Any] = {}
    status, reason = "done", None
    try:
        numbers = flat(_reported(unit, folder, heed), unit.spec.stored())
    except TorsadeError as error:
        status, reason = "failed", " ".join(str(error).split()).rstrip(".")
    except Exception as error:  # whatever one run stumbles over, the others go on
        text = " ".join(str(error).split()).rstrip(".")[:300]
        status, reason = "failed", f"{type(error).__name__}: {text}" if text else type(error).__name__
    return Outcome(unit.key, status, reason, numbers, time.perf_counter() - began, _versions())


def _reported(unit: Unit, folder: str | None, progress: Progress) -> dict[str, Any]:
    """The numbers of a run, which is stored whole where that is wanted: aside first, then under its name."""
    from torsade import places
    from torsade.protocols import stored

    spec = unit.spec
    if folder is None:
        return type(spec).report(spec.run(progress))
    path = Path(folder) / f"{unit.key}.zarr"
    found = stored.whole(path)
    if found is not None:
        return type(spec).report(found)
    try:
        Path(folder).mkdir(exist_ok=True)
    except OSError as error:
        raise TorsadeError(f"cannot make the folder {folder!r} ({reason_of(error)})") from None
    new = places.private(path.with_suffix(""), "new.zarr")
    numbers = type(spec).report(spec.run(progress, new))
    places.replace(new, path)
    return numbers


@lru_cache(maxsize=1)
def _versions() -> dict[str, str]:
    from torsade.protocols import driving  # noqa: F401
    from torsade.provenance import versions

    return versions()


def flat(report: Mapping[str, Any], spec: Mapping[str, Any]) -> dict[str, Any]:
    """A report without nesting: tables within become NAME_KEY, lists of tables a list for each of their keys.

    What repeats a field of the specification, and the computing time, are left out; what has the name of a
    field and is something else becomes NAME_found, such as the twist that a battery comes to have.
    """
    found: dict[str, Any] = {}
    for name, value in _entries("", report):
        if name not in spec:
            found[name] = value
        elif value != spec[name]:
            found[f"{name}_found"] = value
    found.pop("wall_s", None)
    return found


def _entries(prefix: str, table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _entries(f"{prefix}{name}_", value)
        elif isinstance(value, list) and value and all(isinstance(entry, Mapping) for entry in value):
            for key in dict.fromkeys(key for entry in value for key in entry):
                yield f"{prefix}{name}_{key}", [entry.get(key) for entry in value]
        else:
            yield f"{prefix}{name}", value
