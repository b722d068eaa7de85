"""A short run of every protocol, for what must hold of all of them; a protocol without one fails a test."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import torsade as ts
from torsade.protocols import (
    Battery,
    BendTwist,
    Pendulum,
    PrisonEscape,
    Reidemeister,
    SnapQuench,
    SnapTwist,
    Spec,
    Suture,
    Tighten,
)

SHORT: Mapping[str, Spec] = {
    spec.protocol: spec
    for spec in (
        PrisonEscape(knot="reef", duration="2 ms", frames=8),
        Tighten(knot="overhand", duration="2 ms", frames=8),
        Reidemeister(move="R2", length="8 mm", duration="0.5 s", frames=8),
        BendTwist(end_distance="19 cm", twist="270 deg"),
        SnapTwist(twist="60 deg", duration="0.4 ms", frames=20),
        SnapQuench(speed="0.5 m/s", approach="0.5 ms", after="0.4 ms", frames=20, disorder=0.02, seed=3),
        Pendulum(duration="0.4 s", frames=10),
        Battery(knot="4_1", twist=1.0, nodes=60, charging="0.3 s", duration="0.3 s", frames=12),
        Suture(throws="3,-3", friction=0.3, duration="40 ms", release="10 ms", frames=8, skin_radius="1 mm"),
    )
}
"""By protocol."""

OF_TIME = {"created", "wall_s", "resumed"}
"""Attributes that tell one run from another of the same specification."""


def assert_same(one: ts.Result, other: ts.Result) -> None:
    """The same to the bit: all arrays, and all attributes but those of times and restarts."""
    assert set(one.dataset.variables) == set(other.dataset.variables)
    for name, values in one.dataset.variables.items():
        found = other.dataset.variables[name]
        assert (values.dims, values.dtype, values.attrs) == (found.dims, found.dtype, found.attrs), name
        assert np.asarray(values).tobytes() == np.asarray(found).tobytes(), name
    first, second = ({k: v for k, v in r.dataset.attrs.items() if k not in OF_TIME} for r in (one, other))
    assert first == second
