"""What is recorded: every variable of a result with its dimensions, its SI unit and what it means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["BYTES_PER_NODE", "ENDS", "FORMAT", "SAMPLE", "SINGLE_PRECISION", "VARIABLES", "grown"]

FORMAT = 1
"""Of results, counted up whenever a reader of an earlier one would misunderstand it."""

ENDS = {"time": "done", "sample": "sampled"}
"""Dimensions along which a run grows, and the attributes that say how far it has."""

_CHARGE = "charge"
"""Dimension of what is recorded before t = 0, when a battery is charged."""

VARIABLES: Mapping[str, tuple[tuple[str, ...], str, str]] = {
    "time": (("time",), "s", "time"),
    "separation": (("time",), "m", "pulled end from clamped end, along the pull"),
    "sample_time": (("sample",), "s", "times between frames, for numbers that do not depend on frames"),
    "sample_separation": (("sample",), "m", "separation at the times of samples"),
    "pull_speed": (("time",), "m/s", "mean speed of parting since the frame before"),
    "compression": (("time",), "N", "sum over all edges of the contact forces on them"),
    "end_to_end": (("time",), "m", "distance of the two ends"),
    "length": (("time",), "m", "present length of the fiber"),
    "h_kappa_max": (("time",), "1", "largest curvature, times the radius"),
    "total_twist": (("time",), "rad", "twist of the fiber"),
    "max_log_strain": (("time",), "1", "largest log(1 + sqrt(eps:eps))"),
    "twist": (("time", "fiber"), "rad", "twist of each fiber"),
    "curvature": (("time", "node"), "1/m", "curvature of the centerline"),
    "displacement": (("time",), "m", "how far moved ends have gone"),
    "crossings": (("time",), "1", "crossings seen along z"),
    "energy_stretch": (("time",), "J", "stretch energy"),
    "energy_bend": (("time",), "J", "bending energy"),
    "energy_twist": (("time",), "J", "twist energy"),
    "energy_contact": (("time",), "J", "contact energy"),
    "external_work": (("time",), "J", "work done on the fibers since the start"),
    "dissipation": (("time",), "J", "energy lost to drag since the start"),
    "position": (("time", "node", "space"), "m", "node positions"),
    "log_strain": (("time", "node"), "1", "log(1 + sqrt(eps:eps)) on the surface"),
    "velocity": (("time", "node", "space"), "m/s", "node velocities; zero at the start"),
    "self_torque": (("time", "edge"), "N", "torque by collision drag per rest length, without own spin"),
    "rotation_rate": (("time",), "rad/s", "rate at which the knot turns about the pull"),
    "rotation": (("time",), "rad", "by how much the knot has turned about the pull"),
    "strain_stretch": (("time", "node"), "1", "stretch |x'| - 1"),
    "strain_bend": (("time", "node"), "1", "strain of bending on the surface, h kappa"),
    "strain_twist": (("time", "node"), "1", "strain of twist on the surface, h |theta'|/sqrt(2)"),
    "end_distance": (("time",), "m", "distance of the two ends of the rod"),
    "kappa_max": (("time",), "1/m", "largest curvature"),
    "energy_kinetic": (("time",), "J", "kinetic energy of the centerline"),
    "energy_spin": (("time",), "J", "kinetic energy of spin"),
    "energy_released": (("time",), "J", "energy lost in breaks since the start"),
    "piece_start": (
        ("time", "piece_bound"),
        "1",
        "first node of every piece; empty where pieces are not there",
    ),
    "twist_density": (("time", "node"), "rad/m", "twist density, 0 at ends"),
    "stress": (("time", "node"), "Pa", "stress by the criterion chosen, 0 at ends"),
    "angle": (("time",), "rad", "angle that the lower end has turned"),
    "sample_angle": (("sample",), "rad", "angle at the times of samples"),
    "writhe": (("time",), "1", "writhe of the centerline, in turns"),
    "average_crossings": (("time",), "1", "crossings in the mean over all directions of view"),
    "fewest_crossings": (("time",), "1", "crossings seen from where they are fewest"),
    "energy_density": (("time", "node"), "J/m", "stretch, bending and twist energy per rest length"),
    "sample_energy": (("sample",), "J", "stored energy at the times of samples"),
    "sample_dissipation": (("sample",), "J", "energy lost to drag until the times of samples"),
    "sample_fewest_crossings": (("sample",), "1", "fewest crossings at the times of samples"),
    "skin_position": (("time", "side", "space"), "m", "where the axis of each side of the skin is"),
    "gap": (("time",), "m", "gap of the wound"),
    "drawn": (("time",), "m", "how far the two ends have been drawn out, together"),
    "slip_speed": (("time",), "m/s", "mean speed at which the two ends are drawn out"),
    "energy_skin": (("time",), "J", "contact energy of fibers with the skin, and of its sides"),
    "energy_springs": (("time",), "J", "energy of the springs that hold the skin"),
    "spring_force": (("time", "side", "space"), "N", "force of the spring on each side of the skin"),
    "skin_force": (("time", "side", "space"), "N", "force of the fiber on each side of the skin"),
    "skin_pressing": (("time", "side"), "N", "sum of the normal forces on each side of the skin"),
    "skin_shearing": (("time", "side"), "N", "sum of the shear forces on each side of the skin, in size"),
    "skin_normal": (("time", "side", "edge"), "N/m", "force into the skin, per rest length of the fiber"),
    "skin_around": (("time", "side", "edge"), "N/m", "shear force on the skin around z, counterclockwise"),
    "skin_along": (("time", "side", "edge"), "N/m", "shear force on the skin along z"),
    "sample_gap": (("sample",), "m", "gap of the wound at the times of samples"),
    "sample_drawn": (("sample",), "m", "how far the ends have been drawn out, at the times of samples"),
    "sample_z_a": (("sample",), "m", "z-displacement of side a at the times of samples"),
    "sample_z_b": (("sample",), "m", "z-displacement of side b at the times of samples"),
    "sample_non_planarity": (("sample",), "1", "smallest over largest radius of gyration, at those times"),
    "sample_torsion": (("sample",), "1", "mean |torsion| where the fiber is bent, times the radius, then"),
    **{
        f"charge_{name}": ((_CHARGE, *more), unit, f"{meaning}, while the fiber was closed")
        for name, more, unit, meaning in (
            ("time", (), "s", "time since it was tied and twisted"),
            ("energy_stretch", (), "J", "stretch energy"),
            ("energy_bend", (), "J", "bending energy"),
            ("energy_twist", (), "J", "twist energy"),
            ("energy_contact", (), "J", "contact energy"),
            ("twist", (), "1", "twist, in turns"),
            ("writhe", (), "1", "writhe, in turns"),
            ("link", (), "1", "twist and writhe together, in turns"),
            ("position", ("closed_node", "space"), "m", "node positions"),
            ("energy_density", ("closed_node",), "J/m", "stretch, bending and twist energy per rest length"),
        )
    },
    "node_start": (("fiber_bound",), "1", "first node of every fiber, and the number of nodes"),
    "closed": (("fiber",), "1", "whether a fiber is closed"),
}
"""Dimensions, SI unit (1 where there is none) and meaning of every recorded variable."""

STRAINED = (
    "position",
    "log_strain",
    "strain_stretch",
    "strain_bend",
    "strain_twist",
    "velocity",
    "self_torque",
)
SKIN = ("skin_normal", "skin_around", "skin_along")
SINGLE_PRECISION = (*STRAINED, *SKIN, "twist_density", "stress", "energy_density")
"""Variables stored as 32-bit floats."""

BYTES_PER_NODE = sum(
    4 * (3 if "space" in VARIABLES[name][0] else 1) * (2 if "side" in VARIABLES[name][0] else 1)
    for name in (*STRAINED, *SKIN)
)
"""What a frame takes for every node, and the edge that comes with it: in no protocol more."""

SAMPLE = "sample_"
"""Beginning of the names of samples."""


def grown(dims: Sequence[str], attributes: Mapping[str, Any]) -> int | None:
    """How many rows there are of what has these dimensions; None where it does not grow."""
    count: int | None = attributes.get(ENDS.get(dims[0], "")) if dims else None
    return count
