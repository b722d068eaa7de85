"""What the protocols of overdamped fibers, pulled or moved, have in common: model and resolution."""

from __future__ import annotations

import dataclasses
import hashlib
from abc import abstractmethod
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import Field, model_validator

from torsade.errors import TorsadeError
from torsade.protocols.base import Driven, Positive, Trial
from torsade.units import Length, Number, Time, Viscosity, Whole

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.centerline import Centerline
    from torsade.motion.ends import Boundary
    from torsade.motion.moving import Outcome
    from torsade.motion.overdamped import Laws, Measured, Motion, Stepping

__all__ = ["PUBLISHED_STEP", "STANDARD_SPACING", "Experiment", "Pulled"]

STANDARD_SPACING = 0.5  # radii
"""Greatest distance between nodes in the standard preset."""

PUBLISHED_SPACING = 0.69  # radii
"""The same for built-in knots in the published preset: the mean edge of the published reef, thief, granny
and grief."""

LARGEST_STRAIN = 0.5
"""Strain F/EA beyond which neither linear elasticity nor a rest length means anything."""

PUBLISHED_STEP = 1e-4
"""Fixed time step of the published preset [s]."""

SETTLING = 10
"""Fixed steps for which strands that just met are advanced in error-controlled steps instead.

Where few contacts bear the whole load they give way within less than a fixed step. Doubling or tripling
this moves the separation of the built-in bends at 0.3 s by less than 1e-4 of itself.
"""

COMMON = (
    "time",
    "compression",
    "twist",
    "energy_stretch",
    "energy_bend",
    "energy_twist",
    "energy_contact",
    "external_work",
    "dissipation",
    "position",
    "log_strain",
    "velocity",
    "self_torque",
    "strain_stretch",
    "strain_bend",
    "strain_twist",
)
"""What every protocol that pulls records."""


class Experiment(NamedTuple):
    """A protocol at work on given fibers.

    Attributes
    ----------
    boundary : ends and loads
    measure : state → scalars of one frame, besides those that every protocol records
    derive : recorded histories (n_frames,) → further histories that follow from them
    conclude : samples, and the time [s] at which nothing resisted the load any more or None → numbers that
        belong to the run as a whole
    catch : called when nothing resists the load: move the state, in place, to where something does, and
        say whether there is such a place
    sampled : measures that `conclude` needs, recorded at times that do not depend on the number of frames
    about : attributes of the result, in words
    observe : state and what a motion measures on it → further scalars of one frame, named in `observed`
    over : asked whenever something is recorded after t = 0: whether there is nothing left to see
    later : ends and loads that take the place of those before at given times [s], in order of time
    """

    boundary: Boundary
    measure: Callable[[State], dict[str, float]] = lambda state: {}
    derive: Callable[[Mapping[str, Floats]], dict[str, Floats]] = lambda history: {}
    conclude: Callable[[Mapping[str, Floats], float | None], dict[str, float]] = lambda history, loose_at: {}
    catch: Callable[[State], bool] = lambda state: False
    sampled: tuple[str, ...] = ()
    about: Mapping[str, str] = MappingProxyType({})
    observe: Callable[[State, Measured], dict[str, float]] = lambda state, measured: {}
    observed: tuple[str, ...] = ()
    over: Callable[[State], bool] = lambda state: False
    later: tuple[tuple[float, Boundary], ...] = ()

    def boundary_at(self, time: float) -> Boundary:
        """Ends and loads from this time [s] on."""
        # A stop may lie the billionth part of a run before the time that it stands for.
        begun = [boundary for start, boundary in self.later if start <= time * (1 + 1e-8)]
        return begun[-1] if begun else self.boundary


class Pulled(Driven):
    """A specification of fibers in overdamped motion."""

    hints: ClassVar[Mapping[str, str]] = {
        **Driven.hints,
        "rho": "overdamped motion has no inertia, so there is no field 'rho'; leave it out",
        "seed": "nothing here is random, so there is no field 'seed'; leave it out",
        "time": "there is no field 'time'; did you mean 'duration'?",
        "file": "there is no field 'file'; did you mean 'centerline'?",
        "dt": "there is no field 'dt'; did you mean 'fixed_step'?",
    }

    eta: Annotated[Viscosity, Positive] | None = Field(
        None, description="Internal viscosity; by default the material's."
    )
    preset: Literal["standard", "published"] = Field(
        "standard",
        description="Model: standard (converging laws, resampled nodes, error-controlled steps) or "
        "published (the thesis's own program, on the nodes as given or as far apart as those published).",
    )
    duration: Annotated[Time, Positive] = Field(1.0, description="How long to pull.")
    spacing: Annotated[Length, Positive] | None = Field(
        None,
        description="Greatest distance between nodes; by default half a radius; when published, the nodes "
        "as given, or 0.69 radii for a built-in knot.",
    )
    tolerance: Annotated[Number, Positive] | None = Field(
        None,
        description="Error allowed per step, in radii and radians; by default the preset's.",
        examples=["1e-3"],
    )
    solver_tolerance: Annotated[Number, Positive] | None = Field(
        None,
        description="Relative error of the velocity solve; by default the preset's.",
        examples=["1e-5"],
    )
    fixed_step: Annotated[Time, Positive] | None = Field(
        None,
        description="Take explicit steps of this length instead of error-controlled ones.",
        examples=["1e-4 s"],
    )
    eta_f_ratio: Annotated[Number, Field(ge=0)] | None = Field(
        None,
        description="Collision viscosity over internal viscosity, eta_f/eta; by default the preset's.",
        examples=["3.3"],
    )
    area: Literal["product", "projected"] | None = Field(
        None, description="Contact area law, product or projected; by default the preset's."
    )
    drag: Literal["continuum", "node-pair"] | None = Field(
        None, description="Collision drag law, continuum or node-pair; by default the preset's."
    )
    exclusion_edges: Annotated[Whole, Field(ge=1, le=1_000_000)] | None = Field(
        None,
        description="No contact between edges at most so many apart along a fiber; by default the preset's.",
    )
    exclusion_radii: Annotated[Number, Field(ge=0)] | None = Field(
        None,
        description="No contact between edges nearer than so many radii along a fiber; by default the "
        "preset's.",
        examples=["3.14"],
    )

    @model_validator(mode="after")
    def _one_way_to_step(self) -> Pulled:
        if self.fixed_step is not None and self.tolerance is not None:
            raise TorsadeError(
                f"fixed_step ({self.fixed_step:g} s) and tolerance ({self.tolerance:g}) are both given; give "
                "fixed_step for steps of one length, or tolerance for error-controlled steps"
            )
        return self

    def check_strain(self, force: float) -> None:
        """Refuse a pull [N] under which the fiber is no longer elastic in any sense."""
        EA = self.fiber_material.E * self.section.A
        if force > LARGEST_STRAIN * EA:
            raise TorsadeError(
                f"a force of {force:.3g} N would stretch this fiber by F/EA = {force / EA:.3g}, and the "
                f"model holds for {LARGEST_STRAIN:g} at most; give a force of at most "
                f"{LARGEST_STRAIN * EA:.3g} N, or another material, E or radius"
            )

    @property
    def laws(self) -> Laws:
        """Contact and drag laws: the preset's, and what is given in their place."""
        from torsade.motion.overdamped import PUBLISHED, STANDARD

        names = ("eta_f_ratio", "area", "drag", "exclusion_edges", "exclusion_radii")
        given = {name: getattr(self, name) for name in names}
        base = PUBLISHED if self.preset == "published" else STANDARD
        return dataclasses.replace(base, **{k: v for k, v in given.items() if v is not None})

    @property
    def stepping(self) -> Stepping:
        """How time advances: a fixed step when published, unless a tolerance is given."""
        from torsade.motion.overdamped import Stepping

        how = Stepping(fixed_step=PUBLISHED_STEP if self.preset == "published" else 0.0)
        if self.tolerance is not None:
            how = dataclasses.replace(how, fixed_step=0.0, tolerance=self.tolerance)
        if self.fixed_step is not None:
            how = dataclasses.replace(how, fixed_step=self.fixed_step)
        if self.solver_tolerance is not None:
            how = dataclasses.replace(how, solver_tolerance=self.solver_tolerance)
        return how

    @property
    def node_spacing(self) -> float | None:
        """Greatest distance between nodes [m]; None where nodes are kept as they are given."""
        if self.spacing is not None:
            return self.spacing
        return (PUBLISHED_SPACING if self.preset == "published" else STANDARD_SPACING) * self.h

    @property
    def lasting(self) -> float:
        return self.duration

    def meaning(self) -> dict[str, Any]:
        laws, stepping, material = (
            dataclasses.asdict(part) for part in (self.laws, self.stepping, self.fiber_material)
        )
        del material["source"]
        return {
            "material": material,
            "radius": self.h,
            "laws": laws,
            "stepping": stepping,
            "spacing": self.node_spacing,
        }

    @property
    @abstractmethod
    def shape_name(self) -> str:
        """Name of what is moved, for tables and titles."""

    @abstractmethod
    def configuration(self) -> Centerline:
        """Strands at the start, checked, at the resolution of the run."""

    @abstractmethod
    def experiment(self, assembly: Assembly, state: State) -> Experiment:
        """What is done to the fibers, which start in this state, and what is measured on them."""

    def trial(self) -> Trial:
        import numpy as np

        from torsade.assembly import assemble, initial_state
        from torsade.motion.overdamped import Motion, model
        from torsade.protocols.shapes import check_frames

        shape = self.configuration()
        check_frames(self.frames + 1, sum(len(x) for x in shape.strands))
        assembly = assemble(shape.strands, shape.closed)
        state = initial_state(assembly, shape.strands)
        does = self.experiment(assembly, state)
        fiber = model(self.fiber_material, self.section, self.laws)
        motion = Motion(assembly, fiber, does.boundary, state, self.stepping)
        own = does.measure(state) | dict.fromkeys(does.observed, 0.0)
        first = {name: np.array([value]) for name, value in ({"time": 0.0} | own).items()}
        return Trial(
            motion,
            (*COMMON, *own),
            lambda: _frame(does, motion, self.h),
            does.conclude,
            sizes=sizes_of(assembly),
            fixed=fixed_of(assembly),
            start=hashlib.sha256(state.x.tobytes()).hexdigest(),
            derive=does.derive,
            derived=tuple(does.derive(first)),
            sampled=does.sampled,
            sample=lambda: {name: does.measure(motion.state)[name] for name in does.sampled},
            catch=lambda until: _catch(does, motion, until),
            about={"knot": self.shape_name, **does.about},
            over=lambda: does.over(motion.state),
            later=tuple(time for time, _ in does.later),
            begin=lambda time: _hold(motion, does.boundary_at(time)),
        )


def sizes_of(assembly: Assembly) -> dict[str, int]:
    """Sizes of the dimensions of what is recorded of fibers."""
    return {
        "fiber": len(assembly.closed),
        "node": len(assembly.node_length),
        "edge": len(assembly.edges),
    }


def fixed_of(assembly: Assembly) -> dict[str, tuple[str, NDArray[Any]]]:
    """Arrays of fibers that do not change, by name, each with its dimension."""
    return {
        "node_start": ("fiber_bound", assembly.node_start.copy()),
        "closed": ("fiber", assembly.closed.copy()),
    }


def _hold(motion: Motion, boundary: Boundary) -> None:
    motion.boundary = boundary


def _catch(experiment: Experiment, motion: Motion, until: float) -> Outcome | None:
    """Take up slack where nothing resists the load, and settle; None where nothing still can."""
    return _settle(motion, until) if experiment.catch(motion.state) else None


def _settle(motion: Motion, until: float) -> Outcome:
    """Let strands that just met settle: for `SETTLING` fixed steps the steps are error-controlled."""
    from torsade.motion.moving import Outcome

    control = motion.control
    if control.fixed_step == 0.0:
        return Outcome.PAUSED
    motion.control = control._replace(fixed_step=0.0)
    try:
        outcome = motion.advance(min(until, motion.time + SETTLING * control.fixed_step))
    finally:
        motion.control = control
    return outcome if motion.time >= until or outcome is Outcome.SLIPPED else Outcome.PAUSED


def _frame(experiment: Experiment, motion: Motion, radius: float) -> dict[str, float | Floats]:
    """Everything recorded at the present time."""
    now = motion.measure()
    common = frame_of_fibers(motion, motion.assembly, motion.state, now, radius)
    return common | experiment.measure(motion.state) | experiment.observe(motion.state, now)


def frame_of_fibers(
    motion: Motion, assembly: Assembly, state: State, now: Measured, radius: float
) -> dict[str, float | Floats]:
    """What every protocol that pulls records, named in `COMMON`; assembly and state are those of fibers."""
    from torsade import observables

    strain = observables.surface_strain(assembly, state, radius)
    return {
        "time": motion.time,
        "compression": now.compression,
        "twist": observables.twist(assembly, state),
        "energy_stretch": now.energies.stretch,
        "energy_bend": now.energies.bend,
        "energy_twist": now.energies.twist,
        "energy_contact": now.energies.contact,
        "external_work": motion.external_work,
        "dissipation": motion.dissipation,
        "position": state.x,
        "log_strain": strain.log,
        "strain_stretch": strain.stretch,
        "strain_bend": strain.bend,
        "strain_twist": strain.twist,
        "velocity": state.v,
        "self_torque": now.self_torque,
    }
