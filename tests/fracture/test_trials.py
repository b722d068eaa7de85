"""Trials in files: what is read, and the sentence that each kind of mistake gets."""

import contextlib
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsade.errors import TorsadeError
from torsade.fracture.analysis import analyse
from torsade.fracture.rod import spaghetti
from torsade.fracture.theory.elastica import elastica
from torsade.fracture.trials import Trials, read_trials

ROD = spaghetti()
Factory = pytest.TempPathFactory


def trials(folder: Path, text: str) -> Trials:
    path = folder / "trials.csv"
    path.write_text(text)
    return read_trials(path, ROD)


def refusal(folder: Path, text: str) -> str:
    with pytest.raises(TorsadeError) as caught:
        trials(folder, text)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 300
    return message


class TestRead:
    def test_units_of_headings(self, tmp_path: Path) -> None:
        """The same trial in other units, brackets, order and separators."""
        (one,) = trials(
            tmp_path, "twist_deg,end_distance_mm,lengths_mm,speed_mm_per_s\n180,200,90 30 120,3\n"
        ).trials
        (two,) = trials(
            tmp_path,
            "Speed (m/s);lengths [cm];twist_rad;End distance (m)\n0.003;9+3+12;3.141592653589793;0.2\n",
        ).trials
        assert one.twist == pytest.approx(math.pi)
        assert one.lengths == pytest.approx((0.09, 0.03, 0.12))
        assert (one.twist, one.speed, one.end_distance) == pytest.approx(
            (two.twist, two.speed, two.end_distance)
        )
        assert one.lengths == pytest.approx(two.lengths)

    def test_headings_in_capitals(self, tmp_path: Path) -> None:
        """As some spreadsheets write them, after a byte order mark: units in small letters are meant."""
        small = "lengths_mm;twist_deg;speed_mm_per_s;end_distance (mm)"
        rows = "\n90 30 120;180;3;200\n"
        capitals = trials(tmp_path, "\ufeff" + small.upper() + rows)
        assert capitals.trials == trials(tmp_path, small + rows).trials
        assert capitals.columns == ("lengths", "twist", "speed", "end_distance")

    def test_a_column_for_each_piece(self, tmp_path: Path) -> None:
        (one,) = trials(tmp_path, "length_1_mm,length_2_mm,length_3_mm\n90,150,\n").trials
        assert one.lengths == pytest.approx((0.09, 0.15))
        assert one.pieces == 2

    def test_flakes_do_not_count(self, tmp_path: Path) -> None:
        """3.11: only pieces longer than the radius, 0.7 mm."""
        (one,) = trials(tmp_path, "lengths_mm\n120 0.6 119\n").trials
        assert (one.pieces, one.flakes) == (2, 1)

    def test_pieces_without_lengths(self, tmp_path: Path) -> None:
        (one,) = trials(tmp_path, "pieces,twist_deg\n3,\n").trials
        assert (one.pieces, one.smallest, one.twist) == (3, None, 0.0)

    def test_comments_blank_lines_and_columns_of_others(self, tmp_path: Path) -> None:
        found = trials(tmp_path, "# mine\npieces,humidity,twist_deg\n\n2,30 %,10\n,,\n")
        assert len(found.trials) == 1
        assert found.ignored == ("humidity",)


MISTAKES = {
    "": "has nothing in it; give the headings",
    "lengths_mm,twist_deg\n": "has no lines below its headings",
    "twist_deg,end_distance_mm\n1,2\n": "has no column lengths_mm and no column pieces; add one of them",
    "lengths,twist_deg\n120 120,3\n": "line 1 has the heading 'lengths' without a unit; write lengths_mm",
    "lengths_mm,twist\n120 120,3\n": "line 1 has the heading 'twist' without a unit; write twist_deg",
    "lengths_deg\n120 120\n": "'lengths_deg', where 'deg' is no unit of length; write lengths_mm",
    "lengths_mm,twist_deg,twist_rad\n1 2,1,1\n": "has twist more than once, as twist_deg and twist_rad",
    "length_1_mm,length_2_cm\n1,2\n": "has lengths more than once, as length_1_mm and length_2_cm",
    "lengths_mm\n120 -3\n": "line 2 has a piece of -3 mm; give lengths above 0",
    "lengths_mm\n120 300\n": "a piece of 300 mm, longer than the rod of 240 mm; check the unit",
    "lengths_mm\n120 120 120\n": "pieces of 360 mm together, longer than the rod of 240 mm",
    "lengths_mm\n120 nan\n": "line 2 has lengths_mm = 'nan'; give a finite number",
    "lengths_mm\n120 inf\n": "line 2 has lengths_mm = 'inf'; give a finite number",
    "lengths_mm\n120 many\n": "line 2 has lengths_mm = 'many'; give a number",
    "lengths_mm,twist_deg\n120 120,270deg\n": "twist_deg = '270deg'; give the number alone",
    "lengths_mm\n240\n": "has the length of one piece and not how many there were",
    "lengths_mm,twist_deg\n,3\n": "has neither lengths nor pieces",
    "pieces\n2.5\n": "has pieces = 2.5; give a whole number from 2",
    "pieces\n1\n": "has pieces = 1; give a whole number from 2",
    "pieces,lengths_mm\n2,80 80 80\n": "has 3 lengths above the radius and pieces = 2",
    "pieces,lengths_mm\n3,80 160\n": "has pieces = 3 and 2 lengths that fill the rod of 240 mm already",
    "pieces,speed_mm_per_s\n2,-3\n": "has speed = -0.003 in SI units; give a number above 0",
    "pieces,end_distance_mm\n2,250\n": "has end_distance = 250 mm, more than the rod's 240 mm",
    "pieces,end_distance_mm\n2,-1\n": "has end_distance = -0.001 in SI units; give 0 or more",
    "pieces,twist_deg\n2\n": "line 2 has 1 column where the headings have 2; leave cells empty",
    "pieces;twist_deg\n2;3,5\n": "line 2 has twist_deg = '3,5'; write decimals with a point, such as 3.5",
    "pieces,twist_deg\n2,1e9\n": "has twist = 1e+09 deg, and no rod of this length and radius bears",
    "pieces,twist_rad\n2,-250\n": "has twist = -1.432e+04 deg, and no rod",
    "pieces,limit_curvature_per_m\n2,1400\n": "has limit_curvature = 1400 1/m, and no rod",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_mistakes_get_a_sentence(text: str, tmp_path: Path) -> None:
    assert MISTAKES[text] in refusal(tmp_path, text)


def test_no_file_and_no_text(tmp_path: Path) -> None:
    with pytest.raises(TorsadeError, match=r"there is no file .*; give the path of a file of trials"):
        read_trials(tmp_path / "none.csv", ROD)
    with pytest.raises(TorsadeError, match=r"is a directory; give a file of trials, such as trials\.csv"):
        read_trials(tmp_path, ROD)
    (tmp_path / "a.csv").write_bytes(b"\x80\x81\x00")
    with pytest.raises(TorsadeError, match="is not a text file"):
        read_trials(tmp_path / "a.csv", ROD)


CELLS = st.text("0123456789.,;\t\"'+-eE naif|/#%°()[]_twislenghpcdmr", max_size=12)


@settings(max_examples=300, deadline=None)
@given(lines=st.lists(st.lists(CELLS, min_size=1, max_size=4), max_size=5))
def test_whatever_a_file_holds_it_is_read_or_refused(
    lines: list[list[str]], tmp_path_factory: Factory
) -> None:
    text = "\n".join(["lengths_mm,twist_deg,pieces", *(",".join(line) for line in lines)])
    with contextlib.suppress(TorsadeError):
        read = trials(tmp_path_factory.mktemp("a"), text)
        assert all(t.pieces >= 2 and sum(t.lengths) <= 1.05 * ROD.L + 1e-9 for t in read.trials)


class TestAnalysis:
    TEXT = """twist_deg,end_distance_mm,lengths_mm,speed_mm_per_s
0,176,90 30 120,3
0,176,119 121,3
0,180,95 25 50 70,30
0,180,95 15 60 70,300
350,236,120 120,3
"""

    def test_by_speed_without_twisted_rods(self, tmp_path: Path) -> None:
        found = analyse(trials(tmp_path, self.TEXT).trials, ROD, 1.9e7)
        assert [s.speed for s in found.speeds] == pytest.approx([0.003, 0.03, 0.3])
        assert [s.pieces.n for s in found.speeds] == [2, 1, 1]
        fragment = found.speeds[0].fragment
        assert fragment is not None
        assert fragment.value == pytest.approx((0.03 + 0.06) / 2)
        assert found.fits.fragment is not None
        assert found.fits.fragment.parameters["exponent"].value < 0

    def test_curvature_is_the_elastica_s(self, tmp_path: Path) -> None:
        found = analyse(trials(tmp_path, self.TEXT).trials, ROD, 1.9e7)
        assert found.each[0].kappa == pytest.approx(elastica(0.24, 0.176).kappa_max)
        assert not any(b.planar for b in found.each)

    def test_curvature_of_twisted_rods_is_that_of_the_twist_device(self, tmp_path: Path) -> None:
        """Solutions of the boundary-value problem at 175.95 mm, twisted by 0, 180 and 270 degrees."""
        text = "pieces,twist_deg,end_distance_mm\n" + "".join(f"2,{d},175.95\n" for d in (0, 180, -270))
        found = analyse(trials(tmp_path, text).trials, ROD, 1.9e7)
        known = (14.28572, 14.70785, 15.38352)
        assert [b.kappa for b in found.each] == pytest.approx(known, rel=1e-3)

    def test_error_of_the_distance_becomes_a_range(self, tmp_path: Path) -> None:
        """1 mm is about 0.12 1/m at 176 mm, twisted or not."""
        text = "pieces,twist_deg,end_distance_mm,end_distance_error_mm\n2,0,176,1\n2,200,176,1\n"
        for b in analyse(trials(tmp_path, text).trials, ROD, 1.9e7).each:
            assert b.kappa is not None
            assert b.kappa_low is not None
            assert b.kappa_high is not None
            assert b.kappa_high - b.kappa == pytest.approx(0.12, abs=0.02)
            assert b.kappa - b.kappa_low == pytest.approx(0.12, abs=0.02)

    def test_straight_twisted_rods_have_no_curvature(self, tmp_path: Path) -> None:
        found = analyse(trials(tmp_path, "pieces,twist_deg,end_distance_mm\n2,350,240\n").trials, ROD, 1.9e7)
        assert found.each[0].kappa == 0
        assert found.each[0].li == math.inf

    def test_rods_on_both_sides_of_the_threshold(self, tmp_path: Path) -> None:
        found = analyse(trials(tmp_path, self.TEXT).trials, ROD, 1.9e7)
        assert found.beyond is not None
        assert found.before is not None
        assert (found.beyond.k, found.beyond.n) == (1, 1)
        assert (found.before.k, found.before.n) == (1, 4)

    def test_too_few_speeds_are_no_error(self, tmp_path: Path) -> None:
        found = analyse(trials(tmp_path, "pieces,speed_mm_per_s\n2,1\n3,2\n").trials, ROD, 1.9e7)
        assert found.fits.breaks is None
        assert "give at least 3" in found.fits.reasons["breaks"]

    def test_given_curvature_comes_first(self, tmp_path: Path) -> None:
        text = "pieces,end_distance_mm,limit_curvature_per_m\n3,176,12.5\n"
        assert analyse(trials(tmp_path, text).trials, ROD, 1.9e7).each[0].kappa == 12.5
