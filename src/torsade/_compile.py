"""Ahead-of-use compilation of kernel modules, with an on-disk cache that cannot go stale.

Kernels are plain functions of arrays. A kernel module ends with ``compile_kernels(__name__)``, which
replaces every function defined in it by its compiled form. Numba's own cache notices a change in the
file of a function, not in the functions it calls elsewhere; so the cache directory is named by a hash
of all kernel sources, and one changed line anywhere compiles everything anew.
"""

from __future__ import annotations

import gc
import hashlib
import inspect
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding, ir
from numba.core import codegen, compiler, event
from numba.core import config as numba_config

# What Numba defines at run time, or leaves out of its annotations.
config: Any = numba_config
register: Any = event.register
njit: Any = numba.njit

PACKAGE = Path(__file__).parent
KERNEL_SOURCES = (
    "_compile.py",
    "arrays.py",
    "assembly.py",
    "topology",
    "rod",
    "motion",
    "fracture/breaking.py",
    "fracture/criteria.py",
    "fracture/stress_kernels.py",
    "knots/band.py",
    "knots/spread.py",
    "knots/tight_kernels.py",
)


def source_hash() -> str:
    """Hash of every kernel source as it is on disk, and of the compiler's version."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info[:2]}".encode())
    for entry in KERNEL_SOURCES:
        path = PACKAGE / entry
        for file in sorted(path.glob("*.py")) if path.is_dir() else [path]:
            digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]


SOURCES = source_hash()
"""Hash of the kernels that this process runs: the name of the cache directory."""


def cache_directory() -> Path | None:
    """Where compiled kernels are kept, or None when no directory can be written."""
    roots = [os.environ.get("TORSADE_CACHE_DIR"), config.CACHE_DIR, os.environ.get("XDG_CACHE_HOME")]
    root = next((Path(r) for r in roots if r), Path.home() / ".cache")
    directory = root / "torsade" / SOURCES
    try:
        directory.mkdir(parents=True, exist_ok=True)
        return directory if os.access(directory, os.W_OK) else None
    except OSError:
        return None


CACHE = cache_directory()


class _QuickCompilation(event.Listener):
    """Compile kernels at LLVM level 1, a third less time and the same speed afterwards, and without garbage
    collection, which finds nothing in what the compiler keeps and takes a tenth of the time."""

    def __init__(self) -> None:
        self._saved: list[tuple[Any, bool]] = []

    def on_start(self, event: event.Event) -> None:
        self._saved.append((config.OPT, gc.isenabled()))
        gc.disable()
        if event.data["dispatcher"].py_func.__module__.startswith("torsade."):
            config.OPT = type(config.OPT)(1)

    def on_end(self, event: event.Event) -> None:
        config.OPT, collecting = self._saved.pop()
        if collecting:
            gc.enable()


register("numba:compile", _QuickCompilation())


class _Once(event.Listener):
    """Calls a function when a compilation begins, the first time."""

    def __init__(self, call: Callable[[], object]) -> None:
        self._call: Callable[[], object] | None = call

    def on_start(self, event: event.Event) -> None:
        call, self._call = self._call, None
        if call is not None:
            call()

    def on_end(self, event: event.Event) -> None:
        pass


@contextmanager
def when_compiling(call: Callable[[], object]) -> Iterator[None]:
    """Call a function, once, if anything is compiled meanwhile; what comes from the cache does not count."""
    with event.install_listener("numba:compile", _Once(call)):
        yield


KNOWN = ((0, 68),)
"""Versions of Numba whose inner workings are as `_Part` expects them. By others kernels are compiled as Numba
does by itself, which takes up to twice as long and gives the same."""


class _Part(codegen.JITCodeLibrary):
    """Code that becomes part of its callers'.

    They are optimised as a whole, so here it is only tidied up, and no machine code is made of it: of every
    function of a call tree that would be made, and optimised, once for each of its callers.
    """

    def _optimize_final_module(self) -> None:
        level, config.OPT = config.OPT, type(config.OPT)(0)
        try:
            super()._optimize_final_module()
        finally:
            config.OPT = level

    def _finalize_final_module(self) -> None:
        self._finalized = True
        self._shared_module = self._get_module_for_linking()
        self._final_module: Any = _places(self._final_module)
        super()._finalize_final_module()


def _places(module: Any) -> Any:
    """A module with no more than the places in which Numba leaves the environments of another's functions."""
    places = ir.Module(module.name)
    places.triple = module.triple
    for place in module.global_variables:
        if place.linkage == binding.Linkage.common:
            held = ir.GlobalVariable(places, ir.IntType(8).as_pointer(), place.name)
            held.linkage, held.initializer = "common", ir.Constant(held.value_type, None)
    return binding.parse_assembly(str(places))


class _PartCompiler(compiler.Compiler):
    """Compiles functions for other kernels to call."""

    def compile_extra(self, func: Callable[..., Any]) -> Any:
        self.state.library = _Part(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(func)


def _pipeline() -> type[compiler.Compiler]:
    """What compiles kernels for other kernels, as far as this version of Numba is known."""
    return _PartCompiler if numba.version_info.short in KNOWN else compiler.Compiler


class Kernel:
    """A compiled function of a kernel module.

    Other kernels call it directly, compiled without an entry for Python: entries that unpack many arrays
    take as long to compile as the kernels. A call from Python compiles such an entry when it first comes.
    """

    def __init__(self, function: Callable[..., Any], counting: bool, **options: Any) -> None:
        self.__doc__ = function.__doc__
        self.__name__ = function.__name__
        self.__module__ = function.__module__
        self.py_func = function
        self._options = options
        with _caching("kernels"):
            self._inner = njit(no_cpython_wrapper=True, _nrt=counting, pipeline_class=_pipeline(), **options)(
                function
            )
        self.targetoptions = self._inner.targetoptions
        self._entry: Callable[..., Any] | None = None

    @property
    def _numba_type_(self) -> Any:
        """What the compiler sees."""
        return self._inner._numba_type_

    def __call__(self, *args: Any) -> Any:
        if self._entry is None:
            with _DECLARING, _caching("entries"):
                self._entry = self._entry or njit(**self._options)(self.py_func)
        return self._entry(*args)


_DECLARING = threading.Lock()
"""The folder of the cache belongs to all threads."""


@contextmanager
def _caching(folder: str) -> Iterator[None]:
    """Let functions declared meanwhile be cached in a folder of the cache."""
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(CACHE / folder) if CACHE else previous
    try:
        yield
    finally:
        config.CACHE_DIR = previous


def compile_kernels(
    module_name: str,
    inline: tuple[str, ...] = (),
    splice: tuple[str, ...] = (),
    owning: tuple[str, ...] = (),
    plain: tuple[str, ...] = (),
) -> None:
    """Compile every function that the module defines, in place; those named plain stay as they are.

    Functions named under inline become part of the machine code of their callers: passing arrays to a
    small function costs more than what it does. Functions named under splice, called in one place only,
    become part of their caller before compilation, which spares compiling all they call once more.
    Functions named under owning make arrays, or are given new ones by what they call, and count references
    to arrays; the others only borrow, and save the atomic operations (the compiler refuses a function that
    makes arrays and is not named). A product and a sum may round once. With ``NUMBA_DISABLE_JIT=1`` all
    functions stay plain Python and can be stepped through.
    """
    if config.DISABLE_JIT:
        return
    module = sys.modules[module_name]
    for name, function in list(vars(module).items()):
        own = inspect.isfunction(function) and function.__module__ == module_name
        if own and name not in plain:
            options: dict[str, Any] = {}
            if name in inline:
                options["forceinline"] = True
            if name in splice:
                options["inline"] = "always"
            setattr(module, name, compiled(function, name in owning, **options))


def compiled(function: Callable[..., Any], counting: bool = False, **options: Any) -> Callable[..., Any]:
    """The compiled form of one function, which stays as it is; as `compile_kernels`, with more options."""
    if config.DISABLE_JIT:
        return function
    common = {
        "cache": CACHE is not None,
        "error_model": "numpy",
        "nogil": True,
        "no_cfunc_wrapper": True,
        "fastmath": {"contract"},
    }
    return Kernel(function, counting, **common | options)
