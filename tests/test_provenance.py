"""What results say of where they come from: versions, kernels, machine; nothing that names anybody."""

from __future__ import annotations

import getpass
import json
import os
import platform
import socket
import sys
from importlib.metadata import version

import pytest

from torsade import _compile, provenance


def test_versions_are_those_that_are_installed() -> None:
    found = provenance.versions()
    assert found["python"] == ".".join(map(str, sys.version_info[:3]))
    for name in ("numpy", "scipy", "numba", "llvmlite", "xarray", "zarr"):
        assert found[name] == version(name)
    assert set(provenance.SAME_VERSIONS) <= set(found)


def test_kernels_are_named_by_their_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that were loaded: what is written into the files meanwhile is not what computes."""
    before = provenance.present()["kernels"]
    assert before == _compile.source_hash()
    monkeypatch.setattr(_compile, "KERNEL_SOURCES", (*_compile.KERNEL_SOURCES, "units.py"))
    assert _compile.source_hash() != before
    assert provenance.present()["kernels"] == before


def test_the_machine_is_described_and_not_named() -> None:
    found = provenance.machine()
    assert found["architecture"] == platform.machine()
    assert found["cores"] == os.cpu_count()
    assert found["processor"]
    assert found["compiled_for"]
    assert json.loads(json.dumps(found)) == found
    assert not {socket.gethostname(), platform.node(), getpass.getuser()} & set(map(str, found.values()))


def test_the_processor_is_read_where_the_system_says_it(monkeypatch: pytest.MonkeyPatch) -> None:
    from pathlib import Path

    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(
        Path, "read_text", lambda self, **_: "processor\t: 0\nmodel name\t: Abacus 3\n\nflags: a\n"
    )
    assert provenance._processor() == "Abacus 3"

    def nothing(self: Path, **_: object) -> str:
        raise FileNotFoundError

    monkeypatch.setattr(Path, "read_text", nothing)
    assert provenance._processor() in (platform.processor(), platform.machine())
