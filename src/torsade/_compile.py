"""Ahead-of-use compilation of kernel modules, with an on-disk cache that cannot go stale.

Kernels are plain functions of arrays. A kernel module ends with ``compile_kernels(__name__)``, which
replaces every function defined in it by its compiled form. Numba's own cache notices a change in the
file of a function, not in the functions it calls elsewhere; so the cache directory is named by a hash
of all kernel sources, and one changed line anywhere compiles everything anew.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import sys
from pathlib import Path
from typing import Any

import numba
from numba.core import config as numba_config
from numba.core import event

# What Numba defines at run time, or leaves out of its annotations.
config: Any = numba_config
register: Any = event.register
njit: Any = numba.njit

PACKAGE = Path(__file__).parent
KERNEL_SOURCES = ("_compile.py", "assembly.py", "rod", "motion")


def source_hash() -> str:
    """Hash of every kernel source and of the compiler's version: the name of the cache directory."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info[:2]}".encode())
    for entry in KERNEL_SOURCES:
        path = PACKAGE / entry
        for file in sorted(path.glob("*.py")) if path.is_dir() else [path]:
            digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def cache_directory() -> Path | None:
    """Where compiled kernels are kept, or None when no directory can be written."""
    roots = [os.environ.get("TORSADE_CACHE_DIR"), config.CACHE_DIR, os.environ.get("XDG_CACHE_HOME")]
    root = next((Path(r) for r in roots if r), Path.home() / ".cache")
    directory = root / "torsade" / source_hash()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        return directory if os.access(directory, os.W_OK) else None
    except OSError:
        return None


CACHE = cache_directory()


class _QuickOptimisation(event.Listener):
    """Compile kernels at LLVM level 1: a third less time to compile, and the same speed afterwards."""

    def __init__(self) -> None:
        self._saved: list[Any] = []

    def on_start(self, event: event.Event) -> None:
        self._saved.append(config.OPT)
        if event.data["dispatcher"].py_func.__module__.startswith("torsade."):
            config.OPT = type(config.OPT)(1)

    def on_end(self, event: event.Event) -> None:
        config.OPT = self._saved.pop()


register("numba:compile", _QuickOptimisation())


def compile_kernels(module_name: str, inline: tuple[str, ...] = ()) -> None:
    """Compile every function that the module defines, in place; those named are always inlined.

    Private functions can be called from compiled code only: their wrappers would take long to compile.
    Passing arrays to a small function that is not inlined costs more than what it does. With
    ``NUMBA_DISABLE_JIT=1`` the functions stay plain Python and can be stepped through.
    """
    module = sys.modules[module_name]
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(CACHE) if CACHE else previous
    try:
        for name, function in list(vars(module).items()):
            if inspect.isfunction(function) and function.__module__ == module_name:
                compiled = njit(
                    cache=CACHE is not None,
                    error_model="numpy",
                    nogil=True,
                    forceinline=name in inline,
                    no_cfunc_wrapper=True,
                    no_cpython_wrapper=name.startswith("_"),
                )
                setattr(module, name, compiled(function))
    finally:
        config.CACHE_DIR = previous
