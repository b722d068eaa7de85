"""Compilation: a cache named by its sources, and kernels that run as plain Python too."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from numba.core import event

from torsade import _compile

HERE = Path(__file__).parent


def test_hash_covers_every_kernel_source(tmp_path, monkeypatch):
    """One changed byte in any kernel file, or a renamed file, names another cache."""
    (tmp_path / "rod").mkdir()
    for name in ("_compile.py", "assembly.py", "rod/a.py", "rod/b.py"):
        (tmp_path / name).write_text(f"# {name}\n")
    monkeypatch.setattr(_compile, "PACKAGE", tmp_path)
    monkeypatch.setattr(_compile, "KERNEL_SOURCES", ("_compile.py", "assembly.py", "rod"))
    seen = {_compile.source_hash()}
    for name in ("assembly.py", "rod/a.py", "rod/b.py"):
        (tmp_path / name).write_text("x = 1\n")
        seen.add(_compile.source_hash())
    (tmp_path / "rod/b.py").rename(tmp_path / "rod/c.py")
    seen.add(_compile.source_hash())
    assert len(seen) == 5
    assert _compile.source_hash() in seen


def test_real_sources_are_found():
    """The list names files and folders that exist and hold the kernels."""
    for entry in _compile.KERNEL_SOURCES:
        path = _compile.PACKAGE / entry
        assert path.is_file() or list(path.glob("*.py"))


def test_cache_goes_where_it_is_told(tmp_path, monkeypatch):
    """TORSADE_CACHE_DIR wins; a place that cannot be made means no cache instead of an error."""
    monkeypatch.setenv("TORSADE_CACHE_DIR", str(tmp_path))
    directory = _compile.cache_directory()
    assert directory == tmp_path / "torsade" / _compile.source_hash()
    assert directory.is_dir()
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TORSADE_CACHE_DIR", str(tmp_path / "file"))
    assert _compile.cache_directory() is None


def test_compilation_leaves_the_collector_as_it_was():
    """Garbage is not collected while a kernel is compiled, and is again afterwards, or not if it was not."""
    for collecting in (True, False):
        seen = []

        def kernel(x):
            return x + 1

        class Look(event.Listener):
            def on_start(self, event, seen=seen):
                seen.append(gc.isenabled())

            def on_end(self, event, seen=seen):
                seen.append(gc.isenabled())

        (gc.enable if collecting else gc.disable)()
        try:
            with event.install_listener("numba:compile", Look()):
                assert _compile.njit(kernel)(1) == 2
            assert gc.isenabled() == collecting
        finally:
            gc.enable()
        assert False in seen


def called():
    """A kernel that another one has called, and what was compiled of it."""

    def inner(x):
        return 2.0 * x

    part = _compile.compiled(inner)

    def outer(x):
        return part(x) + 1.0

    assert _compile.compiled(outer)(3.0) == 7.0
    (compiled,) = part._inner.overloads.values()
    return part, compiled


def test_machine_code_is_made_of_entries_alone():
    """What only kernels call is compiled into them, and leaves nothing but its place in the cache."""
    part, compiled = called()
    assert isinstance(compiled.library, _compile._Part)
    assert not list(compiled.library.get_defined_functions())
    assert part(3.0) == 6.0


def test_an_unknown_numba_compiles_in_its_own_way(monkeypatch):
    """Where its inner workings may differ nothing of them is touched, and the numbers are the same."""
    monkeypatch.setattr(_compile, "KNOWN", ())
    _, compiled = called()
    assert not isinstance(compiled.library, _compile._Part)


def test_kernels_let_other_threads_go_on():
    """Every kernel releases the interpreter's lock."""
    names = [path for entry in ("rod", "motion") for path in (_compile.PACKAGE / entry).glob("*.py")]
    modules = [import_module(f"torsade.{path.parent.name}.{path.stem}") for path in names]
    kernels = [k for m in modules for k in vars(m).values() if isinstance(k, _compile.Kernel)]
    assert len(kernels) > 100
    assert all(kernel.targetoptions["nogil"] for kernel in kernels)


@pytest.mark.slow
def test_kernels_run_as_plain_python():
    """With NUMBA_DISABLE_JIT=1 the fast kernel tests pass uncompiled: nothing relies on the compiler."""
    tests = [
        "rod/test_kinematics.py::test_first_directors_are_carried_in_place",
        "rod/test_kinematics.py::test_two_ways_to_the_directors",
        "rod/test_elasticity.py::test_forces_and_moments_balance",
        "rod/test_contact.py::test_drag_torques_are_the_law_written_out",
        "rod/test_contact.py::test_contact_forces_and_moments_sum_to_zero",
        "rod/test_spin.py::test_spins_solve_the_dense_system",
        "rod/test_damping.py::test_bodies_apart_float_each_on_its_own",
        "rod/test_factor.py::test_pattern_is_that_of_the_factors",
        "rod/test_neighbours.py::test_cells_that_share_a_bucket",
        "topology/test_measures.py::test_six_stick_trefoil",
        "motion/test_rates.py::test_pulled_straight_fiber_stretches_uniformly",
        "motion/test_stepping.py::test_times_are_reached_exactly",
        "motion/test_guard.py::test_first_crossing_finds_the_first_pair_of_the_list",
    ]
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests]
    run = subprocess.run(
        command, cwd=HERE, env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout[-3000:]
