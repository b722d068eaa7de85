"""Movies: as many pictures as asked for, a camera that stays, breaks where they are, no half files."""

from __future__ import annotations

import math
import re
import subprocess
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import torsade as ts
from torsade.errors import TorsadeError
from torsade.protocols import Battery, SnapTwist
from torsade.view import film
from torsade.view.captions import Clock, nice_length, pace
from torsade.view.colours import strain_colour
from torsade.view.encode import encoder
from torsade.view.moments import Moments

pytest.importorskip("pyvista")
pytest.importorskip("matplotlib")
ffmpeg = pytest.importorskip("imageio_ffmpeg")

SMALL = {"size": (192, 112), "seconds": 1.0, "fps": 6.0}


@pytest.fixture(scope="module")
def broken() -> xr.Dataset:
    """A rod that breaks in the middle, and then four more times."""
    return SnapTwist(twist="60 deg", duration="0.8 ms", frames=40).run().dataset


def slid() -> xr.Dataset:
    """Two crossed fibers of radius 1, one of which moves along itself."""
    s = np.linspace(-12.0, 12.0, 25)
    still = np.stack([s, 0 * s, 0 * s], axis=1)
    across = np.stack([0 * s, s, 0 * s + 2.0], axis=1)
    along = np.array([0.0, 1.0, 0.0])
    positions = np.stack([np.concatenate([still, across + dy * along]) for dy in (0.0, 2.0, 6.0)])
    return xr.Dataset(
        {
            "position": (("time", "node", "space"), positions),
            "log_strain": (("time", "node"), np.tile(np.repeat([0.1, 0.5], 25), (3, 1))),
            "node_start": (("fiber_bound",), np.array([0, 25, 50])),
            "closed": (("fiber",), np.array([False, False])),
        },
        coords={"time": [0.0, 1.0, 2.0]},
        attrs={"radius": 1.0, "protocol": "tighten"},
    )


def pictures(path: Path) -> tuple[str, np.ndarray]:
    """What a file says of its stream, and its pictures (n, height, width, 3)."""
    command = [ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(command, capture_output=True, check=True)
    about = re.search(r"Stream .*Video: (.*)", done.stderr.decode())[1]
    width, height = map(int, re.search(r", (\d+)x(\d+)", about).groups())
    return about, np.frombuffer(done.stdout, np.uint8).reshape(-1, height, width, 3).astype(int)


def test_a_movie_has_the_size_and_the_pictures_that_were_asked_for(broken, tmp_path: Path) -> None:
    """Sides are rounded to multiples of 16; the file plays where H.264 with 4:2:0 does."""
    path = film.movie(broken, tmp_path / "rod.mp4", size=(190, 115), seconds=1.0, fps=6.0)
    about, seen = pictures(path)
    assert seen.shape == (6, 112, 192, 3)
    assert about.startswith("h264")
    assert "yuv420p" in about
    assert " 6 fps" in about
    assert [p.name for p in tmp_path.iterdir()] == ["rod.mp4"]


def test_pieces_move_and_the_camera_does_not(broken, tmp_path: Path) -> None:
    """The scale and the colour bar stay to the pixel; the rod is elsewhere in every picture."""
    _, seen = pictures(film.movie(broken, tmp_path / "rod.mp4", **SMALL))
    assert np.abs(seen[1:, 94:] - seen[:1, 94:]).mean() < 0.12  # of loss in the codec
    assert (seen[0, 94:] < 200).any()
    rod = seen[:, 30:90]
    assert all(np.abs(b - a).mean() > 0.2 for a, b in pairwise(rod[:-1]))


def test_all_is_in_view(broken, tmp_path: Path) -> None:
    moments = Moments(broken)
    shooting = film._Shooting(moments, (320, 192), "stress", False, 0.0)
    for moment in moments.spread():
        at = shooting.view.pixels(np.concatenate(shooting._nodes(moment)))
        assert (at > 8).all()
        assert (at < np.array([312, 184])).all()


def test_nodes_move_straight_between_frames_and_breaks_open(broken) -> None:
    """At stored times pieces are the stored ones; half-way, across a break too, nodes are in the middle."""
    moments = Moments(broken)
    time, counts = moments.times, []
    for k in range(len(time) - 1):
        here, later = moments.at(time[k]), moments.at(time[k + 1])
        half = moments.at(0.5 * (time[k] + time[k + 1]))
        counts.append(len(here.strands))
        x = np.asarray(broken["position"][k])
        assert np.array_equal(np.concatenate(here.strands), x[np.isfinite(x[:, 0])])
        assert [len(s) for s in half.strands] == [len(s) for s in later.strands]
        if counts[-1] == len(later.strands):
            middle = [0.5 * (a + b) for a, b in zip(here.strands, later.strands, strict=True)]
            np.testing.assert_allclose(np.concatenate(half.strands), np.concatenate(middle), atol=1e-15)
            continue
        first = 2.0 * np.concatenate(half.strands) - np.concatenate(later.strands)
        ends = np.cumsum([len(s) for s in half.strands])[:-1]
        gaps = np.linalg.norm(first[ends] - first[ends - 1], axis=1)
        assert np.sum(gaps < 1e-15) >= len(later.strands) - counts[-1]  # together at the frame before
        length = np.linalg.norm(np.diff(first, axis=0), axis=1)
        assert np.delete(length, ends - 1) == pytest.approx(0.005, rel=1e-3)  # each from its own neighbour
    assert counts[0] == 2
    assert len(moments.at(time[-1]).strands) == broken.attrs["fragments"] > 2


def test_a_rod_is_whole_before_it_breaks(broken) -> None:
    """One piece, as long as the rod, at its strength in the middle."""
    whole = Moments(broken).before_the_break()
    assert len(whole.strands) == 1
    length = np.linalg.norm(np.diff(whole.strands[0], axis=0), axis=1)
    assert length == pytest.approx(np.full(48, 0.005), rel=1e-4)
    assert whole.values[0].max() == pytest.approx(1.0, abs=0.01)
    assert np.argmax(whole.values[0]) in (23, 24, 25)


def test_breaks_are_marked_where_they_are(broken) -> None:
    """A ring when each happens and none later; around the two ends that part."""
    moments = Moments(broken)
    shooting = film._Shooting(moments, (320, 192), "stress", False, 0.0)
    shots = list(film._shots(moments, 400))
    marked = [shooting.rings(moments.at(s.time), s) for s in shots if not s.before]
    assert max(len(rings) for rings in marked) <= 2
    assert not marked[-1]
    first = next(rings for rings in marked if rings)[0]
    assert first.place[0] == pytest.approx(160.0, abs=1.0)
    assert [s.before for s in shots].index(False) == pytest.approx(film.LEAD * 400, abs=1)


def test_a_knot_in_motion_and_a_gif(tmp_path: Path) -> None:
    """One fiber stays, the other slides; strain colours stand on both."""
    _, seen = pictures(film.movie(slid(), tmp_path / "slid.gif", **SMALL))
    assert len(seen) == 6
    greens = [(p[..., 1] > p[..., 0] + 60).sum() for p in seen]
    assert min(greens) > 100
    assert np.abs(seen[0] - seen[-1]).max() > 100


def test_colours_are_kept(tmp_path: Path) -> None:
    """Strain colours are measurements: what is read back is what was drawn, to the loss of the codec."""
    path = tmp_path / "colours.mp4"
    colours = np.round(255 * strain_colour([0.0, 0.2, 0.4, 0.6])).astype(np.uint8)
    with encoder(path, (128, 64), 5.0) as add:
        add(np.repeat(np.repeat(colours[None], 32, axis=1), 64, axis=0))
    about, seen = pictures(path)
    assert "bt709" in about
    np.testing.assert_allclose(seen[0, 32, 16::32], colours, atol=4)


def test_an_interrupted_movie_leaves_the_file_that_was_there(broken, tmp_path: Path) -> None:
    path = tmp_path / "rod.mp4"
    path.write_bytes(b"an earlier one")

    def interrupt(share: float, note: str) -> None:
        if share > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        film.movie(broken, path, progress=interrupt, **SMALL)
    assert path.read_bytes() == b"an earlier one"
    assert list(tmp_path.iterdir()) == [path]


def test_what_cannot_be_filmed_is_refused(broken, tmp_path: Path) -> None:
    still = broken.isel(time=[0])
    for dataset, options, says in (
        (broken.drop_vars("position"), {}, "snap-twist has no fibers that move in time"),
        (still, {}, "snap-twist has 1 frame, and a movie needs 2"),
        (broken, {"frames": (5, 5)}, r"the frames asked for are 5:5; give a first .* 0 to 40"),
        (broken, {"colour": "strain"}, "of this result it can be 'stress' or 'strands'"),
        (broken, {"fps": 0.0}, "with 0 pictures a second"),
        (broken, {"size": (10, 10)}, "the size of the movie is 10 x 10; give"),
    ):
        with pytest.raises(TorsadeError, match=says):
            ts.view.movie(dataset, tmp_path / "rod.mp4", **options)
    with pytest.raises(TorsadeError, match=r"a name that ends in \.mp4 or \.gif"):
        ts.view.movie(broken, tmp_path / "rod.avi")
    with pytest.raises(TorsadeError, match="cannot be written"):
        ts.view.movie(broken, tmp_path / "nowhere" / "rod.mp4")
    assert not list(tmp_path.iterdir())


def test_frames_before_the_break_are_left_out(broken) -> None:
    """Of a history that begins long before, 15 % of what comes after are shown; --frames shows all."""
    late = broken.copy()
    late.attrs |= {"break_times_s": [0.4e-3], "break_places_m": [0.12]}
    moments = Moments(late)
    assert moments.times[0] == pytest.approx(0.34e-3, abs=0.02e-3)
    assert Moments(late, (0, -1)).times[0] == 0.0


def test_times_and_lengths_are_written_as_people_do() -> None:
    assert Clock.over(0.0, 2.06e-3).number(1.2345e-3) == "1234"
    assert Clock.over(0.0, 2.06e-3).name == "µs"
    assert Clock.over(0.0, 1.0).number(0.25) == "0.25"
    assert Clock.over(-1.0, 0.5).number(-1e-9) == "0.00"
    assert Clock.over(-1.0, 0.5).number(-0.25) == "\N{MINUS SIGN}0.25"
    assert Clock.over(-1.0, 0.5).digits == 5
    assert [nice_length(x) for x in (1.0, 0.049, 7.3)] == pytest.approx([1.0, 0.02, 5.0])
    assert [pace(x) for x in (1.0, 3912.0, 0.5, 1.24)] == [
        "real time",
        "3\N{THIN SPACE}900 times slower",
        "2.0 times faster",
        "1.2 times slower",
    ]


@pytest.fixture(scope="module")
def battery() -> xr.Dataset:
    spec = Battery(knot="3_1", twist=2.0, nodes=60, charging="0.1 s", duration="0.6 s", frames=20)
    return spec.run().dataset


def test_time_of_a_battery_runs_ever_faster(battery) -> None:
    """Evenly in log(1 + t/tau), tau a quarter of the time in which half the energy goes; and back."""
    moments = Moments(battery)
    end = moments.times[-1]
    tau = 0.25 * battery.attrs["discharge_time_T0"]["50"] * battery.attrs["T0_s"]
    for time in (0.0, 0.1 * end, end):
        share = math.log1p(time / tau) / math.log1p(end / tau)
        assert moments.share(time) == pytest.approx(share, abs=1e-12)
        assert moments.when(share) == pytest.approx(time, abs=1e-12)
    part = Moments(battery, (5, 10))
    assert (part.share(part.times[0]), part.share(part.times[-1])) == pytest.approx((0.0, 1.0))
    assert not part.broken_at_first
    even = Moments(slid())
    assert [even.share(t) for t in (0.0, 0.5, 2.0)] == [0.0, 0.25, 1.0]


def test_a_battery_says_what_it_is_and_what_is_left(battery) -> None:
    moments = Moments(battery)
    assert moments.note(0.0) == "3_1, 100 % of the energy left"
    energy = sum(battery[f"energy_{kind}"].values for kind in ("bend", "twist", "stretch", "contact"))
    left = 100 * energy[-1] / energy[0]
    words = moments.note(float(moments.times[-1])).split(", ")
    assert float(words[1].split()[0]) == pytest.approx(left, abs=0.51)
    assert words[0] in ("untied", "3_1")


def test_a_battery_is_whole_before_it_is_cut_and_then_marked(battery) -> None:
    moments = Moments(battery)
    shooting = film._Shooting(moments, (320, 192), "energy", False, 0.0)
    shots = list(film._shots(moments, 200))
    assert [s.before for s in shots].index(False) == pytest.approx(film.LEAD * 200, abs=1)
    marked = [shooting.rings(moments.at(s.time), s) for s in shots]
    assert not marked[0]
    assert not marked[-1]
    first = next(rings for rings in marked if rings)[0]
    ends = shooting.view.pixels(shooting._nodes(moments.at(0.0))[0][[0, -1]])
    np.testing.assert_allclose(first.place, ends[0], atol=1.0)
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-6)


@pytest.mark.parametrize("colour", [None, "strain", "strands"])
def test_a_battery_is_filmed(battery, colour: str | None, tmp_path: Path) -> None:
    """All of it is in view; at the end it lies level."""
    _, seen = pictures(film.movie(battery, tmp_path / "b.mp4", colour=colour, **SMALL))
    assert len(seen) == 6
    shooting = film._Shooting(Moments(battery), (320, 192), "energy", False, 0.0)
    for moment in Moments(battery).spread():
        at = shooting.view.pixels(np.concatenate(shooting._nodes(moment)))
        assert ((at > 0) & (at < np.array([320, 192]))).all()
    first, last = at[0], at[-1]
    assert abs(first[1] - last[1]) < 0.1 * abs(first[0] - last[0]) + 1
