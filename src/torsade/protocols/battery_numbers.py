"""Numbers of a battery: what is concluded when it is empty, and what is reported of a result."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from torsade.arrays import Floats
from torsade.knots.finding import interpret
from torsade.protocols.battery import KINDS, SHARES
from torsade.protocols.charging import Charge
from torsade.protocols.discharge import Discharge, crossing_losses, discharge_times, mean_on_the_way
from torsade.results import Result
from torsade.topology.identify import identify
from torsade.units import rounded

__all__ = ["Units", "concluded", "reported"]

ON_THE_WAY = (0.5, 0.01)
"""Shares of the energy between which shapes are intermediate."""


class Units(NamedTuple):
    """T_0 [s] and E_0 [J]."""

    time: float
    energy: float


def concluded(
    units: Units,
    knot: str,
    samples: Mapping[str, Floats],
    charge: Charge,
    at_cut: Mapping[str, float],
    cut: Discharge,
) -> dict[str, Any]:
    """Numbers and lists that belong to a run as a whole.

    Parameters
    ----------
    units : of time and energy
    knot : that was asked for
    samples : histories by name, shapes (n_samples,); where nothing is cut, one sample
    charge : how it was charged
    at_cut : place of the cut, as a share of the length; steps before it; and energies by kind [J], of the
        fiber while it is still closed
    cut : the fiber after the cut
    """
    unit, history, energy = units.time, charge.history, samples["energy"]
    shares = discharge_times(samples["time"], energy, [share / 100 for share in SHARES])
    lost = crossing_losses(samples["time"], samples["fewest_crossings"])
    cut_energies = {kind: at_cut[kind] / units.energy for kind in KINDS}
    total = sum(cut_energies.values())
    asked = str(identify(interpret(knot).diagram))
    return {
        "T0_s": unit,
        "E0_J": units.energy,
        **{name: float(history[name][-1]) for name in ("link", "twist", "writhe")},
        "link_error": float(np.abs(history["link"] - history["link"][0]).max()),
        "charge_knots": list(charge.knots),
        "knot_kept": all(name == asked for name in charge.knots),
        "charge_steps": int(at_cut["steps"]),
        "charged_in_T0": float(history["time"][-1]) / unit,
        "loss_per_T0": charge.loss,
        "energy_E0": cut_energies | {"total": total},
        "energy_final_E0": float(energy[-1]) / units.energy if len(energy) > 1 else total,
        "cut_at": rounded(at_cut["place"]),
        "discharge_time_T0": {
            str(share): None if t is None else t / unit for share, t in zip(SHARES, shares, strict=True)
        },
        "crossings_lost_T0": [t / unit for t in lost],
        "non_planarity": {
            "charged": float(samples["non_planarity"][0]),
            "on_the_way": mean_on_the_way(energy, samples["non_planarity"], ON_THE_WAY),
        },
        "torsion": {
            "charged": float(samples["torsion"][0]),
            "on_the_way": mean_on_the_way(energy, samples["torsion"], ON_THE_WAY),
        },
        "frame_knots": [name for _, name in cut.knots],
        "power_E0_per_T0": _power(samples) * unit / units.energy,
        "balance_error": float(
            abs(energy[0] - energy[-1] - samples["dissipation"][-1]) / max(energy[0], 1e-300)
        ),
    }


REPORTED = (
    *("link", "twist", "writhe", "link_error", "knot_kept", "energy_E0", "energy_final_E0", "cut_at"),
    *("discharge_time_T0", "crossings_lost_T0", "non_planarity", "torsion", "power_E0_per_T0"),
    *("balance_error", "T0_s", "E0_J", "charged_in_T0", "loss_per_T0"),
)
"""Attributes of a result that are reported as they are."""


def reported(result: Result) -> dict[str, Any]:
    """The numbers of a result under the keys of `--json`."""
    attrs = result.dataset.attrs
    names = attrs["frame_knots"]
    runs = [k for k, name in enumerate(names) if k == 0 or name != names[k - 1]]
    times = result.dataset["time"].values / attrs["T0_s"]
    return {
        "protocol": "battery",
        "knot": attrs["knot"],
        "twist_density": result.spec["twist"],
        **{name: attrs[name] for name in REPORTED},
        "intermediate_knots": list(dict.fromkeys(n for n in names if n not in (names[0], names[-1]))),
        "knots": [{"knot": names[k], "from_T0": float(times[k])} for k in runs],
        "charge_steps": attrs["charge_steps"],
        "steps": attrs["steps"],
        "wall_s": attrs["wall_s"],
    }


def _power(samples: Mapping[str, Floats]) -> float:
    """The greatest power between samples [W]."""
    if len(samples["time"]) < 2:
        return 0.0
    return float((-np.diff(samples["energy"]) / np.diff(samples["time"])).max())
