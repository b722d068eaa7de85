"""Files that are broken, huge or made to do harm: refused in one sentence, quickly and in little memory."""

from __future__ import annotations

import io
import itertools
import os
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hanging import no_hang
from torsade.errors import TorsadeError
from torsade.files import SUFFIXES, read_centerline
from torsade.files import gathered as limits
from torsade.files.regular import LARGEST_FILE, LONGEST_LINE

TEXT = (".csv", ".xyz", ".obj", ".vect")
HEADS = {".csv": "strand,x,y,z\n", ".xyz": "", ".obj": "", ".vect": "VECT 1 3 0 3 0 "}


def refusal(path: Path, content: str | bytes | None = None) -> str:
    """The sentence with which a file is refused, without hanging and in less than 32 MB."""
    if content is not None:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    tracemalloc.start()
    try:
        with no_hang(), pytest.raises(TorsadeError) as caught:
            read_centerline(path)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 400
    assert str(path) in message
    assert most < 32e6
    return message


# --- any format


@pytest.mark.parametrize("suffix", SUFFIXES)
class TestEveryFormat:
    def test_nothing(self, tmp_path: Path, suffix: str) -> None:
        refusal(tmp_path / f"a{suffix}", b"")

    def test_no_file(self, tmp_path: Path, suffix: str) -> None:
        assert "there is no file" in refusal(tmp_path / f"a{suffix}")

    def test_a_folder(self, tmp_path: Path, suffix: str) -> None:
        (tmp_path / f"a{suffix}").mkdir()
        assert "is a directory" in refusal(tmp_path / f"a{suffix}")

    @pytest.mark.parametrize("device", ["/dev/zero", "/dev/null", "pipe"])
    def test_what_never_ends(self, tmp_path: Path, suffix: str, device: str) -> None:
        path = tmp_path / f"a{suffix}"
        if device == "pipe":
            os.mkfifo(path)
        else:
            path.symlink_to(device)
        assert "is a pipe or a device; give a regular file" in refusal(path)

    def test_a_hundred_megabytes(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        with path.open("wb") as file:
            file.truncate(100 * 2**20)  # sparse: it takes no disk
        assert "has 100 MB, more than the 64 MB" in refusal(path)

    def test_zeros_up_to_the_limit(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        with path.open("wb") as file:
            file.truncate(LARGEST_FILE)
        refusal(path)

    def test_noise(self, tmp_path: Path, suffix: str) -> None:
        refusal(tmp_path / f"a{suffix}", np.random.default_rng(0).bytes(100_000))

    def test_unreadable(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        path.write_text("0 0 0")
        path.chmod(0)
        if os.access(path, os.R_OK):
            pytest.skip("this user may read everything")
        assert "permission denied" in refusal(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(deadline=None, max_examples=100)
@given(content=st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, content: bytes
) -> None:
    _read_or_refuse(tmp_path_factory.mktemp("any") / f"a{suffix}", content)


@pytest.mark.parametrize("suffix", TEXT)
@settings(deadline=None, max_examples=200)
@given(
    words=st.lists(
        st.sampled_from(
            [
                "v",
                "l",
                "f",
                "VECT",
                "\n",
                "\n\n",
                "0",
                "1",
                "-1",
                "2",
                "3",
                "-3",
                "1e400",
                "#",
                "x",
                "0,1,2,3\n",
            ]
        )
    )
)
def test_any_words_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, words: list[str]
) -> None:
    _read_or_refuse(tmp_path_factory.mktemp("any") / f"a{suffix}", (HEADS[suffix] + " ".join(words)).encode())


@pytest.mark.parametrize("suffix", [".npz", ".npy"])
@settings(deadline=None, max_examples=200)
@given(data=st.data())
def test_damaged_arrays_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, data: st.DataObject
) -> None:
    """Some bytes of a sound file changed, or its end cut off."""
    content = bytearray(array_file(suffix, np.arange(12.0).reshape(4, 3)))
    for _ in range(data.draw(st.integers(1, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(content)))
    _read_or_refuse(
        tmp_path_factory.mktemp("any") / f"a{suffix}", bytes(content[:cut] if cut % 2 else content)
    )


def _read_or_refuse(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    refused = ""
    strands: tuple[Any, ...] = ()
    try:
        strands = read_centerline(path).strands
    except TorsadeError as error:
        refused = str(error)
    assert strands or str(path) in refused
    assert "\n" not in refused
    assert all(np.isfinite(x).all() and len(x) >= 2 for x in strands)


def array_file(suffix: str, x: Any, **more: Any) -> bytes:
    content = io.BytesIO()
    if suffix == ".npy":
        np.save(content, x)
    else:
        np.savez(content, strand0=x, **more)
    return content.getvalue()


# --- text


@pytest.mark.parametrize("suffix", TEXT)
@pytest.mark.parametrize("fill", ["7", "1 ", "#"])
def test_a_line_that_does_not_end(tmp_path: Path, suffix: str, fill: str) -> None:
    text = HEADS[suffix] + fill * (4 * LONGEST_LINE // len(fill))
    assert f"is longer than {LONGEST_LINE} characters" in refusal(tmp_path / f"a{suffix}", text)


@pytest.mark.parametrize("suffix", TEXT)
@pytest.mark.parametrize("encoding", ["utf-16", "utf-32", "latin-1"])
def test_other_encodings(tmp_path: Path, suffix: str, encoding: str) -> None:
    text = HEADS[suffix] + "# périphérie\n0 0 0\n1 0 0\n"
    assert "is not a text file" in refusal(tmp_path / f"a{suffix}", text.encode(encoding))


@pytest.mark.parametrize("suffix", TEXT)
def test_more_nodes_than_bearable(tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MOST_NODES", 10)
    row = {".csv": "0,1,2,3\n", ".obj": "v 1 2 3\n"}.get(suffix, "1 2 3\n")
    head = "VECT 1 20 0 20 0\n" if suffix == ".vect" else HEADS[suffix]
    assert "has more than 10 nodes" in refusal(tmp_path / f"a{suffix}", head + 20 * row)


def test_more_strands_than_bearable(tmp_path: Path) -> None:
    message = refusal(tmp_path / "a.xyz", "0 0 0\n1 0 0\n\n" * (limits.MOST_STRANDS + 1))
    assert "has more than 10000 strands" in message


ROWS = "0 0 0\n1 0 0\n"
FOUR = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


@pytest.mark.parametrize(
    ("file", "content", "says"),
    [
        ("a.xyz", "0 0 0\n", "strand 0 in {path} has only one node; give at least 2"),
        ("a.xyz", ROWS + "\n5 5 5\n", "strand 1 in {path} has only one node"),
        ("a.xyz", ROWS + "1 2\n", "line 3 has 2 columns; give x y z"),
        ("a.xyz", ROWS + "1 2 3 4\n", "line 3 has 4 columns"),
        ("a.xyz", ROWS + "nan 0 0\n", "line 3 has x = 'nan'; give a finite number"),
        ("a.xyz", ROWS + "0 -inf 0\n", "line 3 has y = '-inf'; give a finite number"),
        ("a.xyz", ROWS + "0 0 two\n", "line 3 has z = 'two'; give a number"),
        ("a.xyz", "x y z\n" + ROWS, "line 1 has x = 'x'; give a number"),
        ("a.xyz", "# only\n\n", "has no nodes"),
        ("a.xyz", "999999999\nhuge\nC 0 0 0\n", "line 1 announces 999999999 nodes; give from 2 to 1000000"),
        ("a.xyz", "9" * 5000, "has count '999"),
        ("a.xyz", "0\n\n", "line 1 announces 0 nodes"),
        ("a.xyz", "-2\n\n" + ROWS, "line 1 announces -2 nodes"),
        ("a.xyz", "1000000\n\nC 0 0 0\n", "line 1 announces 1000000 nodes, and the file ends after 1"),
        ("a.xyz", "2\n\nC 0 0 0\nC 1\n", "line 4 has 2 columns where node 2 of 2 is due"),
        ("a.xyz", "3\n\nC 0 0 0\n\n2\n", "line 4 has 0 columns where node 2 of 3 is due"),
        ("a.xyz", "2\n", "line 1 announces 2 nodes, and the file ends after 0"),
        ("a.obj", FOUR, "has no polylines; give records such as l 1 2 3"),
        ("a.obj", FOUR + "f 1 2 3\n", "has faces and no polylines"),
        ("a.obj", "l 1 2\n" + FOUR, "line 1 has vertex 1, and 0 vertices come before it"),
        ("a.obj", FOUR + "l 1 2 5\n", "line 5 has vertex 5, and 4 vertices come before it; give 1 to 4"),
        ("a.obj", FOUR + "l 1 -5\n", "line 5 has vertex -5"),
        ("a.obj", FOUR + "l 0 1\n", "line 5 has vertex 0"),
        ("a.obj", FOUR + "l 1 99999999999999999999\n", "line 5 has vertex '99999999999999999999'"),
        ("a.obj", FOUR + "l 1 2.5\n", "line 5 has vertex '2.5'; give a whole number"),
        ("a.obj", FOUR + "l 1\n", "line 5 has a polyline of fewer than 2 vertices"),
        ("a.obj", FOUR + "l 1 2 2 3\n", "repeats vertex"),
        ("a.obj", FOUR + "l 1 2 3\nl 4 2\n", "has lines that meet at vertex 2; a strand does not branch"),
        ("a.obj", FOUR + "l 1 2 1\n", "strand 0 in {path} is closed and has 2 nodes"),
        ("a.obj", "v 0 0\n", "line 1 has a vertex of 2 coordinates"),
        ("a.obj", "v 0 0 nan\n", "line 1 has z = 'nan'; give a finite number"),
        ("a.obj", "solid cube\n", "line 1 begins with 'solid'; give vertices v and polylines l"),
        ("a.vect", "OFF\n", "begins with 'OFF'; a VECT file begins with the word VECT"),
        ("a.vect", "VECT", "ends before the number of polylines"),
        ("a.vect", "VECT 999999999 999999999 0", "announces 999999999 polylines of 999999999 vertices"),
        ("a.vect", "VECT 1 1000000 0 1000000 0 0 0 0", "ends before vertex 1 of polyline 0; complete it"),
        ("a.vect", "VECT -1 3 0", "announces -1 polylines"),
        ("a.vect", "VECT 1 3 0 2 0 0 0 0", "announces 3 vertices, and its polylines have 2"),
        ("a.vect", "VECT 1.5 3 0", "has the number of polylines '1.5'; give a whole number"),
        ("a.vect", "VECT 1 2 0 2 0 0 0 0 0 0 inf", "has z = 'inf'; give a finite number"),
        ("a.vect", "VECT 1 1 0 1 0 0 0 0", "strand 0 in {path} has only one node"),
        ("a.vect", "VECT 2 2 0 2 0 0 0 0 0 0 0 1 1 1", "strand 1 in {path} has no node"),
    ],
)
def test_text_is_refused_with_the_line(tmp_path: Path, file: str, content: str, says: str) -> None:
    path = tmp_path / file
    assert says.format(path=repr(str(path))) in refusal(path, content)


# --- arrays


class Harmful:
    """Unpickled, it would make a file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (self.path,)


@pytest.mark.parametrize("suffix", [".npz", ".npy"])
def test_pickles_are_not_read(tmp_path: Path, suffix: str) -> None:
    x = np.empty((4, 3), dtype=object)
    x[:] = Harmful(tmp_path / "harm")
    assert "holds pickled objects, which are not read" in refusal(
        tmp_path / f"a{suffix}", array_file(suffix, x)
    )
    assert not (tmp_path / "harm").exists()


def with_header(text: str, data: bytes = b"") -> bytes:
    """An NPY file with a header of one's own."""
    head = text.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + data


def described(shape: str, kind: str = "<f8") -> str:
    return f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (array_file(".npy", np.zeros((1, 3))), "has only one node"),
        (array_file(".npy", np.zeros((0, 3))), "has no node"),
        (array_file(".npy", np.zeros((4, 2))), "has float64 of shape (4, 2); give numbers of shape (n, 3)"),
        (array_file(".npy", np.zeros(())), "of shape ()"),
        (array_file(".npy", np.zeros((0, 4, 3))), "has no nodes"),
        (array_file(".npy", np.ones((4, 3), dtype=bool)), "has bool of shape (4, 3)"),
        (
            array_file(".npy", np.ones((4, 3), dtype=complex)),
            "has 'complex128'; give an array of real numbers",
        ),
        (array_file(".npy", np.full((4, 3), "a")), "give an array of real numbers"),
        (array_file(".npy", np.zeros(4, dtype=[("x", "f8")])), "give an array of real numbers"),
        (array_file(".npy", np.array([[0, 0, 0], [1, np.nan, 0]])), "has node 1 at (1, nan, 0); give finite"),
        (array_file(".npy", np.zeros((4, 3)))[:-5], "ends before its 12 numbers"),
        (with_header(described("(99999999999, 3)")), "has shape (99999999999, 3); give at most"),
        (with_header(described("(-4, 3)")), "has shape (-4, 3)"),
        (with_header(described("(0, 99999999999, 3)")), "has shape"),
        (with_header(described("(1000000, 3)")), "ends before its 3000000 numbers"),
        (with_header(described("(4, 3)", "|V999999999")), "give an array of real numbers"),
        (with_header("(" * 300), "is no array of numpy"),
        (with_header("{" * 5 + "'"), "is no array of numpy"),
        (b"\x93NUMPY\x09\x00", "is no array of numpy"),
    ],
)
def test_arrays_are_refused(tmp_path: Path, content: bytes, says: str) -> None:
    assert says in refusal(tmp_path / "a.npy", content)
    if "only one" in says or "no node" in says:
        return
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("strand0.npy", content)
    assert says in refusal(tmp_path / "a.npz", packed.getvalue())


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_a_truncated_npz(tmp_path: Path, share: float) -> None:
    content = array_file(".npz", np.random.default_rng(0).normal(size=(1000, 3)))
    assert "is not a complete NPZ file" in refusal(tmp_path / "a.npz", content[: int(share * len(content))])


def test_an_npz_with_wrong_bytes(tmp_path: Path) -> None:
    content = bytearray(array_file(".npz", np.zeros((1000, 3))))
    content[5000] ^= 1
    assert "is not a sound NPZ file" in refusal(tmp_path / "a.npz", bytes(content))


def bomb(shape: str) -> bytes:
    """64 MB of zeros in 0.3 MB."""
    packed = io.BytesIO()
    with (
        zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("strand0.npy", "w", force_zip64=True) as member,
    ):
        member.write(with_header(described(shape)))
        for _ in range(64):
            member.write(bytes(2**20))
    return packed.getvalue()


def test_a_zip_bomb(tmp_path: Path) -> None:
    """Its header is read, and the data stay packed."""
    assert "has shape (2796202, 3); give at most" in refusal(tmp_path / "a.npz", bomb("(2796202, 3)"))
    assert "has float64 of shape (12, 1)" in refusal(tmp_path / "b.npz", bomb("(12, 1)"))


def test_a_zip_file_of_very_many_members(tmp_path: Path) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for k in range(30_000):
            archive.writestr(f"{k}" + "n" * 150, b"")
    assert "holds too many arrays" in refusal(tmp_path / "a.npz", packed.getvalue())


def test_members_that_are_missing_or_wrong(tmp_path: Path) -> None:
    x = np.arange(12.0).reshape(4, 3)
    path = tmp_path / "a.npz"

    def saved(**arrays: Any) -> str:
        np.savez(path, **arrays)
        return refusal(path)

    assert "holds 'y'; give arrays strand0, strand1 ... or x" in saved(y=x)
    assert "'closed' in" in saved(x=x, closed=np.array([True, False]))
    assert "give 1 truth values" in saved(x=x, closed=np.array([1.0]))
    assert "is more than one strand" in saved(strand0=np.stack([x, x]))
    assert "is more than one strand" in saved(strand0=x, strand1=np.zeros((0, 4, 3)))
    assert "strand 0 in" in saved(x=x[:2], closed=np.array(True))


def test_limits_hold_over_members_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from torsade.files import numpy_arrays

    monkeypatch.setattr(numpy_arrays, "MOST_NODES", 10)
    np.savez(tmp_path / "a.npz", **{f"strand{k}": np.ones((4, 3)) for k in range(3)})
    assert "10 nodes in all" in refusal(tmp_path / "a.npz")


def test_an_encrypted_or_strangely_packed_npz(tmp_path: Path) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("strand0.npy", array_file(".npy", np.zeros((4, 3))))
    content = bytearray(packed.getvalue())
    at = content.rfind(b"PK\x01\x02")
    for offset, value in itertools.product((8, 10), (1, 99)):
        changed = content.copy()
        changed[at + offset] = value  # flags, then the method of compression
        _read_or_refuse(tmp_path / "a.npz", bytes(changed))
