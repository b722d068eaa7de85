"""No strand passes through another: distances, crossings in motion, and the run that stops."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rod.helpers import straight, toy_model
from torsade import segments
from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError
from torsade.motion import ends
from torsade.motion.guard import first_crossing, largest_move, passes_through, segment_distance
from torsade.motion.overdamped import Motion, Stepping


@settings(deadline=None, max_examples=300)
@given(st.integers(0, 10**6), st.sampled_from([1.0, 1e-3, 1e-6, 1e-9]), st.booleans())
def test_distance_is_the_one_of_segments(seed, off, lattice):
    """The kernel agrees with `torsade.segments`, near-parallel and degenerate positions included.

    Segments within 1e-6 of parallel count as parallel there, which may overrate their distance by as much of
    their length.
    """
    rng = np.random.default_rng(seed)
    p = rng.normal(size=(4, 3))
    if lattice:
        p = np.round(p)
        if np.array_equal(p[0], p[1]) or np.array_equal(p[2], p[3]):
            return
    else:
        p[3] = p[2] + (p[1] - p[0]) * rng.uniform(-2, 2) + off * rng.normal(size=3)
    expected = segments.segment_distance(*p)
    assert segment_distance(*p) == pytest.approx(expected, rel=1e-9, abs=1e-5 if off < 1e-3 else 1e-12)


def moving_pair(seed, speed):
    rng = np.random.default_rng(seed)
    x0 = rng.uniform(-1, 1, size=(4, 3))
    return x0, x0 + speed * rng.normal(size=(4, 3))


def share(x0, x1):
    """The bound on relative motion that `first_crossing` hands down."""
    d = x1 - x0
    return max(np.linalg.norm(d[i] - d[j]) for i in (0, 1) for j in (2, 3))


def said_to_cross(x0, x1):
    return passes_through(x0, x1, 0, 1, 2, 3, share(x0, x1))


def crosses(x0, x1):
    """Whether the two moving segments meet: real roots of the coplanarity cubic (Provot 1997)."""
    d = x1 - x0

    def triple(t):
        y = x0 + t * d
        return np.dot(np.cross(y[1] - y[0], y[3] - y[2]), y[2] - y[0])

    nodes = np.array([0, 1 / 3, 2 / 3, 1])
    roots = np.roots(np.polyfit(nodes, [triple(t) for t in nodes], 3))
    for t in roots[np.abs(roots.imag) < 1e-9].real:
        if 0 <= t <= 1:
            y = x0 + t * d
            if segments.segment_distance(*y) < 1e-7:
                return True
    return False


@settings(deadline=None, max_examples=400)
@given(st.integers(0, 10**7), st.sampled_from([0.03, 0.3, 2.0]))
def test_no_crossing_is_missed(seed, speed):
    """What the cubic says meets is said to cross; what stays well apart at 2000 times is not."""
    x0, x1 = moving_pair(seed, speed)
    verdict = said_to_cross(x0, x1)
    if crosses(x0, x1):
        assert verdict
    t = np.linspace(0, 1, 2001)[:, None, None]
    y = (1 - t) * x0 + t * x1
    nearest = segments.segment_distance(y[:, 0], y[:, 1], y[:, 2], y[:, 3]).min()
    if nearest > 2**-10 * share(x0, x1):
        assert not verdict


def test_crossings_are_among_the_random_motions():
    """The property above is not empty: many random motions cross and many do not."""
    verdicts = [crosses(*moving_pair(seed, 0.7)) for seed in range(300)]
    assert 30 < sum(verdicts) < 270


@settings(deadline=None, max_examples=300)
@given(st.integers(0, 10**7), st.sampled_from([0.1, 1.0]))
def test_agrees_with_another_library(seed, speed):
    """ipctk's continuous collision detection (Wang et al. 2021) never finds what the guard misses."""
    ipctk = pytest.importorskip("ipctk")
    x0, x1 = moving_pair(seed, speed)
    ccd = ipctk.TightInclusionCCD()
    hit, _ = ccd.edge_edge_ccd(x0[0], x0[1], x0[2], x0[3], x1[0], x1[1], x1[2], x1[3], 0.0, 1.0)
    if crosses(x0, x1) and hit:
        assert said_to_cross(x0, x1)
    if not said_to_cross(x0, x1):
        assert not hit


def test_common_motion_is_no_crossing():
    """Two near strands flying together do not meet, however far they fly."""
    x0 = np.array([[0, 0, 0], [1, 0, 0], [0.5, -0.5, 1e-3], [0.5, 0.5, 1e-3]], dtype=float)
    assert not said_to_cross(x0, x0 + np.array([100.0, 50.0, -70.0]))


@pytest.mark.parametrize("gap", [1e-3, 0.1, 1.0, 0.3])
@pytest.mark.parametrize("when", [0.5, 0.25, 0.375])
def test_meeting_head_on_at_the_end_of_an_interval(gap, when):
    """Strands that meet at exactly t = 1/2, 1/4 or 3/8: the bound is tight, round-off may not decide."""
    x0 = np.array([[0, 0, 0], [1, 0, 0], [0.5, -0.5, gap], [0.5, 0.5, gap]], dtype=float)
    x1 = x0.copy()
    x1[2:, 2] -= gap / when
    assert said_to_cross(x0, x1)


def test_first_crossing_finds_the_first_pair_of_the_list():
    """Of all listed pairs the first that crosses is named; -1 when none does."""
    strands = [
        straight(5, 4.0),
        straight(2, 1.0, 1, (1.5, -0.5, 0.1)),
        straight(2, 1.0, 1, (2.5, -0.5, 0.1)),
    ]
    a = assemble(strands)
    x0 = np.concatenate(strands)
    x1 = x0.copy()
    x1[5:, 2] -= 0.25
    pairs = np.array([(e, f) for e in range(4) for f in (4, 5)])
    mid = 0.5 * (x0[a.edges[:, 0]] + x0[a.edges[:, 1]])
    length = a.rest_length
    rows = np.arange(len(pairs))

    def first(rows, end):
        k = first_crossing(a, pairs, rows, len(rows), x0, end, length, mid, largest_move(x0, end))
        return tuple(pairs[k]) if k >= 0 else None

    assert first(rows, x1) == (1, 4)
    assert first(rows[::-1].copy(), x1) == (2, 5)
    assert first(rows, x0 + 1.0) is None
    assert largest_move(x0, x1) == pytest.approx(0.25)


def thrown(how, speed):
    """Two crossed strands, the lower one held and the upper one thrown down on it by both its ends."""
    h = 0.1
    lower, upper = straight(21, 2.0), straight(21, 2.0, 1, (1.03, -1.03, 2.5 * h))
    a = assemble([lower, upper])
    bc = ends.free(a)
    for fiber, v in ((0, np.zeros(3)), (1, np.array([0, 0, -speed]))):
        for end in (0, 1):
            bc = ends.move(bc, a, fiber, end, v)
    state = initial_state(a, [lower, upper])
    return Motion(a, toy_model(h), bc, state, how), state


def test_a_huge_fixed_step_is_refused_with_the_place():
    """Strands that would jump through each other stop the run; the sentence says where, the state stays."""
    motion, state = thrown(Stepping(fixed_step=1.0), 1.0)
    with pytest.raises(TorsadeError) as refusal:
        motion.advance(3.0)
    said = str(refusal.value)
    assert "edge 10 of strand 0" in said
    assert "of strand 1 (near 1030.00, " in said
    assert "would pass through" in said
    assert "shorter fixed step" in said
    assert said.count(".") >= 1
    assert np.array_equal(motion.state.x, state.x)
    assert motion.time == 0.0


def test_error_controlled_steps_do_not_jump():
    """The same throw with error control: the strands meet, press, and neither passes (DESIGN 6)."""
    motion, _ = thrown(Stepping(), 1.0)
    motion.advance(0.5)
    x = motion.state.x
    assert x[21:, 2].min() < x[:21, 2].max()
    assert motion.measure().compression > 0
    assert x[31, 2] > x[10, 2]


def driven_through(l, start, how, h=0.1):
    """Two strands of edges l, every node held; the upper one moves down at 1 m/s from the height given."""
    lower, upper = straight(5, 4 * l), straight(5, 4 * l, 1, (1.95 * l, -1.95 * l, start))
    a = assemble([lower, upper])
    bc = ends.free(a)
    bc.velocity[5:, 2] = -1.0
    bc = bc._replace(held=np.ones(10, bool))
    return Motion(a, toy_model(h), bc, initial_state(a, [lower, upper]), how)


@pytest.mark.parametrize("start", [0.05, 0.0437, 0.0371])
@pytest.mark.parametrize("l", [0.05, 0.1, 0.2])
def test_shrinking_steps_do_not_slip_through(l, start):
    """Strands driven through each other are stopped however short steps become near the meeting.

    Steps that shrink towards the meeting (Zeno) end where the distance is round-off: unless a least distance
    is kept, the next step of 1e-14 s passes unseen.
    """
    motion = driven_through(l, start, Stepping())
    with pytest.raises(TorsadeError, match="would pass through"):
        motion.advance(0.1)
    assert 0 < motion.state.x[5, 2] < 1e-6


@pytest.mark.parametrize("how", [Stepping(), Stepping(fixed_step=1e-2), Stepping(fixed_step=0.09)])
@pytest.mark.parametrize("radii", [3, 5, 8])
def test_long_edges_are_watched_too(radii, how):
    """Edges longer than the diameter meet while their midpoints are farther apart than any contact."""
    motion = driven_through(radii * 0.1, 0.05, how)
    with pytest.raises(TorsadeError, match="would pass through"):
        motion.advance(0.1)
    assert motion.state.x[5, 2] > 0


@pytest.mark.parametrize("exclusion", [1, 10])
@pytest.mark.parametrize("how", [Stepping(), Stepping(fixed_step=1e-2)])
def test_edges_without_contact_are_watched_too(exclusion, how):
    """A strand may not pass through itself, not even where neighbours along it feel no contact (DESIGN 6)."""
    l = 0.05
    across = [-0.5, 0.5, 1.5, 2.2, 2.2, 1.5, 0.5, 0, 0, 0, 0]
    along = [0, 0, 0.3, 1, 2, 2.7, 2.7, 2, 1.2, 0.55, -0.55]
    x = np.column_stack([l * np.array(across), l * np.array(along), [0.03, 0.03, 0.02, 0.01, *([0.0] * 7)]])
    a = assemble([x])
    bc = ends.free(a)
    bc.velocity[:2, 2] = -1.0
    bc = bc._replace(held=np.ones(len(x), bool))
    m = toy_model(0.1, exclusion_edges=exclusion, exclusion_length=0.0)
    motion = Motion(a, m, bc, initial_state(a, [x]), how)
    with pytest.raises(TorsadeError, match="would pass through"):
        motion.advance(0.06)
