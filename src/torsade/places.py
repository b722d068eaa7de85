"""Where results lie: their names on disk, what may be replaced, and who is writing.

While a run goes on, NAME.zarr.part grows beside NAME.zarr.lock, which names the process. What is built or
replaced has a name of its own meanwhile, NAME.zarr.*.new or NAME.zarr.*.old; nothing else is ever removed.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import stat
import tempfile
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from torsade.errors import TorsadeError, reason_of

__all__ = [
    "Lock",
    "attributes",
    "check_target",
    "part_of",
    "private",
    "replace",
    "writer",
    "writing",
]

LARGEST_DESCRIPTION = 32 * 2**20
"""Largest zarr.json that is read [bytes]."""

BUSY = (
    "{out} is being written by {owner}; wait for it or give another name, or remove {lock} when no such run "
    "goes on"
)


def part_of(out: Path) -> Path:
    """Where a result is while it grows."""
    return out.with_name(out.name + ".part")


def private(path: Path, ending: str) -> Path:
    """A name beside a path that nobody else has."""
    return path.with_name(f"{path.name}.{uuid.uuid4().hex[:12]}.{ending}")


def attributes(path: Path) -> dict[str, Any] | None:
    """Attributes of a result on disk, complete or not; None when the path is nothing of ours."""
    described = path / "zarr.json"
    try:
        about = described.stat()
        if not stat.S_ISREG(about.st_mode) or about.st_size > LARGEST_DESCRIPTION:
            return None  # a pipe may never end
        found = json.loads(described.read_text(encoding="utf-8"))["attributes"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    ours = isinstance(found, dict) and "protocol" in found and "versions" in found
    return found if ours else None


def check_target(out: str | Path, overwrite: bool = False) -> Path:
    """The path to write a result to, once it is certain that this can be done and harms nothing.

    Raises
    ------
    TorsadeError
        When the name does not end in .zarr, the folder is missing or cannot be written, or something
        is there already: a result that may not be replaced, or anything else.
    """
    given, out = str(out), Path(out)
    if out.suffix != ".zarr" or out.name == ".zarr":
        raise TorsadeError(f"the output is called {given!r}; give a name that ends in .zarr")
    for path in (out, part_of(out)):
        if os.path.lexists(path) and attributes(path) is None:
            raise TorsadeError(f"{str(path)!r} exists and is not a result of torsade; give another name")
    if out.exists() and not overwrite:
        raise TorsadeError(
            f"{str(out)!r} exists already; give another name, or overwrite=True (--overwrite) to replace it"
        )
    if not out.parent.is_dir():
        raise TorsadeError(f"there is no folder {str(out.parent)!r} to write to; create it or give another")
    with writing(out), tempfile.TemporaryFile(dir=out.parent):
        pass
    return out


def replace(new: Path, path: Path) -> None:
    """Give a new folder the name of an old one, or of none; the old one stays until that is done."""
    with writing(path):
        old = private(path, "old")
        if not path.exists():
            new.rename(path)
            return
        path.rename(old)
        try:
            new.rename(path)
        except BaseException:
            old.rename(path)
            raise
        shutil.rmtree(old, ignore_errors=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn what the system says about a path that cannot be written into one sentence."""
    try:
        yield
    except OSError as error:
        raise TorsadeError(
            f"cannot write {str(path)!r} ({reason_of(error)}); give a place with room that can be written"
        ) from None


_HELD: set[Path] = set()
"""Locks of this process."""


def writer(out: Path) -> str | None:
    """Who is writing NAME.zarr or its NAME.zarr.part: a process that lives, or None."""
    lock = _lock_of(out)
    return _owner(lock) if lock.exists() else None


def _lock_of(out: Path) -> Path:
    return out.resolve().with_name(out.name + ".lock")


def _owner(lock: Path) -> str | None:
    """Who holds a lock; None when that process has ended."""
    for _ in range(2):
        with suppress(OSError, ValueError):
            number, host = lock.read_text(encoding="utf-8").split()
            if host != socket.gethostname():
                return f"process {int(number)} on {host}"
            return f"process {int(number)}" if _alive(int(number), lock) else None
        time.sleep(0.05)  # one that is being made has no text yet
    return None


def _alive(process: int, lock: Path) -> bool:
    if process == os.getpid():
        return lock in _HELD
    if os.name == "nt":
        return True  # there os.kill does not ask, it ends
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        pass  # it belongs to somebody else
    return True


class Lock:
    """NAME.zarr.lock: while it is there, the process that it names writes to NAME.zarr.

    A lock whose process has ended is taken over.

    Parameters
    ----------
    out : what is to be written
    busy : what to say of {out} when {owner} writes it and {lock} is the name of the lock

    Raises
    ------
    TorsadeError
        When another process is writing, or the lock cannot be made.
    """

    def __init__(self, out: Path, busy: str = BUSY) -> None:
        self._path = _lock_of(out)
        with writing(self._path):
            while not self._made():
                owner = _owner(self._path)
                if owner is not None:
                    raise TorsadeError(
                        busy.format(out=repr(str(out)), owner=owner, lock=repr(self._path.name))
                    )
                self._path.unlink(missing_ok=True)
        _HELD.add(self._path)

    def _made(self) -> bool:
        try:
            file = os.open(self._path, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
        except FileExistsError:
            return False
        with os.fdopen(file, "w", encoding="utf-8") as text:
            text.write(f"{os.getpid()} {socket.gethostname()}\n")
        return True

    def release(self) -> None:
        """Let others write; a second time does nothing."""
        if self._path in _HELD:
            _HELD.remove(self._path)
            with suppress(OSError):
                self._path.unlink()
