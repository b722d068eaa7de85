"""Self-torque beside writhe: exact sums, the law where it holds, and the two figures in their quick mode."""

from __future__ import annotations

import csv
import json
from itertools import combinations, pairwise

import numpy as np
import pytest
import xarray

import torsade as ts
from torsade.cli.figure import draw
from torsade.figures import bends, figure_4_3, figure_4_4
from torsade.figures.base import Choice
from torsade.figures.flow import arrows, flow
from torsade.figures.moments import coefficients, moment, orientation, torque_of
from torsade.figures.runs import results
from torsade.figures.torque_writhe import balance, window
from torsade.protocols import PrisonEscape
from torsade.reptation import node_tangents
from torsade.results import Result
from torsade.topology import writhe

H, ETA_F_RATIO, ETA = 2e-4, 3.3, 1e5


@pytest.fixture(scope="module")
def granny() -> Result:
    return PrisonEscape(knot="granny", duration="0.35 s", frames=35).run()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("figures")


def helix(pitch: float, turns: int, nodes: int) -> tuple[list[np.ndarray], float]:
    """Two strands, R = 2h apart, winding around each other; both run towards +z. Also their length each."""
    angle = np.linspace(0, 2 * np.pi * turns, nodes)
    z = pitch * angle / (2 * np.pi)
    strands = [np.stack([s * H * np.cos(angle), s * H * np.sin(angle), z], axis=1) for s in (1.0, -1.0)]
    return strands, float(np.hypot(pitch, 2 * np.pi * H) * turns)


def result_of(strands, velocities, torque) -> Result:
    """A result with one frame, both strands gripped at their last ends."""
    starts = np.cumsum([0] + [len(x) for x in strands])
    laws = {"eta_f_ratio": ETA_F_RATIO, "drag": "continuum", "exclusion_edges": 1, "exclusion_radii": np.pi}
    model = {"radius": H, "laws": laws, "material": {"eta": ETA}}
    data = xarray.Dataset(
        {
            "position": (("time", "node", "space"), np.concatenate(strands)[None]),
            "velocity": (("time", "node", "space"), np.concatenate(velocities)[None]),
            "self_torque": (("time", "edge"), torque[None]),
            "node_start": ("fiber_bound", starts),
        },
        coords={"time": [0.0]},
        attrs={"pulled": "A1B1", "radius": H, "model": json.dumps(model), "spec": "{}"},
    )
    return Result(data)


def law_of_drag(strands, velocities, reach):
    """Self-torque density, brute force: eta_f J Σ l' (r × dv).t/R^5 over the other strand, in reach."""
    mid, e, u = ([f(x) for x in y] for f, y in (
        (lambda x: 0.5 * (x[1:] + x[:-1]), strands), (lambda x: np.diff(x, axis=0), strands),
        (lambda x: 0.5 * (x[1:] + x[:-1]), velocities),
    ))  # fmt: skip
    J = 0.5 * np.pi * H**4
    found = []
    for a, b in ((0, 1), (1, 0)):
        r = mid[b][None] - mid[a][:, None]
        R = np.linalg.norm(r, axis=2)
        l = np.linalg.norm(e[b], axis=1)
        t = e[a] / np.linalg.norm(e[a], axis=1)[:, None]
        turn = np.einsum("abc,ac->ab", np.cross(r, u[b][None] - u[a][:, None]), t)
        found.append(ETA_F_RATIO * ETA * J * np.where(reach > R, l[None] * turn / R**5, 0.0).sum(axis=1))
    return np.concatenate(found)


def test_for_strands_that_slide_at_one_speed_torque_is_the_writhe_in_contact():
    """Two strands wound around each other, v = u t: torque is pi u eta_f J Wr/h² (2h/R)², pair by pair."""
    strands, _ = helix(30 * H, 2, 600)
    speed = 3e-3
    velocities = [speed * node_tangents(x) for x in strands]
    torque = law_of_drag(strands, velocities, 2.05 * H)
    seen = moment(result_of(strands, velocities, torque), 0)
    scale = np.pi * speed / H**2 * coefficients(result_of(strands, velocities, torque)).eta_f_J
    # Contact is between points less than 2h apart: here all from 2h to 2.05h, so that (2h/R)² is 0.95 to 1.
    assert seen.total_torque > 0
    assert seen.fit is not None
    assert seen.fit.explained == pytest.approx(1.0, abs=1e-6)
    assert seen.total_writhe == pytest.approx(writhe(strands, False), rel=1e-12)
    touching = pair_writhe(strands, 2.05 * H)
    assert 0.95 < seen.total_torque / scale / touching < 1.0


def pair_writhe(strands, reach):
    """Writhe of pairs of edges of the two strands with midpoints in reach, by quadrature."""
    (x, e), (y, f) = ((0.5 * (s[1:] + s[:-1]), np.diff(s, axis=0)) for s in strands)
    r = y[None] - x[:, None]
    R = np.linalg.norm(r, axis=2)
    pair = np.einsum("abc,abc->ab", np.cross(r, f[None]), np.broadcast_to(e[:, None], r.shape)) / R**3
    return float(np.where(reach > R, pair, 0.0).sum() / (2 * np.pi))


@pytest.mark.parametrize("laws", [{}, {"exclusion_edges": 35}, {"exclusion_radii": 17.7}], ids=str)
@pytest.mark.parametrize("preset", ["standard", "published"])
def test_pairs_are_the_contacts_of_the_run(preset, laws):
    """Those that a search of all pairs finds with the laws that were asked for, in rest arclength."""
    spec = PrisonEscape(knot="granny", duration="0.02 s", frames=4, preset=preset, **laws)
    result = spec.run()
    assert orientation(result) == [1, 1]  # edges are numbered as in the run
    usual = {"standard": (1, np.pi), "published": (10, 0)}[preset]
    own = laws.get("exclusion_edges", usual[0]), laws.get("exclusion_radii", usual[1])
    expected = contacts(result, *own)
    pairs = moment(result, -1).pairs
    assert len(expected) > 20
    assert set(zip(pairs.i.tolist(), pairs.j.tolist(), strict=True)) == expected
    assert bool(laws) == (expected < contacts(result, *usual))


def contacts(result, exclusion_edges, exclusion_radii):
    """Pairs of edges in the last frame, with a torque, midpoints nearer than 2h and not excluded."""
    data = result.dataset
    last, first = data["position"].values[[-1, 0]].astype(float)
    torque = data["self_torque"].values[-1]
    mid, along, strand = [], [], []
    for k, (a, b) in enumerate(pairwise(data["node_start"].values)):
        mid.extend(0.5 * (last[a + 1 : b] + last[a : b - 1]))
        rest = np.linalg.norm(np.diff(first[a:b], axis=0), axis=1)
        along.extend(np.cumsum(rest) - 0.5 * rest)
        strand.extend([k] * len(rest))
    found = set()
    for i, j in combinations(np.flatnonzero(torque).tolist(), 2):
        far = j - i > exclusion_edges and along[j] - along[i] >= exclusion_radii * H
        if (strand[i] != strand[j] or far) and np.linalg.norm(mid[i] - mid[j]) < 2 * H:
            found.add((i, j))
    return found


def test_writhe_densities_sum_up(granny):
    """To the writhe of both strands, and per edge to what double quadrature gives."""
    seen = moment(granny, 30)
    assert seen.total_writhe == pytest.approx(writhe(seen.strands, False), rel=1e-10)
    mid = np.concatenate([0.5 * (x[1:] + x[:-1]) for x in seen.strands])
    e = np.concatenate([np.diff(x, axis=0) for x in seen.strands])
    r = mid[None] - mid[:, None]
    R = np.linalg.norm(r, axis=2) + np.eye(len(mid))
    pair = np.einsum("abc,ac->ab", np.cross(r, e[None]), e) / R**3
    expected = pair.sum(axis=1) / (4 * np.pi) / np.linalg.norm(e, axis=1)
    exact = np.concatenate(seen.writhe)
    assert np.abs(expected - exact).max() < 0.03 * np.abs(exact).max()
    reach = np.where(R < 2 * H, pair, 0.0).sum() / (4 * np.pi)
    assert seen.touching_writhe == pytest.approx(reach, abs=0.15)


def test_the_granny_obeys_the_law_in_what_touches(granny):
    found = balance(granny)
    assert found.writhe == 6
    assert found.explained > 0.95
    assert found.alignment > 0.95
    assert 0.8 < found.reduced_torque / found.touching_writhe < 1.0
    assert 0.2 < found.constant < 0.6
    np.testing.assert_allclose(found.strand_speed, found.speed, rtol=0.15)
    assert (found.start, found.end) == pytest.approx((0.3, 0.35))


def test_the_fitted_motion_accounts_for_the_torque(granny):
    """What is recorded is the law of drag on the recorded velocities; the fit's come close to it."""
    seen, c = moment(granny, 32), coefficients(granny)
    assert torque_of(seen, seen.velocities, c.eta_f_J) == pytest.approx(seen.total_torque, rel=1e-3)
    slides = [u * node_tangents(x) for u, x in zip(seen.fit.speed, seen.strands, strict=True)]
    assert torque_of(seen, slides, c.eta_f_J) == pytest.approx(seen.total_torque, rel=0.05)
    near, shortened = seen.factors
    law = np.pi * seen.fit.speed.mean() / c.h**2 * c.eta_f_J * seen.touching_writhe
    assert law * near * shortened == pytest.approx(seen.total_torque, rel=0.05)


def test_turning_a_strand_round_changes_no_density(granny):
    """Strands stored from their other end, with their grips renamed, are the same bend."""
    data = granny.dataset.isel(time=[0, 30])
    flipped = {}
    for name, dim in (("position", "node"), ("velocity", "node"), ("self_torque", "edge")):
        flipped[name] = data[name].isel({dim: slice(None, None, -1)})
    other = data.assign(flipped)
    other["self_torque"] = -other["self_torque"]
    cut = int(data.sizes["node"] - data["node_start"][1])
    other = other.assign(node_start=("fiber_bound", np.array([0, cut, data.sizes["node"]])))
    other = Result(other.assign_attrs(pulled="A0B0"))
    one, two = moment(granny, 30), moment(other, 1)
    assert two.total_torque == pytest.approx(one.total_torque, rel=1e-5)
    assert two.total_writhe == pytest.approx(one.total_writhe, rel=1e-5)
    np.testing.assert_allclose(two.torque[0], one.torque[1], rtol=1e-5, atol=1e-7)


def test_the_window_ends_at_slipping():
    class Stub(Result):
        slipped_at = 0.42
        last_held = 41

        def __init__(self):
            super().__init__(xarray.Dataset(coords={"time": np.linspace(0, 1, 101)}))

    found = window(Stub())
    assert (found[0], found[-1]) == (30, 42)
    assert window(Stub(), 0.5, 0.6).tolist() == [41]


def test_arrows_point_along_the_velocity(granny):
    found = flow(granny, 30)
    drawn = arrows(found, H)
    assert len(drawn) > 20
    for arrow in drawn:
        v = found.velocities[arrow.strand][arrow.node]
        assert np.asarray(arrow.vector) @ v == pytest.approx(2.5 * np.linalg.norm(v))


def test_figure_4_3_shows_a_velocity_that_turns_round(folder):
    """The trefoil gives in from both sides; the strands of the reef slide one way each."""
    assert draw("4-3", str(folder), "standard", True, False, "1", True) == 0
    with (folder / "figure-4-3.csv").open(encoding="utf-8") as file:
        rows = {(row["knot"], row["strand"]): row for row in csv.DictReader(file)}
    trefoil = rows["overhand", "A"]
    assert float(trefoil["least_v_m_per_s"]) < 0 < float(trefoil["greatest_v_m_per_s"])
    assert float(trefoil["reversed_at"]) == pytest.approx(0.5, abs=0.02)
    assert abs(float(trefoil["alignment"])) < 0.05
    assert float(rows["reef", "A"]["alignment"]) > 0.7
    assert (folder / "figure-4-3.png").stat().st_size > 50_000
    assert figure_4_3.FIGURE.number == "4-3"


def test_figure_4_4_tables(folder):
    choice = Choice(("standard",), quick=True)
    found = results(figure_4_4.runs(choice), folder / "runs", workers=1)
    tables = figure_4_4.measure(found, choice)
    assert tables[""].column("knot") == tables["bends"].column("knot") == list(bends.QUICK)
    assert tables["fits"].column("against") == ["Wr", "Wr3", "Wr3_touching", "twist_rad", "turned_rad"]
    expected = [ts.topology.state(bends.drawn(knot)).writhe for knot in bends.QUICK]
    assert tables[""].column("Wr") == expected
    path = folder / "figure-4-4.png"
    figure_4_4.FIGURE.draw(found, tables, choice, path)
    assert path.stat().st_size > 100_000
