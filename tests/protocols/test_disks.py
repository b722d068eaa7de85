"""Disks that are full, that may not be written, or that fail in the middle: what is stored stays whole."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import torsade as ts
from short_runs import SHORT, assert_same
from torsade import places, recording, store
from torsade.protocols import PrisonEscape

WRITES = ("append", "write_restart", "set_attributes", "complete")


@pytest.mark.parametrize("what", WRITES)
@pytest.mark.parametrize("protocol", ["tighten", "snap-twist"])
def test_a_disk_that_is_full_for_a_while(
    what: str, protocol: str, stored: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the fifth write of a kind on, or at the end; with room again the run goes on to the same bits."""
    calls = []
    write = getattr(store, what)

    def full(part: Path, *rest: object) -> None:
        calls.append(what)
        if len(calls) < (1 if what == "complete" else 5):
            write(part, *rest)
            return
        with places.writing(part):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(recording, "FLUSH_EVERY", 0.0)
    monkeypatch.setattr(store, what, full)
    out, part = tmp_path / "run.zarr", tmp_path / "run.zarr.part"
    with pytest.raises(
        ts.TorsadeError, match=r"no space left on device\).* \(the frames until then are in '"
    ):
        SHORT[protocol].run(out=out)
    monkeypatch.undo()
    whole, done = ts.open(stored(protocol)), ts.open(part)
    assert 1 <= done.frames <= whole.frames
    for name, values in done.dataset.variables.items():
        if "time" in values.dims and name != "pull_speed":
            sound = whole.dataset.variables[name][: done.frames]
            assert values.values.tobytes() == sound.values.tobytes(), name
    assert_same(SHORT[protocol].run(out=out, resume=True), whole)
    assert [p.name for p in tmp_path.iterdir()] == ["run.zarr"]


LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
from torsade import recording
recording.FLUSH_EVERY = 0.0
from torsade.cli import main
main(sys.argv[2:])
"""


def test_a_file_system_that_takes_no_more(tmp_path: Path) -> None:
    """The chunk of positions grows with every frame until the system refuses it."""
    pytest.importorskip("resource")
    spec = PrisonEscape(knot="reef", duration="2 ms", frames=20)
    arguments = ["run", "prison-escape", "--knot=reef", "--duration=2 ms", "--frames=20", "--out", "run.zarr"]
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "42000", *arguments],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "(file too large)" in done.stderr
    assert "(the frames until then are in 'run.zarr.part')" in done.stderr
    assert done.stderr.count("\n") == 1
    assert 1 < ts.open(tmp_path / "run.zarr.part").frames < 20
    assert_same(spec.run(out=tmp_path / "run.zarr", resume=True), spec.run())


def test_a_disk_that_takes_nothing(tmp_path: Path) -> None:
    pytest.importorskip("resource")
    arguments = ["run", "bend-twist", "--end-distance=19 cm", "--out", "run.zarr"]
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "10", *arguments],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "cannot write" in done.stderr
    assert "Traceback" not in done.stderr


needs_permissions = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="who may do everything is refused nothing"
)


@needs_permissions
def test_a_folder_that_may_not_be_written(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(
            ts.TorsadeError, match=r"cannot write .*permission denied\); give a place with room"
        ):
            SHORT["bend-twist"].run(out=tmp_path / "run.zarr")
    finally:
        tmp_path.chmod(0o700)


@needs_permissions
def test_a_result_that_may_not_be_read(tmp_path: Path) -> None:
    SHORT["bend-twist"].run(out=tmp_path / "run.zarr")
    for path in (tmp_path / "run.zarr", tmp_path / "run.zarr" / "zarr.json"):
        before = path.stat().st_mode
        path.chmod(0)
        with pytest.raises(ts.TorsadeError, match="may not be read"):
            ts.open(tmp_path / "run.zarr")
        path.chmod(before)
    chunk = next(store.chunks_of(tmp_path / "run.zarr" / "position"))
    chunk.chmod(0)
    with pytest.raises(ts.TorsadeError, match="cannot be read: permission denied"):
        ts.open(tmp_path / "run.zarr")


def hostile(part: Path, **changes: object) -> None:
    """Change arrays of the restart file."""
    import numpy as np

    with np.load(part / store.RESTART) as file:
        arrays = {name: file[name] for name in file.files}
    np.savez(part / store.RESTART, **(arrays | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize("protocol", ["tighten", "snap-twist"])
@pytest.mark.parametrize(
    "case", ["shape", "type", "order", "text", "frames", "samples", "object", "packed", "breaks"]
)
def test_a_state_that_is_none_is_refused(protocol: str, case: str, tmp_path: Path) -> None:
    """Kernels would read beyond arrays that are too short; nothing is unpickled or unpacked."""
    import zipfile

    import numpy as np

    from torsade.protocols.driving import Interrupted

    def stop(share: float, note: str) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        SHORT[protocol].run(stop, tmp_path / "run.zarr")
    part = tmp_path / "run.zarr.part"
    with np.load(part / store.RESTART) as file:
        x, done = file["x"], int(file["done"])
    changes: dict[str, dict[str, object]] = {
        "shape": {"x": x[:3]},
        "type": {"x": x.astype(np.float32)},
        "order": {"x": np.asfortranarray(x)},
        "text": {"done": np.array("many")},
        "frames": {"done": np.array(10**6)},
        "samples": {"sampled": np.array(-1)},
        "object": {"x": np.array([print], dtype=object)},
        "breaks": {"breaks": np.zeros((3, 2)), "v": x[:1]},
    }
    if case == "packed":
        with np.load(part / store.RESTART) as file:
            arrays = {name: file[name] for name in file.files}
        np.savez_compressed(part / store.RESTART, **arrays)
        with zipfile.ZipFile(part / store.RESTART) as archive:
            assert archive.infolist()[0].compress_type == zipfile.ZIP_DEFLATED
    else:
        hostile(part, **changes[case])
    with pytest.raises(ts.TorsadeError, match=r"the state to go on from in .* is damaged; open") as refused:
        SHORT[protocol].run(out=tmp_path / "run.zarr", resume=True)
    assert "\n" not in str(refused.value)
    assert ts.open(part).frames == done


@pytest.mark.parametrize("case", ["lost", "shorter", "unsaid", "counted"])
def test_a_growing_run_that_is_spoilt_is_not_gone_on_with(case: str, tmp_path: Path) -> None:
    import json
    import shutil

    from torsade.protocols.driving import Interrupted

    def stop(share: float, note: str) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        SHORT["tighten"].run(stop, tmp_path / "run.zarr")
    part = tmp_path / "run.zarr.part"
    about = json.loads((part / "zarr.json").read_text())
    if case == "lost":
        shutil.rmtree(part / "length")
        about["consolidated_metadata"] = None
    elif case == "shorter":
        described = json.loads((part / "position" / "zarr.json").read_text())
        described["shape"][1] -= 1
        (part / "position" / "zarr.json").write_text(json.dumps(described))
    elif case == "unsaid":
        del about["attributes"]["resumed"]
    else:
        about["attributes"]["done"] = "many"
    (part / "zarr.json").write_text(json.dumps(about))
    with pytest.raises(ts.TorsadeError) as refused:
        SHORT["tighten"].run(out=tmp_path / "run.zarr", resume=True)
    assert "run.zarr.part" in str(refused.value)
    assert "\n" not in str(refused.value)
    with pytest.raises(ts.TorsadeError, match="of an interrupted run; add --resume"):
        SHORT["tighten"].run(out=tmp_path / "run.zarr")
    assert SHORT["tighten"].run(out=tmp_path / "run.zarr", overwrite=True).complete
