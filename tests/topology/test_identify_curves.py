"""Polylines in space are named as what they are, turned and shaken; open ones, closed at infinity."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from topology.curves import random_directions
from topology.drawings import closed_knots
from torsade import curve
from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.knots import bend_diagram, strand
from torsade.topology import (
    braid_curves,
    identify,
    identify_curves,
    identify_open,
    identify_strands,
    is_isomorphic,
    project,
)
from torsade.topology.codes import from_braid, from_dt, from_pd, from_text, to_open_pd, to_pd
from torsade.topology.identify import name_open
from torsade.topology.invariants import alexander, jones, oriented, signature
from torsade.topology.table import entries

ENTRIES = {entry.name: entry for entry in entries()}


def shaken(curves: list[Floats], seed: int) -> list[Floats]:
    """Turned at random, and each node moved by 0.45 of the clearance: no two edges can pass each other."""
    reach = 0.45 * curve.clearance(curves, [True] * len(curves), 0.0).distance
    turned = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    return [x @ turned.T + reach * random_directions(seed + k, len(x)) for k, x in enumerate(curves)]


def test_every_knot_from_every_code() -> None:
    """249 entries from PD, DT and braid: one name, one chirality, one set of invariants."""
    for name, row in closed_knots().items():
        base = ENTRIES[name]
        mirror = ENTRIES.get("m" + name, base)
        for drawn, allowed in [
            (from_pd(row["pd"]), [base]),
            (from_dt(row["dt"]), [base, mirror]),
            *((from_braid(word), [base]) for word in row["braids"]),
        ]:
            found = identify(drawn)
            entry = next(entry for entry in allowed if (entry.name,) == found.names)
            code = oriented(to_pd(drawn))
            assert (jones(code), alexander(code), signature(code)) == (
                entry.jones,
                entry.alexander,
                entry.signature,
            )


def test_5_1_and_the_mirror_image_of_10_132() -> None:
    """They share both polynomials, and the signature tells them apart or colourings do."""
    rows = closed_knots()
    five, ten = from_pd(rows["5_1"]["pd"]), from_pd(rows["10_132"]["pd"])
    one, two = oriented(to_pd(five)), oriented(to_pd(ten.mirror()))
    assert (jones(one), alexander(one)) == (jones(two), alexander(two))
    assert identify(five).names == ("5_1",)
    assert identify(ten.mirror()).names == ("m10_132",)
    assert identify(ten).names == ("10_132",)


def test_every_knot_as_a_shaken_polyline_of_200_nodes() -> None:
    for seed, (name, row) in enumerate(closed_knots().items()):
        for word in row["braids"]:
            (x,) = braid_curves(word)
            assert len(x) == 200
            assert identify_curves(shaken([x], seed)).names == (name,), name


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ([1, 1, 1, 2, 2, 2], "3_1#3_1"),
        ([1, 1, 1, -2, -2, -2], "3_1#m3_1"),
        ([1, 1, -2, 1, -2], "mL5a1"),
        ([-1, -1, 2, -1, 2], "L5a1"),
        ([1, -2, 1, -2, 1, -2], "L6a4"),
    ],
)
@pytest.mark.parametrize("seed", range(5))
def test_sums_and_links_as_shaken_polylines(word: list[int], name: str, seed: int) -> None:
    found = identify_curves(shaken(braid_curves(word), seed))
    assert (found.names, found.certain) == ((name,), True)


@pytest.mark.parametrize("word", [[1], [1, 1, 1], [1, -2, 1, -2], [2, -1, 3, -2, 1, 1, -3], [1, 3]])
def test_closed_braids_in_space_have_the_crossings_of_their_words(word: list[int]) -> None:
    """Seen from above as `from_braid` draws them, no two strands nearer than 0.7 of their distance."""
    curves = braid_curves(word, nodes=400)
    drawn, wanted = project(curves, True).diagram, from_braid(word)
    assert sorted(drawn.signs) == sorted(wanted.signs)
    assert [str(one) for one in identify_strands(drawn)] == [str(one) for one in identify_strands(wanted)]
    assert identify(drawn).names == identify(wanted).names
    assert sum(map(len, curves)) == pytest.approx(400, abs=len(curves))
    assert curve.clearance(curves, [True] * len(curves), 2.0).distance > 0.7


def test_strands_that_cross_nothing_are_rings() -> None:
    rings = braid_curves([1], n_strands=3)
    assert [len(x) for x in rings] == [len(rings[0]), 200 - len(rings[0])]
    assert identify_curves(rings).names == ("0_1 ⊔ 0_1",)
    assert identify_curves(braid_curves([], n_strands=1)).names == ("0_1",)
    with pytest.raises(TorsadeError, match="no generator"):
        braid_curves([1, 0])


# --- open curves


def test_an_overhand_knot_is_a_trefoil_from_nearly_everywhere() -> None:
    (x,) = strand("overhand", "1 mm").strands
    found = identify_open(x)
    assert found.directions == 100
    assert sum(found.fractions.values()) == pytest.approx(1)
    assert found.name in ("3_1", "m3_1")
    assert found.fractions[found.name] > 0.9
    (mirrored,) = (x * (1, 1, -1),)
    assert {found.name, identify_open(mirrored).name} == {"3_1", "m3_1"}


def test_a_straight_line_is_unknotted_from_everywhere() -> None:
    line = np.linspace((0, 0, 0), (1, 0.1, 0.2), 10)
    assert identify_open(line).fractions == {"0_1": 1.0}


def test_an_open_curve_is_named_whatever_its_place_and_size() -> None:
    (x,) = braid_curves([1, -2, 1, -2])
    cut = np.concatenate([x[60:], x[:58]])
    one = identify_open(cut, 40, seed=3).fractions
    turned = Rotation.random(rng=np.random.default_rng(1)).as_matrix()
    two = identify_open(1e-4 * cut @ turned.T + 7, 40, seed=3).fractions
    assert max(one, key=one.__getitem__) == "4_1"
    assert abs(one["4_1"] - two["4_1"]) < 0.25
    with pytest.raises(TorsadeError, match="0 directions"):
        identify_open(cut, 0)


# --- codes as text


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("[[1,5,2,4],[3,1,4,6],[5,3,6,2]]", "3_1"),
        ("PD[X[1,5,2,4], X[3,1,4,6], X[5,3,6,2]]", "3_1"),
        ("[(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)]", "3_1"),
        ("DT: [4,6,2]", "3_1"),
        ("dt(4 6 2)", "3_1"),
        ("DT[{4, 6, 2}]", "3_1"),
        ("O1+ U2+ O3+ U1+ O2+ U3+", "3_1"),
        ("gauss: O1-U2-", None),
        ("Gauss: [-1,2,-3,1,-2,3]", "3_1"),
        ("{1, 1, 1}", "3_1"),
        ("braid: -1 -1 -1", "m3_1"),
        ("Braid[{1,-2,1,-2}]", "4_1"),
        ("[3 2]", "5_2"),
        ("Conway: 22", "4_1"),
        ("C[3;3;2-]", "8_19"),
        ("O1+ U2+ | U1+ O2+", "L2a1"),
        ("DT: [(4),(2)]", "L2a1"),
    ],
)
def test_codes_as_text(text: str, name: str | None) -> None:
    """Up to mirror images where the code leaves these open, or the notation has another handedness."""
    if name is None:
        with pytest.raises(TorsadeError):
            from_text(text)
        return
    found = str(identify(from_text(text)))
    assert found.removeprefix("m") == name.removeprefix("m")
    if text.lower().startswith(("[[", "[(", "pd", "o", "braid", "{")):
        assert found == name


def test_the_code_of_a_tangle_as_text() -> None:
    reef = bend_diagram("reef")
    text = " ".join(f"X[{','.join(row)}]" for row in to_open_pd(reef))
    assert is_isomorphic(from_text(text), reef)


def test_the_name_is_found_with_fewer_directions() -> None:
    """That of all of them, for walks that are knotted more or less."""
    random = np.random.default_rng(2)
    for _ in range(12):
        x = np.cumsum(random.normal(size=(40, 3)), axis=0)
        assert name_open(x, 15) == identify_open(x, 15).name
