"""Centerlines: files read to the last bit or refused with the line, and the check before a run."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from torsade import centerline, curve
from torsade.centerline import Centerline, check, read_csv, write_csv
from torsade.errors import TorsadeError

FloatArray = NDArray[np.float64]

H = 2e-4
"""Radius of the reference fibers [m]."""

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[2] / "shared"))
BENDS = SHARED / "data" / "bends"
needs_bends = pytest.mark.skipif(not BENDS.is_dir(), reason="the reference bends are not here")


def line(n: int = 40, spacing: float = H, start: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> FloatArray:
    return np.array(start) + np.outer(np.arange(n) * spacing, [1.0, 0.0, 0.0])


def ring(n: int = 40, radius: float = 20 * H) -> FloatArray:
    a = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def refusal(x: Any, *more: Any, closed: tuple[bool, ...] = (), radius: float = H) -> str:
    with pytest.raises(TorsadeError) as caught:
        check(Centerline((x, *more), closed), radius)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 320
    return message


# --- the value


def test_nodes_are_copied_and_read_only() -> None:
    x = line()
    c = Centerline((x,))
    x[0] = 1.0
    assert c.strands[0][0, 0] == 0.0
    assert c.closed == (False,)
    with pytest.raises(ValueError, match="read-only"):
        c.strands[0][0] = 1.0


@pytest.mark.parametrize(
    ("strands", "closed", "says"),
    [
        ((), (), "no strand"),
        ((np.zeros((4, 2)),), (), r"strand 0 has nodes of shape \(4, 2\)"),
        ((line(), np.zeros(3)), (), r"strand 1 has nodes of shape \(3,\)"),
        ((line(),), (True, False), "1 strands have 2 closed flags"),
    ],
)
def test_malformed_values_are_refused(strands: Any, closed: tuple[bool, ...], says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        Centerline(strands, closed)


# --- files


@settings(deadline=None)
@given(
    st.integers(0, 10**6),
    st.lists(st.tuples(st.integers(3, 8), st.booleans()), min_size=1, max_size=4),
    st.sampled_from([1.0, 1e-3, 1e-9, 1e9]),
)
def test_written_and_read_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, seed: int, shapes: list[tuple[int, bool]], size: float
) -> None:
    rng = np.random.default_rng(seed)
    c = Centerline(tuple(size * rng.normal(size=(n, 3)) for n, _ in shapes), tuple(k for _, k in shapes))
    path = tmp_path_factory.mktemp("csv") / "nodes.csv"
    write_csv(c, path)
    back = read_csv(path)
    assert back.closed == c.closed
    for a, b in zip(c.strands, back.strands, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    "text",
    [
        "strand,x,y,z\n0,0,0,0\n0,1e-3,2,-3\n",
        "# comment\n\n  # another\nstrand,x,y,z\n0,0,0,0\n# between\n0,1e-3,2,-3",
        "\ufeffstrand,x,y,z\r\n0,0,0,0\r\n0,1e-3,2,-3\r\n\r\n",
        ' Strand , X , Y , Z \n 0 , 0 , 0 , 0 \n 0 , .001 , +2 , "-3" \n',
        "strand,x,y,z\r0,0,0,0\r0,1E-03,2.,-3",
    ],
)
def test_harmless_variations_are_read(tmp_path: Path, text: str) -> None:
    path = tmp_path / "nodes.csv"
    path.write_bytes(text.encode())
    (x,) = read_csv(path).strands
    np.testing.assert_array_equal(x, [[0, 0, 0], [1e-3, 2, -3]])


def test_a_strand_that_returns_to_its_first_node_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "nodes.csv"
    path.write_text("strand,x,y,z\n0,0,0,0\n0,1,0,0\n0,0,1,0\n0,0,0,0\n1,0,0,5\n1,1,0,5\n1,0,0,5\n")
    c = read_csv(path)
    assert c.closed == (True, False)  # two edges there and back are no loop
    assert [len(x) for x in c.strands] == [3, 3]


ROWS = "strand,x,y,z\n0,0,0,0\n0,1,0,0\n"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "has no header 'strand,x,y,z'"),
        ("# only a comment\n", "has no header 'strand,x,y,z'"),
        ("strand,x,y,z\n", "has no nodes; give a line 'strand,x,y,z' and then one line per node"),
        ("0,0,0,0\n0,1,0,0\n", "line 1 is '0,0,0,0', not the header; begin with the line 'strand,x,y,z'"),
        ("# c\nx,y,z\n1,2,3\n", "line 2 is 'x,y,z', not the header"),
        ("strand,x,y,z,w\n0,1,2,3,4\n", "line 1 is 'strand,x,y,z,w', not the header"),
        ("strand|x|y|z\n0|0|0|0\n", "not the header"),
        ("q" * 500, "q...', not the header"),
        (ROWS + "0,1,2\n", "line 4 has 3 columns; give the four of 'strand,x,y,z'"),
        (ROWS + "0,1,2,3,4\n", "line 4 has 5 columns"),
        (ROWS + "0,1,2,\n", "line 4 has z = ''; give a number"),
        (ROWS + "0,1,two,3\n", "line 4 has y = 'two'; give a number"),
        (ROWS + "0,nan,2,3\n", "line 4 has x = 'nan'; give a finite number"),
        (ROWS + "0,1,2,-inf\n", "line 4 has z = '-inf'; give a finite number"),
        (ROWS + "0,1e999,2,3\n", "line 4 has x = '1e999'; give a finite number"),
        (ROWS + "0,1_0,2,3\n", "line 4 has x = '1_0'"),
        (ROWS + "0,0.1 mm,2,3\n", "line 4 has x = '0.1 mm'; give a number"),
        (ROWS + "-1,1,2,3\n", "line 4 has strand '-1'; give an integer of at least 0"),
        (ROWS + "0.5,1,2,3\n", "line 4 has strand '0.5'"),
        (ROWS + ",1,2,3\n", "line 4 has strand ''"),
        (ROWS + "9999999999,1,2,3\n", "line 4 has strand '9999999999'"),
        (ROWS + "2,1,2,3\n", "line 4 begins strand 2 where strand 1 is due"),
        ("strand,x,y,z\n1,1,2,3\n", "line 2 begins strand 1 where strand 0 is due"),
        (ROWS + "1,5,0,0\n1,6,0,0\n0,2,0,0\n", "line 6 returns to strand 0 after strand 1"),
        (ROWS + "1,5,0,0\n", "strand 1 in {path} has only one node; give at least 2"),
        (ROWS + '0,"1,2,3\n', "line 4 cannot be read as CSV"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "is not a text file"),
        (b"strand,x,y,z\n0,0,0,\xff\n", "is not a text file"),
        (ROWS.encode("utf-16"), "is not a text file"),
        (ROWS.encode() + b"\x00" * 8, "is not a text file"),
    ],
)
def test_bad_files_are_refused_with_the_line(tmp_path: Path, content: str | bytes, says: str) -> None:
    path = tmp_path / "nodes.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(TorsadeError) as caught:
        read_csv(path)
    message = str(caught.value)
    assert says.format(path=repr(str(path))) in message
    assert str(path) in message
    assert "\n" not in message


@settings(deadline=None)
@given(st.text(alphabet='strandxyz,0123456789.-e#\n" ', max_size=80))
def test_any_text_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("csv") / "nodes.csv"
    path.write_text(text)
    try:
        nodes = read_csv(path).strands
    except TorsadeError:
        return
    assert all(np.isfinite(x).all() and len(x) >= 2 for x in nodes)


def test_paths_that_are_no_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(TorsadeError, match=r"there is no file .*missing\.csv"):
        read_csv(tmp_path / "missing.csv")
    with pytest.raises(TorsadeError, match="is a directory"):
        read_csv(tmp_path)
    os.mkfifo(tmp_path / "pipe")  # reading it would wait for ever
    with pytest.raises(TorsadeError, match=r"there is no file .*pipe"):
        read_csv(tmp_path / "pipe")


def test_huge_files_are_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.csv"
    with path.open("wb") as file:
        file.truncate(centerline.LARGEST_FILE + 2**20)  # sparse: it takes no disk
    with pytest.raises(TorsadeError, match="has 65 MB, more than the 64 MB"):
        read_csv(path)


def test_unwritable_path_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TorsadeError, match=r"cannot write .*nowhere.* \(no such file or directory\)"):
        write_csv(Centerline((line(),)), tmp_path / "nowhere" / "nodes.csv")


# --- the check before a run


def test_sound_centerlines_pass() -> None:
    side_by_side = Centerline((line(), line(start=(0.0, 2 * H, 0.0))))
    coarse = Centerline((line(41, 2 * H),))  # edges as long as the diameter
    for sound in (Centerline((line(),)), Centerline((ring(100),), (True,)), side_by_side, coarse):
        assert check(sound, H) is None


@pytest.mark.parametrize("radius", [0.0, -H, np.nan, np.inf])
def test_impossible_radius_is_refused(radius: float) -> None:
    assert "radius is" in refusal(line(), radius=radius)


def test_nodes_that_are_not_finite_are_refused() -> None:
    x = line()
    x[7, 1] = np.nan
    assert "node 7 of strand 1 is (0.0014, nan, 0) m; give finite coordinates" in refusal(
        line(start=(0, 1, 0)), x
    )


def test_too_few_nodes_are_refused() -> None:
    assert "strand 0 has only one node; give at least 2" in refusal(line(1))
    assert "strand 0 has 0 nodes" in refusal(np.zeros((0, 3)))
    assert "strand 0 has 2 nodes; give at least 3" in refusal(line(2), closed=(True,))


@pytest.mark.parametrize("gap", [0.0, 1e-12 * H])
def test_repeated_nodes_are_refused(gap: float) -> None:
    x = line()
    x[8] = x[7] + gap
    assert "nodes 7 and 8 of strand 0 are the same point, (0.0014, 0, 0) m; remove one" in refusal(x)


def test_repeated_first_node_of_a_closed_fiber_is_refused() -> None:
    x = ring(100)
    message = refusal(np.concatenate([x, x[:1]]), closed=(True,))
    assert "nodes 100 and 0 of strand 0 are the same point" in message


@pytest.mark.parametrize("size", [1e3, 1e300])
def test_long_edges_are_refused(size: float) -> None:
    message = refusal(line() * size)
    assert "more than the fiber's diameter 0.4 mm" in message
    assert "resample it, or give the unit that x, y, z have" in message
    x = line()
    x[20:] += [1.5 * H, 0, 0]
    assert "edge 19 of strand 0 is 0.5 mm long" in refusal(x)


def test_short_fiber_is_refused() -> None:
    assert "strand 0 is 1.8 mm long; give at least 5 diameters, 2 mm" in refusal(line(10))
    check(Centerline((line(12),)), H)


def test_a_fold_is_refused() -> None:
    x = line()
    x[20:] = x[20] + np.outer(np.arange(20), [-H, H / 4, 0])
    message = refusal(x)
    assert "strand 0 turns by 166 degrees at node 20" in message
    assert "smooth or resample" in message


def test_crossing_strands_are_refused() -> None:
    other = line()[:, [1, 0, 2]] + [20 * H, -20 * H, 0]
    message = refusal(line(), other)
    assert "strands 0 and 1 interpenetrate: the axes are 0 mm apart" in message
    assert "a fiber 0.4 mm thick needs at least 0.1333 mm" in message


@pytest.mark.parametrize(("apart", "passes"), [(0.30, False), (0.36, True)])
def test_parallel_strands_may_overlap_only_so_far(apart: float, passes: bool) -> None:
    """The limit is a third of the diameter."""
    other = line(start=(0.0, 0.0, apart * 2 * H))
    if passes:
        check(Centerline((line(), other)), H)
    else:
        assert "interpenetrate" in refusal(line(), other)


def test_a_fiber_that_passes_through_itself_is_refused() -> None:
    """A figure of eight in the plane, and the same lifted apart."""
    a = 2 * np.pi * np.arange(200) / 200
    flat = 20 * H * np.stack([np.sin(a), np.sin(2 * a) / 2, 0 * a], axis=1)
    assert "strand 0 passes through itself: the axes are 0 mm apart" in refusal(flat, closed=(True,))
    flat[:, 2] = H * np.cos(a)
    check(Centerline((flat,), (True,)), H)


# --- the reference bends

CLEARANCES = {
    "alpine24": 0.518,
    "carrick14": 0.807,
    "granny": 0.631,
    "grief": 0.683,
    "reef": 0.651,
    "thief": 0.639,
    "trefoil": 0.929,
    "zeppelin14": 0.746,
}
"""Measured on the published centerlines [2h], with the exclusion pi h of `check`."""


@needs_bends
@pytest.mark.parametrize("name", sorted(CLEARANCES))
def test_reference_bends_are_accepted(name: str) -> None:
    """They overlap by up to half a diameter, which is what sets the limit of `check`."""
    c = read_csv(BENDS / f"{name}.csv")
    check(c, H)
    near = curve.clearance(c.strands, c.closed, np.pi * H)
    assert near.distance / (2 * H) == pytest.approx(CLEARANCES[name], abs=5e-4)


@needs_bends
def test_a_reference_bend_pushed_into_itself_is_refused() -> None:
    c = read_csv(BENDS / "reef.csv")
    moved = Centerline((c.strands[0], c.strands[1] + [0.75e-3, 0, 0]))
    with pytest.raises(TorsadeError, match="strands 0 and 1 interpenetrate"):
        check(moved, H)
    with pytest.raises(TorsadeError, match="the axes are"):
        check(c, 2.5 * H)


@pytest.mark.parametrize("separator", [",", ";", "\t", " ; "])
def test_other_separators_and_units(tmp_path: Path, separator: str) -> None:
    rows = [("strand", "x", "y", "z"), ("0", "0", "0", "0"), ("0", "1.5", "0", "0")]
    (tmp_path / "a.csv").write_text("\n".join(separator.join(row) for row in rows))
    np.testing.assert_array_equal(read_csv(tmp_path / "a.csv", "mm").strands[0][1], [1.5e-3, 0, 0])
    np.testing.assert_array_equal(read_csv(tmp_path / "a.csv").strands[0][1], [1.5, 0, 0])


def test_a_header_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("strand x y z\n0 0 0 0\n")
    with pytest.raises(TorsadeError, match=r"not the header; .* with commas, semicolons or tabs"):
        read_csv(tmp_path / "a.csv")


def test_a_built_in_bend_can_be_written(tmp_path: Path) -> None:
    from torsade.knots import bend

    built = bend("reef", radius="0.2 mm")
    write_csv(built, tmp_path / "reef.csv")
    again = read_csv(tmp_path / "reef.csv")
    for a, b in zip(built.strands, again.strands, strict=True):
        np.testing.assert_array_equal(a, b)
    assert built.pulled == "A1B1"
