"""Pictures show what they should: strands, colours, marks; and refuse what cannot be drawn."""

from __future__ import annotations

import sys
from colorsys import rgb_to_hsv

import numpy as np
import pytest
import xarray as xr

from torsade.errors import TorsadeError
from torsade.view.colours import strain_colour, strand_colour
from torsade.view.overlay import Mark
from torsade.view.scene import picture, render, render_result

pytest.importorskip("pyvista")
pytest.importorskip("matplotlib")

H = 0.2e-3
SMALL = (320, 240)
S = np.linspace(-4e-3, 4e-3, 41)
ALONG = np.stack([S, 0 * S, 0 * S], axis=1)
ACROSS = np.stack([0 * S, S, 0 * S + 2 * H], axis=1)


def ring(n=40, radius=1.5e-3):
    t = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)


def ink(image):
    return image.min(axis=2) < 0.97


def hue(rgb):
    return 360.0 * rgb_to_hsv(*rgb)[0]


def result():
    values = np.stack([np.zeros(82), np.concatenate([np.full(41, 0.5), np.full(41, 0.7)])])
    positions = np.stack([np.concatenate([ALONG, ACROSS]), np.concatenate([ALONG, ACROSS + 1e-3])])
    return xr.Dataset(
        {
            "position": (("time", "node", "space"), positions),
            "log_strain": (("time", "node"), values),
            "node_start": (("fiber_bound",), np.array([0, 41, 82])),
            "closed": (("fiber",), np.array([False, False])),
        },
        coords={"time": [0.0, 1.0]},
        attrs={"radius": H},
    )


def test_a_picture_has_the_asked_size_white_paper_and_strands_on_it():
    image = picture([ALONG, ACROSS], False, H, size=SMALL)
    assert image.shape == (240, 320, 3)
    assert image.min() >= 0.0
    assert image.max() <= 1.0
    assert image[:10, :10] == pytest.approx(1.0)
    assert 0.1 < ink(image).mean() < 0.7


def test_leads_run_out_of_the_frame_and_the_upper_strand_lies_on_top():
    image = picture([ALONG, ACROSS], False, H, size=SMALL, direction=(0, 0, 1))
    assert ink(image)[120, [0, -1]].all()
    assert ink(image)[[0, -1], 160].all()
    over = [hue(image[120, 160]), hue(strand_colour(1))]
    assert over[0] == pytest.approx(over[1], abs=8)
    below = picture([ALONG, ACROSS], False, H, size=SMALL, direction=(0, 0, -1))
    assert hue(below[120, 160]) == pytest.approx(hue(strand_colour(0)), abs=8)


@pytest.mark.parametrize("strain", [0.0, 0.25, 0.35, 0.5, 0.6, 0.7])
def test_a_strained_fiber_has_the_hue_of_its_strain(strain):
    image = picture([ring()], True, H, values=[np.full(40, strain)], size=SMALL)
    bar_free = image.copy()
    bar_free[180:, :140] = 1.0
    painted = bar_free[ink(bar_free)]
    saturation = (painted.max(axis=1) - painted.min(axis=1)) / painted.max(axis=1)
    hues = [hue(rgb) for rgb in painted[saturation > 0.7]]
    wanted = hue(strain_colour(strain))
    off = (np.array(hues) - wanted + 180) % 360 - 180
    assert len(hues) > 0.4 * len(painted)
    assert abs(np.median(off)) < 9


def test_the_colour_bar_shows_the_whole_scale():
    image = picture([ring()], True, H, values=[np.zeros(40)], size=(640, 480))
    for strain in (0.05, 0.25, 0.35, 0.5, 0.65):
        assert np.abs(image - strain_colour(strain)).max(axis=2).min() < 0.03


def test_no_colour_bar_without_values():
    image = picture([ring()], True, H, size=(640, 480))
    assert np.abs(image - strain_colour(0.5)).max(axis=2).min() > 0.2


def test_strands_hide_light_from_each_other():
    """The lower strand is darker beside the upper one than far from it."""
    image = picture([ALONG, ACROSS], False, H, size=SMALL, direction=(0, 0, 1))
    row = image[112].sum(axis=1)
    of_lower = np.abs(image[112] - image[112, 4]).max(axis=1) < 0.6
    covered = np.flatnonzero(image[20].min(axis=1) < 0.97)
    beside = covered.max() + 3
    assert of_lower[beside]
    assert row[beside] < 0.85 * row[-5]


def test_a_closed_fiber_has_no_seam():
    """Turned by a tenth of its nodes, the list of the same nodes gives the same picture."""
    first = picture([ring()], True, H, size=SMALL, direction=(0, 0, 1))
    again = picture([np.roll(ring(), 4, axis=0)], True, H, size=SMALL, direction=(0, 0, 1))
    assert np.abs(first - again).max() < 0.03


def test_the_same_input_gives_the_same_picture():
    first, again = (picture([ALONG, ACROSS], False, H, size=SMALL) for _ in range(2))
    assert np.array_equal(first, again)


def test_the_picture_does_not_depend_on_the_unit_of_length_or_the_place():
    first = picture([ALONG, ACROSS], False, H, size=SMALL)
    again = picture([1e3 * ALONG + 5.0, 1e3 * ACROSS + 5.0], False, 1e3 * H, size=SMALL)
    assert np.abs(first - again).max() < 0.02


def test_fading_leaves_the_middle_and_whitens_the_border():
    plain, faded = (picture([ALONG, ACROSS], False, H, size=SMALL, fade=f) for f in (0.0, 0.1))
    assert faded[100:140, 140:180] == pytest.approx(plain[100:140, 140:180])
    assert faded[:, [0, -1]].min() > 0.99


def test_marks_add_ink_beside_the_strand_and_stay_in_the_frame():
    marks = [Mark(0, 0, "A1", (-1.0, 0.0, 0.0)), Mark(1, -1, "B2")]
    plain = picture([ALONG, ACROSS], False, H, size=(640, 480))
    marked = picture([ALONG, ACROSS], False, H, size=(640, 480), marks=marks)
    added = np.abs(plain - marked).max(axis=2) > 0.3
    assert 50 < added.sum() < 5000
    assert not (added & ink(plain)).any()
    assert not added[:5].any()
    assert not added[:, :5].any()


def test_rendering_writes_a_png_and_prints_nothing(tmp_path, capfd):
    path = render([ALONG, ACROSS], [False, False], H, tmp_path / "bend.png", size=SMALL)
    assert path.read_bytes()[:4] == b"\x89PNG"
    assert capfd.readouterr() == ("", "")


def test_a_result_is_drawn_with_the_strain_of_the_chosen_frame(tmp_path):
    from matplotlib.image import imread

    first = imread(render_result(result(), tmp_path / "0.png", frame=0, size=SMALL))[:, :, :3]
    last = imread(render_result(result(), tmp_path / "1.png", size=SMALL))[:, :, :3]
    green = [
        ((im[:, :, 1] > 2 * im[:, :, 0]) & (im[:, :, 1] > 2 * im[:, :, 2])).mean() for im in (first, last)
    ]
    assert green[0] < 0.01
    assert green[1] > 0.02


def test_what_a_result_lacks_is_named(tmp_path):
    with pytest.raises(TorsadeError, match="node_start"):
        render_result(result().drop_vars("node_start"), tmp_path / "a.png")
    with pytest.raises(TorsadeError, match="numbered from 0"):
        render_result(result(), tmp_path / "a.png", frame=2)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"strands": []}, "at least one strand"),
        ({"closed": [False, True]}, "one answer for each"),
        ({"strands": [np.full((5, 3), np.nan)]}, "finite"),
        ({"strands": [np.zeros((5, 2))]}, r"\(n, 3\)"),
        ({"radius": -1.0}, "positive"),
        ({"size": (100, 100)}, "multiples of 16"),
        ({"values": [np.zeros(3)]}, "one value per node"),
        ({"values": [np.full(41, np.nan)]}, "not finite"),
        ({"direction": (0, 0, 0)}, "three numbers"),
    ],
)
def test_bad_input_is_refused_with_a_reason(changes, words):
    given = {"strands": [ALONG], "closed": False, "radius": H, **changes}
    with pytest.raises(TorsadeError, match=words):
        picture(given.pop("strands"), given.pop("closed"), given.pop("radius"), **given)


def test_an_unwritable_path_is_named(tmp_path):
    with pytest.raises(TorsadeError, match="missing"):
        render([ring()], True, H, tmp_path / "missing" / "a.png", size=(160, 160))


def test_a_missing_library_is_named_with_the_way_to_install_it(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(TorsadeError, match=r'pyvista.*pip install "torsade\[view\]"'):
        render([ring()], True, H, tmp_path / "a.png", size=SMALL)
