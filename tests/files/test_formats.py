"""Every format: what is written is read back to the last bit, and what other programs write is read."""

from __future__ import annotations

import io
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import torsade as ts
from torsade.centerline import Centerline
from torsade.errors import TorsadeError
from torsade.files import SUFFIXES, read_centerline, write_centerline

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]])


def same(a: Centerline, b: Centerline) -> bool:
    """Equal to the last bit, signs of zero among them."""
    equal = [
        x.shape == y.shape and x.tobytes() == y.tobytes() for x, y in zip(a.strands, b.strands, strict=True)
    ]
    return all(equal) and a.closed == b.closed


coordinate = st.floats(allow_nan=False, allow_infinity=False)
node = st.tuples(coordinate, coordinate, coordinate)
strand = st.tuples(st.lists(node, min_size=3, max_size=6, unique=True), st.booleans())


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(deadline=None, max_examples=60)
@given(strands=st.lists(strand, min_size=1, max_size=4))
def test_written_and_read_back_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, strands: list[tuple[list[tuple[float, ...]], bool]]
) -> None:
    """Any finite doubles: subnormal, huge, and zeros of both signs."""
    if suffix == ".npy":
        n = min(len(x) for x, _ in strands)
        strands = [(x[:n], strands[0][1]) for x, _ in strands]
    c = Centerline(tuple(np.array(x) for x, _ in strands), tuple(k for _, k in strands))
    path = tmp_path_factory.mktemp("files") / f"nodes{suffix.upper()}"
    write_centerline(c, path)
    assert same(read_centerline(path), c)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_units_and_one_strand(tmp_path: Path, suffix: str) -> None:
    write_centerline(Centerline((SQUARE,)), tmp_path / f"a{suffix}")
    (x,) = read_centerline(tmp_path / f"a{suffix}", "mm").strands
    np.testing.assert_array_equal(x, 1e-3 * SQUARE)
    with pytest.raises(TorsadeError, match="unknown unit 'furlong'"):
        read_centerline(tmp_path / f"a{suffix}", "furlong")


def test_lengths_beyond_bounds_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_text("0 0 0\n1e307 0 0\n")
    with pytest.raises(TorsadeError, match="beyond all bounds in km"):
        read_centerline(tmp_path / "a.xyz", "km")


# --- what other programs write

READ = {
    "bare rows": ("a.xyz", "# knot\n0 0 0\n1\t0 0\n\n\n 0 1 0 \n1 1 0\n2 1 0\n", [2, 3], (False, False)),
    "a frame with element symbols": ("a.xyz", "3\nknot\nC 0 0 0\nH 1 0 0\nC 1 1 0\n", [3], (False,)),
    "frames with properties": (
        "a.xyz",
        "2\n\n6 0 0 0 .1 .2\n6 1 0 0 0 0\n\n2\nt=1\n0 0 1\n1 0 1\n",
        [2, 2],
        None,
    ),
    "a closed frame": ("a.xyz", "4\n\nC 0 0 0\nC 1 0 0\nC 1 1 0\nC 0 0 0\n", [3], (True,)),
    "edges one by one, as Blender has them": (
        "a.obj",
        "# Blender\nmtllib a.mtl\no ring\nv 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\nl 3 1\n",
        [3],
        (True,),
    ),
    "texture and negative indices": (
        "a.obj",
        "v 0 0 0 1.0\nv 1 0 0\nvt 0 0\nl 1/1 2/1\nv 0 0 1\nv 0 1 1\nv 0 2 1\nl -3 -2 -1\nf 1 2 3\n",
        [2, 3],
        (False, False),
    ),
    "a closed polyline, comments and colours in lines": (
        "a.vect",
        "VECT\n2 5 2  # two\n2 -3\n1 1\n0 0 0  1 0 0\n# second\n0 0 1 0 1 1\n0 1 2\n1 0 0 1\n0 1 0 1\n",
        [2, 3],
        (False, True),
    ),
    "a closed polyline and colours": (
        "a.vect",
        "VECT 2 5 1 -3 2 1 0 0 0 0 1 0 0 1 1 0 0 0 1 0 1 1 1 0 0 1",
        [3, 2],
        (True, False),
    ),
}


@pytest.mark.parametrize("name", READ)
def test_variations_are_read(tmp_path: Path, name: str) -> None:
    file, text, nodes, closed = READ[name]
    (tmp_path / file).write_text(text)
    c = read_centerline(tmp_path / file)
    assert [len(x) for x in c.strands] == nodes
    assert c.closed == (closed or (False,) * len(nodes))
    assert c.strands[0][1].tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("kind", ["<f8", ">f8", "<f4", "<i4", "<u1"])
def test_arrays_of_other_kinds(tmp_path: Path, kind: str, order: str) -> None:
    x = np.asarray(np.array([[0, 0, 0], [1, 2, 3], [4, 5, 6]]), dtype=kind, order=order)  # type: ignore[call-overload]
    np.save(tmp_path / "a.npy", x)
    np.savez_compressed(tmp_path / "a.npz", x=x, other=np.array(["label"]))
    for file in ("a.npy", "a.npz"):
        (y,) = read_centerline(tmp_path / file).strands
        np.testing.assert_array_equal(x, y)


def test_an_array_of_several_strands(tmp_path: Path) -> None:
    x = np.stack([SQUARE, SQUARE + 1])
    np.savez(tmp_path / "a.npz", x=x, closed=np.array(True))
    c = read_centerline(tmp_path / "a.npz")
    assert same(c, Centerline((x[0], x[1]), (True, True)))


def test_an_open_strand_that_ends_where_it_began(tmp_path: Path) -> None:
    """NPZ alone can say so."""
    c = Centerline((np.concatenate([SQUARE, SQUARE[:1]]), SQUARE), (False, True))
    write_centerline(c, tmp_path / "a.npz")
    assert same(read_centerline(tmp_path / "a.npz"), c)
    write_centerline(c, tmp_path / "a.csv")
    assert read_centerline(tmp_path / "a.csv").closed == (True, True)


def test_long_obj_strands_are_written_in_records(tmp_path: Path) -> None:
    x = np.random.default_rng(0).normal(size=(2500, 3))
    write_centerline(Centerline((x, SQUARE), (True, False)), tmp_path / "a.obj")
    assert max(map(len, (tmp_path / "a.obj").read_text().splitlines())) < 8000
    assert same(read_centerline(tmp_path / "a.obj"), Centerline((x, SQUARE), (True, False)))


# --- writing


def test_npy_holds_strands_of_one_length_only(tmp_path: Path) -> None:
    with pytest.raises(TorsadeError, match=r"give a name that ends in \.npz"):
        write_centerline(Centerline((SQUARE, SQUARE[:2])), tmp_path / "a.npy")
    assert list(tmp_path.iterdir()) == []


def test_vtk_is_read_by_pyvista(tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    c = Centerline((SQUARE, SQUARE[:2] / 3), (True, False))
    write_centerline(c, tmp_path / "a.vtk")
    mesh = pyvista.read(tmp_path / "a.vtk")
    np.testing.assert_array_equal(mesh.points, np.concatenate(c.strands))
    np.testing.assert_array_equal(mesh.lines, [5, 0, 1, 2, 3, 0, 2, 4, 5])
    with pytest.raises(TorsadeError, match=r"written, not read; give one of \.csv"):
        read_centerline(tmp_path / "a.vtk")


@pytest.mark.parametrize("name", ["knot.stl", "knot", "knot.csv.gz", ".csv"])
def test_unknown_suffixes_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(TorsadeError, match=r"format of curves; give one of \.csv, .*\.vtk"):
        write_centerline(Centerline((SQUARE,)), tmp_path / name)
    (tmp_path / name).write_text("0 0 0\n1 1 1\n")
    with pytest.raises(TorsadeError, match=r"give one of \.csv, \.xyz, \.obj, \.vect, \.npz, \.npy$"):
        read_centerline(tmp_path / name)


def test_an_earlier_file_stays_when_writing_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    path.write_text("mine")

    def full(self: Path, content: bytes) -> int:
        self.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(TorsadeError, match="no space left on device"):
        write_centerline(Centerline((SQUARE,)), path)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a.csv", "mine")]


def test_what_is_no_file_is_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "folder.csv").mkdir()
    for name in ("pipe.csv", "folder.csv"):
        with pytest.raises(TorsadeError, match="is not a file; give the name of a file"):
            write_centerline(Centerline((SQUARE,)), tmp_path / name)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["folder.csv", "pipe.csv"]


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "link.csv").symlink_to(tmp_path / "real.csv")
    write_centerline(Centerline((SQUARE,)), tmp_path / "link.csv")
    assert (tmp_path / "link.csv").is_symlink()
    assert same(read_centerline(tmp_path / "real.csv"), Centerline((SQUARE,)))


def test_the_same_centerline_makes_the_same_file(tmp_path: Path) -> None:
    for suffix in SUFFIXES:
        for name in ("a", "b"):
            write_centerline(Centerline((SQUARE,)), tmp_path / f"{name}{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_a_knot_is_the_same_in_every_format(tmp_path: Path) -> None:
    knot = ts.knots.bend("reef")
    for suffix in SUFFIXES:
        ts.write_centerline(knot, tmp_path / f"reef{suffix}")
        back = ts.read_centerline(tmp_path / f"reef{suffix}")
        for a, b in zip(knot.strands, back.strands, strict=True):
            np.testing.assert_array_equal(a, b)


def test_npz_is_opened_by_numpy(tmp_path: Path) -> None:
    write_centerline(Centerline((SQUARE, SQUARE[:2]), (True, False)), tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as arrays:
        np.testing.assert_array_equal(arrays["strand0"], SQUARE)
        assert arrays["closed"].tolist() == [True, False]
    assert zipfile.ZipFile(io.BytesIO((tmp_path / "a.npz").read_bytes())).testzip() is None
