"""Designs: which points there are, in the floats that they are when written out, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

import torsade as ts
from torsade.errors import TorsadeError
from torsade.sweep import Sweep
from torsade.sweep.axes import DESIGNS
from torsade.units import exact, quantity

TEN = {"from": "0 deg", "to": "350 deg", "count": 36}


def specs(**tables):
    return [point.spec for point in Sweep("snap-twist", **tables).points()]


def test_a_grid_is_every_combination_the_first_field_slowest():
    found = specs(grid={"twist": ["0 deg", "90 deg"], "seed": {"from": 3, "to": 5}})
    assert [(s.twist, s.seed) for s in found] == [(t, k) for t in (0.0, math.pi / 2) for k in (3, 4, 5)]


def test_values_of_a_range_are_those_written_out():
    """What a list holds and what a range holds are the same points, to the last bit."""
    written = [f"{10 * k} deg" for k in range(36)]
    by_step = {"from": "0 deg", "to": "350 deg", "step": "10 deg"}
    keys = [
        [p.key for p in Sweep("snap-twist", grid={"twist": given}).points()]
        for given in (TEN, by_step, written)
    ]
    assert keys[0] == keys[1] == keys[2]
    tenths = specs(grid={"disorder": {"from": 0.1, "to": 0.5, "count": 5}})
    assert [s.disorder for s in tenths] == [0.1, 0.2, 0.3, 0.4, 0.5]


@pytest.mark.parametrize("value", ["0.3 mm", "1e-7", 0.1, 3, "5 µm"])
def test_the_exact_value_rounds_to_the_quantity(value):
    assert float(exact(value, "length")) == quantity(value, "length")


def test_the_ends_of_a_logarithmic_range_are_exact_and_its_ratios_even():
    found = [
        s.sigma_c
        for s in specs(grid={"sigma_c": {"from": "10 MPa", "to": "20 MPa", "count": 6, "scale": "log"}})
    ]
    assert (found[0], found[-1]) == (1e7, 2e7)
    assert np.diff(np.log(found)) == pytest.approx(math.log(2) / 5)


def test_fields_of_a_zip_and_of_points_go_together():
    zipped = specs(zip={"twist": ["0 deg", "90 deg"], "disorder": [0.1, 0.2]})
    listed = specs(points=[{"twist": "0 deg", "disorder": 0.1}, {"twist": "90 deg", "disorder": 0.2}])
    assert zipped == listed
    assert len(zipped) == 2
    assert (
        len(Sweep("snap-twist", zip={"twist": ["1 deg", "2 deg"]}, grid={"seed": {"from": 1, "to": 3}})) == 6
    )


@pytest.mark.parametrize("design", DESIGNS)
def test_random_points_fill_their_range_and_come_again(design):
    fields = {"sigma_c": {"from": "15 MPa", "to": "25 MPa", "scale": "log"}, "seed": {"from": 0, "to": 9}}
    random = {"count": 64, "seed": 7, "design": design, "fields": fields | {"pieces": ["moving", "frozen"]}}
    found = specs(random=random)
    assert found == specs(random=random)
    assert found != specs(random=random | {"seed": 8})
    stress = np.array([s.sigma_c for s in found])
    assert np.all((stress >= 15e6) & (stress < 25e6))
    # The median of a logarithmic range is the geometric mean of its ends; 64 draws are this near.
    assert np.exp(np.log(stress).mean()) == pytest.approx(math.sqrt(15e6 * 25e6), rel=0.06)
    assert {s.seed for s in found} == set(range(10))
    assert {s.pieces for s in found} == {"moving", "frozen"}


@pytest.mark.parametrize("design", ["uniform", "sobol"])
def test_more_random_points_begin_with_the_same(design):
    fields = {"disorder": {"from": 0, "to": 0.2}, "twist": {"from": "0 deg", "to": "250 deg"}}
    few, many = (
        specs(random={"count": count, "seed": 3, "design": design, "fields": fields}) for count in (10, 37)
    )
    assert many[:10] == few


def test_another_field_leaves_uniform_draws_as_they_are():
    one = {"disorder": {"from": 0, "to": 0.2}}
    both = one | {"seed": {"from": 0, "to": 5}}
    few, more = (specs(random={"count": 9, "fields": fields}) for fields in (one, both))
    assert [s.disorder for s in few] == [s.disorder for s in more]


def test_strata_of_a_latin_hypercube_hold_one_point_each():
    fields = {"disorder": {"from": 0, "to": 0.5}}
    found = specs(random={"count": 20, "design": "latin", "fields": fields})
    assert sorted(int(s.disorder / 0.025) for s in found) == list(range(20))


def test_the_key_holds_all_that_decides_a_result(tmp_path):
    def key(**fixed):
        return Sweep("tighten", fixed=fixed).points()[0].key

    assert key(knot="overhand", radius="0.2 mm") == key(knot="overhand", radius=2e-4)
    assert len({key(knot="overhand"), key(knot="overhand", force="1 mN"), key(knot="figure-eight")}) == 3
    (x,) = ts.knots.strand("overhand", "0.2 mm").strands
    path = tmp_path / "mine.csv"
    ts.write_centerline(ts.Centerline((x,)), path)
    before = key(centerline=str(path))
    moved = tmp_path / "moved.csv"
    path.rename(moved)
    assert key(centerline=str(moved)) == before
    moved.write_text(moved.read_text() + "\n")
    assert key(centerline=str(moved)) != before


def test_a_file_of_nodes_is_looked_for_beside_the_design(tmp_path):
    (x,) = ts.knots.strand("overhand", "0.2 mm").strands
    ts.write_centerline(ts.Centerline((x,)), tmp_path / "mine.csv")
    (tmp_path / "a.toml").write_text('protocol = "tighten"\n[fixed]\ncenterline = "mine.csv"\n')
    (point,) = Sweep.read(tmp_path / "a.toml").points()
    assert point.spec.centerline == str(tmp_path / "mine.csv")


REFUSED = {
    '{"twist": 3}': ({"grid": {"twist": 3}}, r"twist in \[grid\] is 3; give a list or a range"),
    "unit": ({"grid": {"twist": ["3 mm"]}}, r"twist in \[grid\]: '3 mm' is a length, not an angle"),
    "range unit": (
        {"grid": {"twist": {"from": 0, "to": "3 mm", "count": 3}}},
        r"twist in \[grid\]: '3 mm' is a length",
    ),
    "empty": ({"grid": {"twist": []}}, "is an empty list; give at least one value"),
    "unknown": ({"grid": {"twits": [1]}}, "snap-twist has no field 'twits'; did you mean 'twist'?"),
    "unknown fixed": ({"fixed": {"nodes": 3}}, "give 'edges', one less"),
    "no count": ({"grid": {"twist": {"from": 0, "to": 1}}}, r"count of twist in \[grid\] is missing"),
    "no end": ({"grid": {"twist": {"from": 0, "count": 3}}}, "has no 'to'; give both ends"),
    "key": ({"grid": {"twist": {"from": 0, "to": 1, "number": 3}}}, "has 'number', which no range has"),
    "both": ({"grid": {"twist": {"from": 0, "to": 1, "count": 3, "step": 1}}}, "count and step; give one"),
    "step": ({"grid": {"twist": {"from": 0, "to": 1, "step": 0}}}, "step of twist .* is 0; give more than 0"),
    "log": (
        {"grid": {"disorder": {"from": 0, "to": 0.1, "count": 3, "scale": "log"}}},
        "goes to 0 or below, where there is no logarithm",
    ),
    "halves": ({"grid": {"seed": {"from": 0, "to": 3, "count": 3}}}, "has 1.5 in it and takes whole numbers"),
    "whole": ({"grid": {"seed": {"from": 0, "to": 2.5}}}, r"seed in \[grid\] has 2.5; give a whole number"),
    "names": ({"grid": {"pieces": {"from": 0, "to": 1}}}, "takes names, which have no range; give a list"),
    "zip": (
        {"zip": {"twist": [1, 2], "seed": [1, 2, 3]}},
        "unequal numbers of values: twist has 2, seed has 3; give as many",
    ),
    "twice": ({"fixed": {"seed": 1}, "grid": {"seed": [1, 2]}}, "seed is given in two places"),
    "same": ({"grid": {"twist": ["0 deg", 0]}}, "points 0 and 1 are the same, twist = 0 deg"),
    "bound": ({"grid": {"disorder": [0.1, 0.9]}}, r"disorder is 0.9; give a number of at most 0.5 \(at "),
    "together": (
        {"grid": {"length": ["24 cm", "2 cm"]}},
        r"min_fragment is 30 mm, more than the whole rod of 20 mm; give a shorter one \(at length = 0.02 m\)",
    ),
    "list in fixed": ({"fixed": {"seed": [1, 2]}}, r"seed in \[fixed\] is \[1, 2\]; give one value"),
    "random": ({"random": {"count": 3, "twist": [1]}}, r"\[random\] has 'twist'; .* \[random.fields\]"),
    "random count": ({"random": {"fields": {"twist": [1]}}}, r"count of \[random\] is missing"),
    "no random": ({"random": {"count": 3}}, "has no fields; put those that vary under"),
    "design": (
        {"random": {"count": 3, "design": "halton", "fields": {"twist": [1]}}},
        "design of .* is 'halton'; give one of uniform, sobol, latin",
    ),
    "points": ({"points": [{"twist": 1}, {"seed": 1}]}, r"entry 2 of \[\[points\]\] has the fields seed"),
    "table": ({"grid": 3}, r"grid is 3; give a table, \[grid\]"),
    "keep": ({"keep": "all"}, "keep is 'all'; give one of numbers or results"),
    "protocol": ({"fixed": {"protocol": "tighten"}}, "protocol stands at the top of the file"),
}  # fmt: skip


@pytest.mark.parametrize(("tables", "sentence"), REFUSED.values(), ids=REFUSED.keys())
def test_what_makes_no_sense_is_refused_in_one_sentence(tables, sentence):
    with pytest.raises(TorsadeError, match=sentence) as error:
        Sweep("snap-twist", **tables).points()
    assert ". " not in str(error.value)


def test_a_large_sweep_has_to_be_meant():
    sweep = Sweep("snap-twist", grid={"seed": {"from": 0, "to": 10**6 - 1}, "twist": TEN})
    assert len(sweep) == 36 * 10**6
    with pytest.raises(TorsadeError, match=r"has 36000000 points, more than 100000; .*--at-most 36000000"):
        sweep.points()


FILES = {
    "not TOML": ("grid = [", "is not TOML"),
    "no protocol": ("[grid]\nseed = [1]\n", "names no protocol"),
    "unknown protocol": ('protocol = "snap-twits"\n', "did you mean 'snap-twist'?"),
    "field at the top": ('protocol = "snap-twist"\nseed = 3\n', r"'seed' at its top; a field belongs under"),
    "unknown table": ('protocol = "snap-twist"\n[gird]\nseed = [1]\n', "did you mean 'grid'?"),
}


@pytest.mark.parametrize(("text", "sentence"), FILES.values(), ids=FILES.keys())
def test_a_file_that_is_no_design_is_refused(tmp_path, text, sentence):
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(TorsadeError, match=sentence):
        Sweep.read(tmp_path / "a.toml")


def test_designs_may_be_long(tmp_path):
    """A list of ten thousand values is 80 KB."""
    twists = [round(0.0001 * k, 4) for k in range(10_000)]
    (tmp_path / "a.toml").write_text(f'protocol = "snap-twist"\n[grid]\ntwist = {twists}\n')
    sweep = Sweep.read(tmp_path / "a.toml")
    assert [row[0] for row in sweep.axes[0].rows] == twists
