"""A trefoil in one strand, pulled by both ends to equilibrium: torsade beside PyElastica, in one run.

Both start from the same nodes, of the same straight, elastic rod, with the same force on its ends, and end at
the same shape, which says that they solve the same problem. On the way torsade's rod is overdamped, with
error-controlled steps of several evaluations of the forces; PyElastica's is a Cosserat rod with inertia,
with its largest stable step and damping near the critical damping of its slowest mode, which brings it to
rest soonest. A run is over when the distance of the ends has come to its last value within 0.1 %.

A step is compared on the tightened shape, one curve with more and more edges: one evaluation of all forces
for both, explicit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks import common
from torsade.arrays import Floats
from torsade.assembly import assemble, initial_state
from torsade.curve import resample
from torsade.knots.tied import strand
from torsade.material import Material, Section
from torsade.motion import ends
from torsade.motion.overdamped import Motion, Stepping, model

ABSENT = "PyElastica is not installed, so there is nothing to compare with; pip install pyelastica==1.0.0."

PAGE = Path(__file__).parents[2] / "docs" / "performance.md"

H = 0.01
"""Radius [m]."""

RUBBER = Material("rubber", E=1e6, E_b=1e6, nu=0.3, rho=1000.0, eta=1e4)

FRACTION = 0.8
"""The peer's step, in edge lengths over the speed of stretch waves; at 0.95 its rod flies apart."""

PULL = 0.02
"""Force on each end [B/h^2]; it stretches the rod by half a per cent."""

AT_REST = 800.0
"""When torsade's knot is at rest [s]: its speed has fallen by ten powers of ten."""

STEP_HEADS = ("edges", "contacts", "torsade [ns/node-step]", "PyElastica [ns/node-step]", "ratio")
REST_HEADS = (
    "edges", "torsade [s]", "steps", "PyElastica [s]", "steps", "ratio", "ends apart [radii]", "PyElastica's",
)  # fmt: skip

NEAR = 1e-3
"""How near the distance of the ends is to its last value when the rod has arrived, as a share of it."""


class Way(NamedTuple):
    """How a rod came to rest: a clock, its own or the processor's [s], distance of the ends [m], steps."""

    clock: Floats
    distance: Floats
    steps: Floats

    def arrival(self) -> int:
        """The first look from which on the distance of the ends stays near the last one."""
        off = np.abs(self.distance / self.distance[-1] - 1) > NEAR
        return int(np.flatnonzero(off)[-1]) + 1 if off.any() else 0


def trefoil(edges: int) -> Floats:
    """Nodes of a loose overhand knot (edges + 1, 3) [m], evenly spaced along it."""
    x = strand("overhand", H).strands[0]
    return resample(x, n=edges + 1)


def force() -> float:
    """Force on each end [N]."""
    section = Section(H)
    return PULL * RUBBER.E_b * section.I / H**2


def outward(x: Floats) -> float:
    """The direction along x in which the last end is pulled."""
    return 1.0 if x[-1, 0] >= x[0, 0] else -1.0


def distance(x: Floats) -> float:
    """Distance of the ends [m]."""
    return float(np.linalg.norm(x[-1] - x[0]))


def ours(x: Floats, how: Stepping | None = None) -> Motion:
    """The knot in torsade, pulled, at t = 0."""
    a = assemble([x])
    along = np.array([outward(x) * force(), 0.0, 0.0])
    boundary = ends.pull(ends.pull(ends.free(a), a, 0, 0, -along), a, 0, 1, along)
    motion = Motion(a, model(RUBBER, Section(H)), boundary, initial_state(a, [x]), how)
    motion.warm_up()
    return motion


def ours_to_rest(motion: Motion, until: float, steps: int = 5) -> Way:
    """The way of torsade's knot to rest by its own time, looked at after every so many steps."""
    rows = []
    while motion.time < until:
        motion.advance(until, steps)
        rows.append((motion.time, distance(motion.state.x), motion.steps))
    return Way(*np.array(rows).T)


def ours_until(x: Floats, until: float, repeats: int) -> tuple[float, int]:
    """Median processor time [s] of moving the knot to a time [s] without looking, and the steps it takes."""
    motion = ours(x)
    start = motion.checkpoint()

    def run() -> None:
        motion.restore(start)
        motion.advance(until)

    return common.seconds(run, repeats), motion.steps


class Theirs:
    """The knot in PyElastica, pulled."""

    def __init__(self, x: Floats) -> None:
        import elastica as ea

        class Knot(ea.BaseSystemCollection, ea.Forcing, ea.Contact, ea.Damping):  # type: ignore[misc]
            pass

        a = assemble([x])
        edge = np.diff(x, axis=0)
        length = np.linalg.norm(edge, axis=1)
        t = edge / length[:, None]
        d = initial_state(a, [x]).director
        directors = np.moveaxis(np.stack([d, np.cross(t, d), t], axis=0), 1, 2)
        self.rod = ea.CosseratRod.straight_rod(
            len(edge), x[0], t[0], d[0], float(length.sum()), H, RUBBER.rho, youngs_modulus=RUBBER.E,
            shear_modulus=RUBBER.mu, position=x.T.copy(), directors=directors.copy(),
        )  # fmt: skip
        speed = math.sqrt(RUBBER.E / RUBBER.rho)
        self.dt = FRACTION * float(length.min()) / speed
        along = np.array([outward(x) * force(), 0.0, 0.0])
        slowest = math.pi / float(length.sum()) * math.sqrt(force() / (RUBBER.rho * math.pi * H**2))
        self.system = Knot()
        self.system.append(self.rod)
        self.system.add_forcing_to(self.rod).using(ea.EndpointForces, -along, along, ramp_up_time=1e-9)
        self.system.detect_contact_between(self.rod, self.rod).using(
            ea.RodSelfContact, k=0.1 * RUBBER.E * H, nu=0.0
        )
        self.system.dampen(self.rod).using(
            ea.AnalyticalLinearDamper, uniform_damping_constant=2 * slowest, time_step=self.dt
        )
        self.system.finalize()
        self.stepper = ea.PositionVerlet()
        self.period = 2 * math.pi / slowest
        self.now, self.steps = 0.0, 0

    def advance(self, steps: int) -> None:
        """Take steps."""
        for _ in range(steps):
            self.now = self.stepper.step(self.system, self.now, self.dt)
        self.steps += steps
        if not np.isfinite(self.rod.position_collection).all():
            raise FloatingPointError("the peer's rod has left the range of numbers; its time means nothing")

    @property
    def x(self) -> Floats:
        """Nodes (n, 3) [m]."""
        return self.rod.position_collection.T.copy()


def theirs_to_rest(peer: Theirs, until: float, looks: int) -> Way:
    """The way of PyElastica's knot to rest by the processor's clock."""
    began, rows = common.CLOCK(), []
    each = max(1, round(until / peer.dt / looks))
    for _ in range(looks):
        peer.advance(each)
        rows.append((common.CLOCK() - began, distance(peer.x), peer.steps))
    return Way(*np.array(rows).T)


def equilibrium(edges: int, periods: float, looks: int) -> dict[str, Any]:
    """Processor times until the knot has come to rest, and how far the two shapes differ."""
    x = trefoil(edges)
    Theirs(x).advance(1)  # compiles
    peer = Theirs(x)
    theirs = theirs_to_rest(peer, periods * peer.period, looks)
    mine = ours_to_rest(ours(x), min(1.0, periods) * AT_REST)
    taken, steps = ours_until(x, float(mine.clock[mine.arrival()]), 3)
    theirs_at = theirs.arrival()
    return {
        "edges": edges,
        "torsade_s": taken,
        "torsade_steps": steps,
        "pyelastica_s": float(theirs.clock[theirs_at]),
        "pyelastica_steps": int(theirs.steps[theirs_at]),
        "ratio": float(theirs.clock[theirs_at] / taken),
        "ends_apart_radii": float(mine.distance[-1] / H),
        "pyelastica_ends_apart_radii": float(theirs.distance[-1] / H),
    }


def tightened(edges: int, rest: float) -> Floats:
    """Nodes of the knot pulled for a time [s] (edges + 1, 3) [m]."""
    motion = ours(trefoil(edges))
    motion.advance(rest)
    return motion.state.x.copy()


def step(curve: Floats, edges: int, steps: int, repeats: int) -> dict[str, Any]:
    """Time of an explicit step of both, one evaluation of all forces; so many edges on a curve (n, 3)."""
    x = resample(curve, n=edges + 1)
    motion = ours(x, Stepping(fixed_step=1e-6))
    start = motion.checkpoint()

    def run() -> None:
        motion.restore(start)
        motion.advance(1.0, steps)

    mine = common.seconds(run, repeats) / steps
    peer = Theirs(x)
    their_steps = max(1, steps * 2500 // edges**2)
    theirs = common.seconds(lambda: peer.advance(their_steps), repeats) / their_steps
    per_node = 1e9 / len(x)
    return {
        "edges": edges,
        "contacts": len(motion.measure().contacts),
        "torsade_ns_per_node_step": per_node * mine,
        "pyelastica_ns_per_node_step": per_node * theirs,
        "ratio": theirs / mine,
    }


def _installed() -> bool:
    try:
        import elastica  # noqa: F401
    except ImportError:
        return False
    return True


def main(
    arguments: Sequence[str] | None = None, installed: Callable[[], bool] = _installed
) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    given = options.parse_args(arguments)
    if not installed():
        return common.show({"skipped": ABSENT}, [ABSENT], given.json)
    if given.quick:
        steps = [step(trefoil(50), 50, 5, 1)]
        rests = [equilibrium(50, 0.01, 5)]
    else:
        tight = tightened(200, AT_REST)
        steps = [step(tight, n, 2000, 5) for n in (100, 200, 400, 800, 1600)]
        rests = [equilibrium(n, 1.2, 480) for n in (100, 200, 400)]
    of_steps = common.table(STEP_HEADS, [list(r.values()) for r in steps])
    of_rests = common.table(REST_HEADS, [list(r.values()) for r in rests])
    if given.write:
        common.put(of_steps, PAGE, "peer-steps")
        common.put(of_rests, PAGE, "peer-rest")
    return common.show({"steps": steps, "equilibrium": rests}, [of_steps, of_rests], given.json)


if __name__ == "__main__":
    main()
