"""The examples in docstrings are the specification of discrete things."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import torsade.topology

MODULES = [m.name for m in pkgutil.walk_packages(torsade.topology.__path__, "torsade.topology.")]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name: str) -> None:
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert not failed
