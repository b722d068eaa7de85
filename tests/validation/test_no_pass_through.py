"""No strand passes through another in any run: another library looks at every stored step of every bend, of
the knots of figure 4-2 pulled to rest and of its Reidemeister moves.

ipctk's continuous collision detection (Wang et al. 2021) follows all pairs of edges from each stored frame to
the next, nodes moving in straight lines.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import torsade as ts
from torsade.figures import move_energies, twist_share
from torsade.figures.base import Choice
from torsade.knots.bends import bends

ipctk = pytest.importorskip("ipctk")

FURTHER = ("water_knot", "figure_eight_bend", "fisherman", "double_fisherman", "zeppelin_min10")
KNOTS = (*ts.knots.variants(), *FURTHER)


def steps_that_cross(position, node_start):
    """Steps, numbered by the frame they begin at, in which edges pass through each other.

    position (n_frames, n_nodes, 3) of open strands that begin at node_start.
    """
    pieces = pairwise(node_start)
    edges = np.concatenate([np.column_stack([np.arange(a, b - 1), np.arange(a + 1, b)]) for a, b in pieces])
    x = [np.asfortranarray(frame, dtype=np.float64) for frame in position]
    mesh = ipctk.CollisionMesh(x[0], np.asfortranarray(edges.astype(np.int32)), np.zeros((0, 3), np.int32))
    return [k for k in range(len(x) - 1) if not ipctk.is_step_collision_free(mesh, x[k], x[k + 1])]


def test_all_bends_are_looked_at():
    assert len(set(KNOTS)) == 27
    assert set(FURTHER) < set(bends())


@pytest.mark.slow
@pytest.mark.parametrize("preset", ["standard", "published"])
@pytest.mark.parametrize("knot", KNOTS)
def test_no_strand_passes_through_another(knot, preset):
    data = ts.protocols.PrisonEscape(knot=knot, preset=preset, frames=200).run().dataset
    x = data["position"].values
    assert len(x) > 50
    assert float(np.linalg.norm(x[-1] - x[0], axis=1).max()) > 2e-3  # ten radii
    assert steps_that_cross(x, data["node_start"].values) == []


KNOTS_PULLED = twist_share.runs(Choice())
MOVES = move_energies.runs(Choice())


@pytest.mark.slow
@pytest.mark.parametrize("label", [*KNOTS_PULLED, *MOVES])
def test_nor_in_the_runs_of_figure_4_2(label):
    """As they stand in the figure: knots until they are still, moves in ten minutes."""
    data = {**KNOTS_PULLED, **MOVES}[label].run().dataset
    x = data["position"].values
    assert len(x) > 90
    assert float(np.linalg.norm(x[-1] - x[0], axis=1).max()) > 1e-3  # five radii
    if label in KNOTS_PULLED:
        assert data.attrs["over_at_s"] > 1
    else:
        before, after = data["crossings"].values[[0, -1]]
        assert after - before == {"R1": -1, "R2": 2, "R3": 0}[label.split()[1].rstrip(",")]
    assert steps_that_cross(x, data["node_start"].values) == []


def test_a_strand_that_passes_is_seen():
    """Two strands laid across each other, the upper one put below in the second of three steps."""
    line = np.linspace(-1, 1, 21)
    lower, upper = (
        np.column_stack([line, 0 * line, 0 * line]),
        np.column_stack([0 * line + 0.02, line, 0 * line]),
    )
    frames = np.array([np.concatenate([lower, upper + np.array([0, 0, z])]) for z in (0.2, 0.1, -0.1, -0.2)])
    assert steps_that_cross(frames, np.array([0, 21, 42])) == [1]
