"""Runs: frames and numbers that agree, interruption, resuming to the bit, slack."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray

import torsade as ts
from torsade.assembly import assemble
from torsade.protocols import PrisonEscape, Tighten
from torsade.protocols.driving import Interrupted
from torsade.protocols.slack import take_up_slack

SHORT = PrisonEscape(knot="reef", duration="10 ms", frames=8)


@pytest.fixture(scope="module")
def short() -> ts.Result:
    return SHORT.run()


def test_frames_are_even_and_start_at_zero(short: ts.Result) -> None:
    np.testing.assert_allclose(short.dataset["time"], np.linspace(0, 0.01, 9), rtol=1e-12)
    assert short.complete
    assert np.isfinite(short.dataset["position"]).all()
    assert np.isfinite(short.dataset["log_strain"]).all()


def test_measured_separation_is_that_of_the_stored_ends(short: ts.Result) -> None:
    x = short.dataset["position"].values
    start = short.dataset["node_start"].values
    # A1 clamped, B1 pulled along x; positions are stored in single precision.
    apart = x[:, start[2] - 1, 0] - x[:, start[1] - 1, 0]
    np.testing.assert_allclose(short.dataset["separation"], apart, rtol=1e-6)


def test_work_is_stored_or_dissipated(short: ts.Result) -> None:
    data = short.dataset
    stored = sum(data[f"energy_{kind}"] for kind in ("stretch", "bend", "twist", "contact"))
    balance = (data["external_work"] - data["dissipation"]).values
    np.testing.assert_allclose(balance, stored - stored[0], atol=0.02 * float(data["external_work"][-1]))


def test_the_report_has_the_promised_keys(short: ts.Result) -> None:
    report = PrisonEscape.report(short)
    keys = "c_f pull_speed_m_per_s slipped_at_s times_s separation_m compression_N twist_rad rotation_rad "
    keys += "steps wall_s"
    assert set(keys.split()) <= report.keys()
    assert report["slipped_at_s"] is None
    assert np.shape(report["twist_rad"]) == (2, 9)
    speed = (report["separation_m"][-1] - report["separation_m"][0]) / 0.01
    assert report["pull_speed_m_per_s"] == pytest.approx(speed)


def test_runs_shorter_than_settling_say_from_when_they_are_measured(short: ts.Result) -> None:
    report = PrisonEscape.report(short)
    assert report["c_f"] > 0
    assert report["c_f_from_s"] == 0.0
    assert report["pulled"] == "A1B1"


@pytest.mark.slow
def test_friction_and_slipping_do_not_depend_on_frames() -> None:
    found = {n: PrisonEscape(knot="thief", frames=n).run() for n in (5, 100, 1000)}
    for result in found.values():
        assert result.c_f == pytest.approx(found[100].c_f, rel=0.005)
        assert result.slipped_at == pytest.approx(found[100].slipped_at, abs=0.01)
    assert found[5].c_f == found[100].c_f
    assert found[100].dataset.attrs["c_f_from_s"] == 0.3


def test_samples_are_even_whatever_the_frames(short: ts.Result) -> None:
    np.testing.assert_allclose(short.dataset["sample_time"], np.linspace(0, 0.01, 101), rtol=1e-9)
    both = np.isclose(short.dataset["sample_time"].values[:, None], short.dataset["time"].values)
    i, k = np.nonzero(both)
    np.testing.assert_array_equal(short.dataset["sample_separation"][i], short.dataset["separation"][k])


def test_the_same_run_twice_is_the_same_to_the_bit(short: ts.Result) -> None:
    assert SHORT.run().dataset.equals(short.dataset)


def test_ctrl_c_keeps_the_frames_and_resuming_changes_no_bit(tmp_path: Path, short: ts.Result) -> None:
    out = tmp_path / "reef.zarr"

    def stop(share: float, note: str) -> None:
        if share > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match=r"interrupted at t = 0.00375 s; 4 frames are saved in"):
        SHORT.run(stop, out)
    part = ts.open(tmp_path / "reef.zarr.part")
    assert part.frames == 4
    assert not part.complete
    assert part.dataset["position"].equals(short.dataset["position"][:4])
    with pytest.raises(ts.TorsadeError, match="is not complete; open"):
        ts.open(out)
    resumed = SHORT.run(out=out, resume=True)
    assert resumed.dataset.equals(short.dataset)
    assert ts.open(out).dataset.equals(short.dataset)
    assert not (tmp_path / "reef.zarr.part").exists()


def test_ctrl_c_before_the_first_frame_leaves_nothing(tmp_path: Path) -> None:
    def stop(share: float, note: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="interrupted before the first frame; nothing is saved"):
        SHORT.run(stop, tmp_path / "reef.zarr")
    assert list(tmp_path.iterdir()) == []


KILLED = """
import os, signal, sys
import torsade as ts
from torsade import recording
recording.FLUSH_EVERY = 0.0
def stop(share, note):
    if share > 0.6:
        os.kill(os.getpid(), signal.SIGKILL)
ts.protocols.PrisonEscape(knot="reef", duration="10 ms", frames=8).run(stop, sys.argv[1])
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_a_killed_run_can_be_read_and_resumed_to_the_bit(tmp_path: Path, short: ts.Result) -> None:
    out = tmp_path / "reef.zarr"
    done = subprocess.run([sys.executable, "-c", KILLED, str(out)], check=False)
    assert done.returncode == -signal.SIGKILL
    part = ts.open(tmp_path / "reef.zarr.part")
    assert part.frames == 5
    samples = part.dataset.sizes["sample"]
    assert 60 <= samples <= 62
    assert part.dataset.equals(short.dataset.isel(time=slice(0, 5), sample=slice(0, samples)))
    plain = xarray.open_zarr(tmp_path / "reef.zarr.part", chunks=None)
    assert plain.attrs["done"] == 5
    np.testing.assert_array_equal(plain["separation"][:5], short.dataset["separation"][:5])
    assert SHORT.run(out=out, resume=True).dataset.equals(short.dataset)


def test_resuming_something_else_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "reef.zarr"

    def stop(share: float, note: str) -> None:
        if share > 0.2:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        SHORT.run(stop, out)
    other = PrisonEscape(knot="reef", duration="10 ms", frames=8, force=14)
    with pytest.raises(ts.TorsadeError, match=r"was begun with force = 15.0, not 14.0; resume with the same"):
        other.run(out=out, resume=True)
    assert ts.open(tmp_path / "reef.zarr.part").frames == 2
    with pytest.raises(ts.TorsadeError, match=r"holds 2 frames of an interrupted run; add --resume"):
        other.run(out=out)
    assert ts.open(tmp_path / "reef.zarr.part").frames == 2
    assert other.run(out=out, overwrite=True).complete
    assert [p.name for p in tmp_path.iterdir()] == ["reef.zarr"]


def test_a_complete_run_is_not_run_again(tmp_path: Path) -> None:
    out = tmp_path / "reef.zarr"
    spec = PrisonEscape(knot="reef", duration="1 ms", frames=2)
    first = spec.run(out=out)
    assert spec.run(out=out, resume=True).dataset.attrs["created"] == first.dataset.attrs["created"]
    with pytest.raises(ts.TorsadeError, match="exists already; give another name"):
        spec.run(out=out)
    assert spec.run(out=out, overwrite=True).complete
    assert [p.name for p in tmp_path.iterdir()] == ["reef.zarr"]


def test_a_one_strand_knot(bends: Path) -> None:
    spec = Tighten(centerline=str(bends / "trefoil.csv"), duration="10 ms", frames=2)
    result = spec.run()
    report = Tighten.report(result)
    keys = "times_s end_to_end_m length_m h_kappa_max total_twist_rad max_log_strain steps wall_s"
    assert set(keys.split()) <= report.keys()
    assert all(len(report[k]) == 3 for k in keys.split()[:6])
    strain = result.dataset["log_strain"].max("node")
    np.testing.assert_allclose(report["max_log_strain"], strain, rtol=1e-6)


STILL = Tighten(knot="overhand", duration="20 s", frames=100, until_still="10 um/s")


def test_a_run_ends_in_the_first_frame_in_which_all_is_still() -> None:
    result = STILL.run()
    whole = STILL.model_copy(update={"until_still": None}).run()
    n = result.frames
    assert 2 < n < 101
    assert result.complete
    np.testing.assert_array_equal(result.dataset["position"], whole.dataset["position"][:n])
    x = whole.dataset["position"].values.astype(float)
    later = np.linalg.norm(x[n] - x[n - 1], axis=1).max() / 0.2
    before = np.linalg.norm(x[n - 2] - x[n - 3], axis=1).max() / 0.2
    assert later < 10e-6 < before
    assert Tighten.report(result)["still_at_s"] == pytest.approx(0.2 * (n - 1))
    assert Tighten.report(whole)["still_at_s"] is None


@pytest.mark.parametrize("share", [0.03, 0.06])
def test_a_run_until_still_resumes_to_the_bit(tmp_path: Path, share: float) -> None:
    def stop(done: float, note: str) -> None:
        if done >= share:
            raise KeyboardInterrupt

    whole, out = STILL.run(), tmp_path / "overhand.zarr"
    with pytest.raises(Interrupted):
        STILL.run(stop, out)
    resumed = STILL.run(out=out, resume=True)
    assert resumed.dataset.equals(whole.dataset)
    assert ts.open(out).dataset.equals(whole.dataset)


def test_a_run_that_was_still_when_it_was_killed_is_only_completed(tmp_path: Path) -> None:
    """Stopped between its last frame and its end, it takes no further step."""
    from torsade.recording import Recording

    whole, out = STILL.run(), tmp_path / "overhand.zarr"

    def killed(self: Recording, numbers: object) -> ts.Result:
        self.flush()
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Recording, "finish", killed)
        with pytest.raises(Interrupted):
            STILL.run(out=out)
    resumed = STILL.run(out=out, resume=True)
    assert resumed.dataset.equals(whole.dataset)
    assert resumed.dataset.attrs["over_at_s"] == whole.dataset.attrs["over_at_s"]


def test_recorded_parts_make_the_recorded_strain(short: ts.Result) -> None:
    data = short.dataset.astype(float)
    extension = data["strain_bend"] + data["strain_stretch"]
    total = np.hypot(data["strain_twist"], extension)
    np.testing.assert_allclose(np.log1p(total), data["log_strain"], rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("seed", range(5))
def test_slack_agrees_with_all_pairs(seed: int) -> None:
    """The distance of the first of all pairs to touch, by brute force."""
    rng = np.random.default_rng(seed)
    strands = [1e-4 * np.cumsum(rng.normal(size=(60, 3)), axis=0) for _ in range(2)]
    strands[1] -= np.array([rng.uniform(2e-3, 2e-2), 0.0, 0.0])
    assembly = assemble(strands)
    x = np.concatenate(strands)
    a, b = (0.5 * (s[1:] + s[:-1]) for s in strands)
    between = a[:, None] - b[None]
    touch, along = 4e-4 * (1 - 1e-3), between[..., 0]
    across = np.sum(between**2, axis=2) - along**2
    meets = (across < touch**2) & (along > 0)
    gap = (along[meets] - np.sqrt(touch**2 - across[meets])).min() if meets.any() else None
    assert take_up_slack(assembly, x, 1, np.array([1.0, 0, 0]), 4e-4) == (gap is not None)
    moved = x[60:, 0] - strands[1][:, 0]
    np.testing.assert_allclose(moved, 0.0 if gap is None else gap, rtol=1e-12)


def test_slack_of_long_strands_takes_little_memory() -> None:
    """All pairs of these midpoints would take 20 GB."""
    x = np.outer(np.arange(30_000) * 1e-4, [1.0, 0.0, 0.0])
    strands = [x, x - [3.2, 0.0, 0.0]]
    assembly = assemble(strands)
    now = np.concatenate(strands)
    assert take_up_slack(assembly, now, 1, np.array([1.0, 0, 0]), 4e-4)
    assert now[-1, 0] == pytest.approx(-3.5e-4, abs=1e-4)


def test_slack_is_taken_up_to_the_first_touch() -> None:
    a = np.outer(np.arange(-3, 4) * 1e-4, [0.0, 1.0, 0.0])
    b = np.outer(np.arange(-3, 4) * 1e-4, [0.0, 0.0, 1.0]) + np.array([-2e-3, 0.0, 0.0])
    assembly = assemble([a, b])
    x = np.concatenate([a, b])
    assert take_up_slack(assembly, x, 1, np.array([1.0, 0, 0]), 4e-4)
    # Midpoints half an edge off either axis are the first to touch, just within the diameter.
    gap = np.sqrt((4e-4 * (1 - 1e-3)) ** 2 - 2 * (0.5e-4) ** 2)
    np.testing.assert_allclose(x[7:, 0], -gap, rtol=1e-12)
    np.testing.assert_array_equal(x[:7], a)
    assert not take_up_slack(assembly, x, 1, np.array([-1.0, 0, 0]), 3e-4)
    assert take_up_slack(assembly, x, 1, np.array([-1.0, 0, 0]), 4e-4)  # touches already
