"""Charging: the states that twisted knots come to rest in, over noise, and with twist put in and taken out.

Writes its tables into docs/batteries.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks import common
from benchmarks.batteries import PAGE
from torsade.assembly import Assembly, State
from torsade.motion import ends
from torsade.motion.overdamped import Motion
from torsade.protocols.battery import Battery
from torsade.protocols.charging import charge
from torsade.sweep import Sweep

KNOTS = ("3_1", "4_1", "5_2", "7_4")
TWISTS = tuple(-4.0 + k for k in range(9))
SEEDS = 5
ALIKE = 2e-3
"""States whose energies differ by no more than this share are one."""

RAMPED = ("3_1", "4_1")
FARTHEST, STEP = 3.0, 0.25
"""Twist densities h theta' that a knot is ramped to and back from, both ways."""

QUICK: Mapping[str, Any] = {"charging": "0.3 s", "nodes": 60}

Found = dict[str, Any]


class Rest(NamedTuple):
    """A charged fiber: twist density that it was given, energy [E_0] and writhe."""

    twist: float
    energy: float
    writhe: float


def states(
    knots: Sequence[str], twists: Sequence[float], seeds: int, short: Mapping[str, Any]
) -> list[Found]:
    """Of every knot and twist: how many states there are over the noise, their energies and writhes."""
    sweep = Sweep(
        "battery",
        fixed={"stop": "charged", **short},
        grid={"knot": list(knots), "twist": list(twists), "seed": list(range(seeds))},
    )
    with tempfile.TemporaryDirectory() as folder:
        rows = sweep.run(Path(folder) / "charged", workers=2).query(
            "SELECT knot, twist, list(energy_E0_total ORDER BY energy_E0_total), "
            "list(writhe ORDER BY energy_E0_total) FROM runs WHERE status = 'done' GROUP BY ALL ORDER BY ALL"
        )
    return [_states(*row) for row in rows.rows]


def _states(knot: str, twist: float, energies: Sequence[float], writhes: Sequence[float]) -> Found:
    firsts = [0]
    for k in range(1, len(energies)):
        if energies[k] > (1 + ALIKE) * energies[firsts[-1]]:
            firsts.append(k)
    counts = np.diff([*firsts, len(energies)]).tolist()
    kept = {"energy_E0": [energies[k] for k in firsts], "writhe": [writhes[k] for k in firsts]}
    return {"knot": knot, "twist": twist, "runs": counts, **kept}


def more(a: Assembly, state: State, density: float) -> State:
    """The same fiber with more twist [rad/m], evenly: its ends are parted, turned, and fused again."""
    seam = int(a.hinge_start[0])
    before, after, _ = a.hinges[seam]
    own = a.hinge_length[seam + 1 : int(a.hinge_start[1])]
    turned = density * np.concatenate([[0.0], np.cumsum(own)])
    reference_twist = state.reference_twist.copy()
    reference_twist[seam] += density * a.hinge_length[seam] - turned[after] + turned[before]
    return state._replace(theta=state.theta + turned, reference_twist=reference_twist)


def ramp(knot: str, farthest: float, step: float, short: Mapping[str, Any]) -> list[Rest]:
    """A knot at rest at twists from 0 to farthest and back, each from the one before."""
    spec = Battery(knot=knot, stop="charged", **short)
    motion, _ = spec.charged()
    rests = [_rest(0.0, motion, spec)]
    count = round(abs(farthest) / step)
    side = math.copysign(step, farthest)
    for k in [*range(1, count + 1), *range(count - 1, -1, -1)]:
        twist = k * side
        state = more(motion.assembly, motion.state, (twist - rests[-1].twist) / spec.h)
        motion = Motion(motion.assembly, spec.model(), ends.free(motion.assembly), state, spec.stepping)
        longest = 100 * spec.unit_time if spec.charging is None else spec.charging
        charge(motion, spec.fiber_material, spec.section, spec.unit_time, longest, lambda share, note: None)
        rests.append(_rest(twist, motion, spec))
    return rests


def _rest(twist: float, motion: Motion, spec: Battery) -> Rest:
    from torsade.topology.measures import writhe

    return Rest(twist, motion.energies().total / spec.unit_energy, writhe(motion.state.x, True))


def states_table(rows: Sequence[Found]) -> str:
    cells = []
    for row in rows:
        energies = ", ".join(f"{e:.4g}" for e in row["energy_E0"])
        writhes = ", ".join(f"{w:.3g}" for w in row["writhe"])
        cells.append([row["knot"], f"{row['twist']:+g}", ", ".join(map(str, row["runs"])), energies, writhes])
    return common.table(["knot", "h θ′", "runs that came to each state", "energies [E_0]", "Wr"], cells)


def mirror_table(rows: Sequence[Found]) -> str:
    """The lowest state at either twist side by side: whether the knot tells them apart."""
    found = {(row["knot"], row["twist"]): row for row in rows}
    cells = []
    for (knot, twist), right in found.items():
        if twist > 0 and (knot, -twist) in found:
            left = found[knot, -twist]
            energies = [one["energy_E0"][0] for one in (right, left)]
            writhes = [one["writhe"][0] for one in (right, left)]
            apart = 100 * abs(energies[0] - energies[1]) / min(energies)
            cells.append([knot, f"±{twist:g}", *energies, f"{apart:.2f}", *writhes, sum(writhes)])
    heads = ["knot", "h θ′", "energy [E_0], +", "energy, −", "apart, %", "Wr, +", "Wr, −", "sum of Wr"]
    return common.table(heads, cells)


def ramp_table(ramps: Mapping[str, Sequence[Rest]]) -> str:
    """Energy and writhe on the way up and on the way down, where they differ by more than `ALIKE`."""
    cells = []
    for name, rests in ramps.items():
        count = len(rests) // 2
        for k in range(count + 1):
            up, down = rests[k], rests[-1 - k]
            if abs(up.energy - down.energy) > ALIKE * up.energy:
                cells.append([name, f"{up.twist:+g}", up.energy, down.energy, up.writhe, down.writhe])
    heads = ["knot", "h θ′", "energy [E_0], up", "energy, down", "Wr, up", "Wr, down"]
    return common.table(heads, cells or [["none", *["-"] * 5]])


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    parser = common.parser(__doc__)
    parser.add_argument("--no-write", action="store_true", help=f"leave {PAGE.name} as it is")
    options = parser.parse_args(arguments)
    short = QUICK if options.quick else {}
    knots, twists = (KNOTS[:1], (-2.0, 2.0)) if options.quick else (KNOTS, TWISTS)
    found = states(knots, twists, 2 if options.quick else SEEDS, short)
    ways = [(RAMPED[0], 0.5)] if options.quick else [(k, s * FARTHEST) for k in RAMPED for s in (1, -1)]
    ramps = {f"{knot}, to {far:+g}": ramp(knot, far, STEP, short) for knot, far in ways}
    tables = {
        "charging-states": states_table(found),
        "charging-mirror": mirror_table(found),
        "charging-ramp": ramp_table(ramps),
    }
    if not (options.no_write or options.quick):
        for name, text in tables.items():
            common.put(text, PAGE, name)
    return common.show({"states": found, "ramps": ramps}, list(tables.values()), options.json)


if __name__ == "__main__":
    main()
