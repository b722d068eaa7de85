"""Where numbers come from: versions, compiled kernels and the machine, as results note them."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from torsade import __version__, _compile
from torsade.errors import TorsadeError, quoted

__all__ = ["ANEW", "SAME_VERSIONS", "check_same", "check_same_run", "cores", "machine", "present", "versions"]

ANEW = "give --overwrite (overwrite=True) in place of resume to begin anew"

LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "xarray", "zarr")

SAME_VERSIONS = ("torsade", "numba", "llvmlite", "numpy", "scipy")
"""A run goes on with these in the versions that it was begun with: others may round otherwise."""


def cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def present() -> dict[str, Any]:
    """What decides numbers here and now: `versions`, `kernels` (a hash of their sources), `machine`."""
    return {"versions": versions(), "kernels": _compile.SOURCES, "machine": machine()}


def versions() -> dict[str, str]:
    """Of what results are computed and stored with."""
    return {"torsade": __version__, "python": platform.python_version(), **_libraries()}


@lru_cache(maxsize=1)
def _libraries() -> dict[str, str]:
    """Those that are installed, which the disk says; what is imported does not change."""
    return {name: version(name) for name in LIBRARIES}


@lru_cache(maxsize=1)
def _facts() -> dict[str, Any]:
    from llvmlite import binding

    return {
        "architecture": platform.machine(),
        "processor": _processor(),
        "compiled_for": binding.get_host_cpu_name(),
        "system": platform.system(),
        "libc": " ".join(part for part in platform.libc_ver() if part),
        "cores": os.cpu_count() or 1,
    }


def machine() -> dict[str, Any]:
    """What of this machine may decide how numbers round and how long they take; no names of it or of users.

    `processor` is what it is called, `compiled_for` what the compiler takes it for, `libc` where sines and
    logarithms come from.
    """
    return dict(_facts())


def _processor() -> str:
    """The model of the processor as the system names it; its architecture where it does not."""
    with suppress(OSError, ValueError, subprocess.SubprocessError):
        if sys.platform == "darwin":
            asked = ["sysctl", "-n", "machdep.cpu.brand_string"]
            return subprocess.run(asked, capture_output=True, text=True, check=True, timeout=5).stdout.strip()
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition(":")
            if name.strip() in ("model name", "Model"):
                return value.strip()
    return platform.processor() or platform.machine()


def check_same(found: Mapping[str, Any], path: Path) -> None:
    """Refuse to mix what different versions compute.

    Raises
    ------
    TorsadeError
        When a run with the attributes `found`, stored at `path`, was begun with something else than there is
        now that may round otherwise.
    """
    advice = f"which may round otherwise; go on with the earlier version, or {ANEW}"
    now, then = versions(), found["versions"]
    for name in SAME_VERSIONS:
        if now[name] != then.get(name):
            before = f"{name} {then[name]}" if name in then else f"an unknown version of {name}"
            raise TorsadeError(
                f"{str(path)!r} was begun with {before}, and this is {name} {now[name]}, {advice}"
            )
    kernels = _compile.SOURCES
    if found.get("kernels") != kernels:
        before = found.get("kernels", "unknown")
        raise TorsadeError(
            f"{str(path)!r} was begun with other kernels (sources {before}, and here {kernels}), {advice}"
        )


def check_same_run(asked: Mapping[str, Any], found: Mapping[str, Any], path: Path) -> None:
    """Refuse to go on with the frames of another run.

    Raises
    ------
    TorsadeError
        When what was asked for, meant or begun from, by the attributes of both, differs; the first such thing
        is named.
    """
    mine, theirs = json.loads(asked["spec"]), json.loads(found["spec"])
    for name in sorted(mine.keys() | theirs.keys()):
        # A centerline may have been moved; what it says is in the hash of the start.
        if mine.get(name) != theirs.get(name) and not (name == "centerline" and name in mine.keys() & theirs):
            raise TorsadeError(
                f"{str(path)!r} was begun with {name} = {theirs.get(name)!r}, not {mine.get(name)!r}; "
                f"resume with the same specification, or {ANEW}"
            )
    mine, theirs = (json.loads(attrs.get("model", "{}")) for attrs in (asked, found))
    for name in mine:
        if mine[name] != theirs.get(name):
            raise TorsadeError(
                f"{str(path)!r} was begun when {name} meant {quoted(theirs.get(name), 200)}, and now it "
                f"means {quoted(mine[name], 200)}; {ANEW}"
            )
    if asked["start"] != found.get("start"):
        raise TorsadeError(
            f"{str(path)!r} was begun from other node positions; give the same centerline, or {ANEW}"
        )
