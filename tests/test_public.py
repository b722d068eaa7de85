"""Every public name is there, whatever was imported before it."""

from __future__ import annotations

import subprocess
import sys

import pytest

import torsade as ts


@pytest.mark.parametrize("name", ts.__all__)
def test_every_name_can_be_had_first(name: str) -> None:
    script = f"import torsade; assert torsade.{name} is not None"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


@pytest.mark.parametrize(
    "module", [ts.curve, ts.knots, ts.protocols, ts.topology, ts.view], ids=lambda m: m.__name__
)
def test_every_name_of_a_module(module: object) -> None:
    assert all(getattr(module, name) is not None for name in module.__all__)  # type: ignore[attr-defined]


def test_a_material_by_name() -> None:
    assert ts.named_material("nylon").E_b == 1e8
    with pytest.raises(ts.TorsadeError, match="did you mean 'nylon'"):
        ts.named_material("nilon")


def test_view_draws_nothing_before_it_is_asked_to() -> None:
    script = (
        "import sys, torsade as ts; ts.view.render_result, ts.view.plot_separation;"
        "print([m for m in ('matplotlib', 'pyvista') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
