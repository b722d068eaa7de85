"""bend-twist: what a specification gives, what it refuses, and what is kept of it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import torsade as ts
from torsade.protocols import BendTwist, load_spec


def report(**fields: Any) -> dict[str, Any]:
    return BendTwist.report(BendTwist(**fields).run())


def test_defaults_are_the_thesis_s() -> None:
    """24 cm of spaghetti, 1.4 mm thick (3.4), not twisted."""
    spec = BendTwist(end_distance="19 cm")
    assert (spec.length, spec.h, spec.twist, spec.nodes) == (0.24, 0.7e-3, 0.0, 201)
    assert pytest.approx(1.3) == spec.fiber.B / spec.fiber.C


def test_a_bent_and_twisted_rod() -> None:
    """The rod of 24 cm, ends 19 cm apart, 270 deg: numbers of a boundary-value solution to 0.02 %."""
    found = report(length="24 cm", end_distance="19 cm", twist="270 deg")
    euler = np.pi**2 * 3.8e9 * np.pi * 0.7e-3**4 / 4 / 0.24**2
    assert found["kappa_max_per_m"] == pytest.approx(13.37549, rel=1e-4)
    assert found["kappa_middle_per_m"] == pytest.approx(13.37549, rel=1e-4)
    assert found["kappa_end_per_m"] == pytest.approx(3.9922, abs=1e-3)
    assert found["out_of_plane_m"] == pytest.approx(0.2587e-2, abs=1e-6)
    assert found["thrust_N"] == pytest.approx(1.07853 * euler, rel=1e-4)
    assert found["stable"] is True
    assert found["least_stiffness_N"] > 0 == found["unstable_motions"]
    assert found["torque_N_m"] == pytest.approx(5.512165971696645e-4 * math.radians(270) / 0.24, rel=1e-9)
    assert found["end_rotation_rad"] > math.radians(270)
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_an_arch_that_is_no_minimum_says_so() -> None:
    """At 360 deg a motion that breaks the symmetry lowers the energy, as with nearly straight rods."""
    found = report(end_distance="19 cm", twist="360 deg")
    assert found["kappa_max_per_m"] == pytest.approx(14.50412, rel=1e-4)
    assert found["stable"] is False
    assert found["unstable_motions"] == 1
    assert found["least_stiffness_N"] < 0


def test_numbers_do_not_depend_on_nodes() -> None:
    """1e-4 from 101 to 401 nodes, even and odd."""
    numbers = [
        [report(end_distance=0.15, twist=3.0, nodes=n)[key] for key in ("kappa_max_per_m", "thrust_N")]
        for n in (101, 152, 401)
    ]
    assert np.array(numbers) == pytest.approx(np.tile(numbers[-1], (3, 1)), rel=5e-4)


def test_the_range_of_a_curvature() -> None:
    """1 mm more or less in the distance; low and high are those distances' own curvatures."""
    here = report(end_distance="19 cm", end_distance_error="1 mm")
    low, high = here["kappa_max_range_per_m"]
    assert low == pytest.approx(report(end_distance="19.1 cm")["kappa_max_per_m"], rel=1e-8)
    assert high == pytest.approx(report(end_distance="18.9 cm")["kappa_max_per_m"], rel=1e-8)
    assert low < here["kappa_max_per_m"] < high
    assert report(end_distance="19 cm")["kappa_max_range_per_m"] is None


def test_a_result_is_kept_and_taken_up_again(tmp_path: Path) -> None:
    spec = BendTwist(end_distance="19 cm", twist="90 deg", nodes=51)
    made = spec.run(out=tmp_path / "bent.zarr")
    kept = ts.open(tmp_path / "bent.zarr")
    assert kept.complete
    assert kept.frames == 1
    assert kept.spec == spec.stored()
    assert BendTwist.report(kept) == BendTwist.report(made)
    largest = BendTwist.report(made)["kappa_max_per_m"]
    assert kept.dataset["curvature"].max().item() == pytest.approx(largest, rel=1e-6)
    assert kept.dataset["position"].sizes == {"time": 1, "node": 51, "space": 3}
    again = spec.run(out=tmp_path / "bent.zarr", resume=True)
    assert again.dataset.attrs["created"] == made.dataset.attrs["created"]
    with pytest.raises(ts.TorsadeError, match="exists"):
        spec.run(out=tmp_path / "bent.zarr")


def test_a_file_says_the_same(tmp_path: Path) -> None:
    (tmp_path / "bent.toml").write_text(
        'protocol = "bend-twist"\nend_distance = "19 cm"\ntwist = "270 deg"\n'
    )
    assert load_spec(tmp_path / "bent.toml") == BendTwist(end_distance=0.19, twist="270 deg")


def test_the_angle_between_the_grips_in_place_of_the_twist() -> None:
    """What the twist device is set to (thesis 3.11); the fiber's twist is a little less."""
    by_twist = report(end_distance="19 cm", twist="270 deg")
    by_grips = report(end_distance="19 cm", rotation=by_twist["end_rotation_rad"])
    for key in ("twist_rad", "kappa_max_per_m", "thrust_N", "out_of_plane_m"):
        assert by_grips[key] == pytest.approx(by_twist[key], rel=1e-7)
    with pytest.raises(ts.TorsadeError, match="are both given"):
        BendTwist(end_distance="19 cm", twist="1 deg", rotation="2 deg")


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({}, "end_distance is missing; give a distance"),
        ({"end_distance": 0.25}, "more than the fiber's length, 0.24 m"),
        ({"end_distance": -0.01}, "give a length of at least 0 m"),
        ({"end_distance": math.nan}, "not a finite number"),
        ({"end_distance": 0.19, "length": 0}, "give a length above 0 m"),
        ({"end_distance": 0.19, "twist": math.inf}, "twist inf is not a finite number"),
        ({"end_distance": 0.19, "twist": "5 m"}, "is a length, not an angle"),
        ({"end_distance": 0.001, "length": 0.005}, "less than five diameters"),
        ({"end_distance": 0.19, "nodes": 4}, "give a number of at least 5"),
        ({"end_distance": 0.19, "nodes": True}, "give a whole number"),
        ({"end_distance": 0.19, "E": "1 GPa"}, "give E_b"),
        ({"end_distance": 0.19, "eta": 1}, "no field 'eta'"),
        ({"end_distance": 0.19, "knot": "reef"}, "bends a straight fiber"),
        ({"distance": 0.19}, "did you mean 'end_distance'?"),
    ],
)
def test_specifications_refused(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(ts.TorsadeError) as caught:
        BendTwist(**fields)
    assert says in str(caught.value)
    assert ". " not in str(caught.value)


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"end_distance": 0.24}, "give a distance from 0 to less than its length"),
        ({"end_distance": 0.12, "twist": "500 deg"}, "there it snaps at 380"),
    ],
)
def test_shapes_refused(fields: dict[str, Any], says: str, tmp_path: Path) -> None:
    with pytest.raises(ts.TorsadeError) as caught:
        BendTwist(**fields).run(out=tmp_path / "bent.zarr")
    assert says in str(caught.value)
    assert ". " not in str(caught.value)
    assert list(tmp_path.iterdir()) == []
