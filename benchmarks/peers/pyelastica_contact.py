"""A coiled rod in contact with itself: torsade beside PyElastica, in one run.

Both take explicit steps of one evaluation of all forces: torsade Euler steps of overdamped motion, each
with a linear solve, PyElastica position Verlet steps of a Cosserat rod with inertia. Both run as their
users run them. Time per step says nothing about how long a step may be.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from benchmarks import common
from torsade.assembly import assemble, initial_state
from torsade.motion import ends
from torsade.motion.overdamped import Motion, Stepping, model

ABSENT = "PyElastica is not installed, so there is nothing to compare with; pip install pyelastica==1.0.0."


def coil(edges: int) -> np.ndarray:
    """Nodes of a helix [m] whose turns, 1.96 radii apart, touch; half a radius between nodes."""
    h = common.NYLON.radius
    rise, off_axis = 1.96 * h / (2 * math.pi), 4 * h
    turn = 0.5 * h / math.hypot(rise, off_axis) * np.arange(edges + 1)
    return np.column_stack([off_axis * np.cos(turn), off_axis * np.sin(turn), rise * turn])


def ours(x: np.ndarray, steps: int, repeats: int) -> tuple[float, int]:
    """Time [s] of a step of torsade with the standard laws, and the number of contacts."""
    a = assemble([x])
    boundary = ends.clamp(ends.free(a), a, 0, 0)
    boundary = ends.move(boundary, a, 0, 1, np.array([0.0, 0.0, 1e-3]))
    nylon = model(common.NYLON.material, common.NYLON.section)
    motion = Motion(a, nylon, boundary, initial_state(a, [x]), Stepping(fixed_step=1e-7))
    start = motion.checkpoint()

    def run() -> None:
        motion.restore(start)
        motion.advance(1.0, steps)

    taken = common.seconds(run, repeats) / steps
    return taken, len(motion.measure().contacts)


def theirs(x: np.ndarray, steps: int, repeats: int) -> float:
    """Time [s] of a step of PyElastica: a Cosserat rod with self-contact, one end fixed."""
    import elastica as ea

    class Coil(ea.BaseSystemCollection, ea.Constraints, ea.Contact):  # type: ignore[misc]
        pass

    h, nylon = common.NYLON.radius, common.NYLON.material
    edge = np.diff(x, axis=0)
    t = edge / np.linalg.norm(edge, axis=1)[:, None]
    across = np.cross(t, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across, axis=1)[:, None]
    directors = np.moveaxis(np.stack([across, np.cross(t, across), t], axis=0), 1, 2)
    rod = ea.CosseratRod.straight_rod(
        len(edge), x[0], t[0], across[0], float(np.linalg.norm(edge, axis=1).sum()), h, nylon.rho,
        youngs_modulus=nylon.E, position=x.T.copy(), directors=directors.copy(),
    )  # fmt: skip
    system = Coil()
    system.append(rod)
    system.constrain(rod).using(
        ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    system.detect_contact_between(rod, rod).using(ea.RodSelfContact, k=1e3, nu=1e-3)
    system.finalize()
    stepper, dt = ea.PositionVerlet(), 1e-10
    clock = [0.0]

    def run() -> None:
        now = clock[0]
        for _ in range(steps):
            now = stepper.step(system, now, dt)
        clock[0] = now

    taken = common.seconds(run, repeats) / steps
    if not np.isfinite(rod.position_collection).all():
        raise FloatingPointError("the peer's rod has left the range of numbers; its time means nothing")
    return taken


def _installed() -> bool:
    try:
        import elastica  # noqa: F401
    except ImportError:
        return False
    return True


def main(
    arguments: Sequence[str] | None = None, installed: Callable[[], bool] = _installed
) -> dict[str, Any]:
    given = common.parser(__doc__).parse_args(arguments)
    if not installed():
        return common.show({"skipped": ABSENT}, [ABSENT], given.json)
    steps, repeats = (5, 1) if given.quick else (1000, 9)
    rows = []
    for edges in (100,) if given.quick else (100, 400):
        x = coil(edges)
        mine, contacts = ours(x, steps, repeats)
        peer = theirs(x, steps if given.quick else steps // 2, repeats)
        per_node = 1e9 / len(x)
        rows.append(
            {
                "edges": edges,
                "contacts": contacts,
                "torsade_ns_per_node_step": per_node * mine,
                "pyelastica_ns_per_node_step": per_node * peer,
                "ratio": peer / mine,
            }
        )
    heads = ("edges", "contacts", "torsade [ns/node-step]", "PyElastica [ns/node-step]", "ratio")
    return common.show({"rows": rows}, [common.table(heads, [list(r.values()) for r in rows])], given.json)


if __name__ == "__main__":
    main()
