"""CSV: read to the last bit or refused with the line."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsade.centerline import Centerline
from torsade.errors import TorsadeError
from torsade.files import read_csv, write_csv
from torsade.files.regular import LARGEST_FILE

LINE = Centerline((np.outer(np.arange(4), [1.0, 0.0, 0.0]),))


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
    with pytest.raises(TorsadeError, match=r"pipe' is a pipe or a device"):
        read_csv(tmp_path / "pipe")


def test_huge_files_are_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.csv"
    with path.open("wb") as file:
        file.truncate(LARGEST_FILE + 2**20)  # sparse: it takes no disk
    with pytest.raises(TorsadeError, match="has 65 MB, more than the 64 MB"):
        read_csv(path)


def test_unwritable_path_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TorsadeError, match=r"cannot write .*nowhere.* \(no such file or directory\)"):
        write_csv(LINE, tmp_path / "nowhere" / "nodes.csv")


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
