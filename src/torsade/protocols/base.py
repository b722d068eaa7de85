"""What every protocol's specification has in common: fiber, model, resolution, and its messages.

A specification says what to do and nothing about how: it is frozen, holds SI numbers only, and is
written into every result. Nothing heavy is imported until it runs, so that help texts come at once.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from torsade.errors import QuantityError, TorsadeError
from torsade.material import Material, Section
from torsade.material import preset as material_preset
from torsade.protocols.sentences import sentence
from torsade.units import Length, Number, Pressure, Time, Viscosity

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.centerline import Centerline
    from torsade.motion.ends import Boundary
    from torsade.motion.overdamped import Laws, Measured, Stepping
    from torsade.results import Result

__all__ = ["STANDARD_SPACING", "Experiment", "Progress", "Spec"]

STANDARD_SPACING = 0.5  # radii
"""Greatest distance between nodes in the standard preset."""

PUBLISHED_SPACING = 0.69  # radii
"""The same for built-in knots in the published preset: the mean edge of the published reef, thief, granny
and grief."""

LARGEST_STRAIN = 0.5
"""Strain F/EA beyond which neither linear elasticity nor a rest length means anything."""

PUBLISHED_STEP = 1e-4
"""Fixed time step of the published preset [s]."""

Progress = Callable[[float, str], None]
"""Called with the share done, from 0 to 1, and what is going on."""

Positive = Field(gt=0)


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
    measure: Callable[[State], dict[str, float]]
    derive: Callable[[Mapping[str, Floats]], dict[str, Floats]]
    conclude: Callable[[Mapping[str, Floats], float | None], dict[str, float]]
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


class Spec(BaseModel, ABC):
    """A protocol's specification: numbers in SI units, given as such or as text with a unit.

    Fields left out (None) take the value of the material or of the preset.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    hints: ClassVar[Mapping[str, str]] = {
        "rho": "overdamped motion has no inertia, so there is no field 'rho'; leave it out",
        "seed": "nothing here is random, so there is no field 'seed'; leave it out",
        "time": "there is no field 'time'; did you mean 'duration'?",
        "file": "there is no field 'file'; did you mean 'centerline'?",
        "dt": "there is no field 'dt'; did you mean 'fixed_step'?",
        "diameter": "there is no field 'diameter'; give 'radius', half of it",
        "thickness": "there is no field 'thickness'; give 'radius', half of it",
    }
    """What to say to those who give a field that this protocol does not have."""

    protocol: str
    material: str = Field(
        "nylon", description="Preset of the fiber: nylon, optomechanical, spaghetti or silicone."
    )
    radius: Annotated[Length, Positive] | None = Field(
        None, description="Radius h of the fiber; by default the material's."
    )
    E: Annotated[Pressure, Positive] | None = Field(
        None, description="Young's modulus in stretch; by default the material's."
    )
    E_b: Annotated[Pressure, Positive] | None = Field(
        None, description="Young's modulus in bending; by default the material's."
    )
    nu: Annotated[Number, Field(gt=-1, lt=0.5)] | None = Field(
        None, description="Poisson's ratio; by default the material's."
    )
    eta: Annotated[Viscosity, Positive] | None = Field(
        None, description="Internal viscosity; by default the material's."
    )
    preset: Literal["standard", "published"] = Field(
        "standard",
        description="Model: standard (converging laws, resampled nodes, error-controlled steps) or "
        "published (the thesis's own program, on the nodes as given or as far apart as those published).",
    )
    duration: Annotated[Time, Positive] = Field(1.0, description="How long to pull.")
    frames: int = Field(
        100,
        ge=1,
        le=1_000_000,
        description="Frames to record after the one at t = 0, evenly spaced: N of them end N intervals.",
    )
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
    exclusion_edges: Annotated[int, Field(ge=1, le=1_000_000)] | None = Field(
        None,
        description="No contact between edges at most so many apart along a fiber; by default the preset's.",
    )
    exclusion_radii: Annotated[Number, Field(ge=0)] | None = Field(
        None,
        description="No contact between edges nearer than so many radii along a fiber; by default the "
        "preset's.",
        examples=["3.14"],
    )

    if not TYPE_CHECKING:  # a checker sees the signature that the fields make

        def __init__(self, **fields: Any) -> None:
            """Raises TorsadeError, in one sentence, where pydantic would raise ValidationError."""
            try:
                super().__init__(**fields)
            except ValidationError as error:
                raise TorsadeError(sentence(type(self), error)) from None

    @field_validator("frames", "exclusion_edges", mode="before")
    @classmethod
    def _no_truth_value(cls, value: object) -> object:
        if isinstance(value, bool):
            raise QuantityError(f"is {value}; give a whole number")
        return value

    @field_validator("material")
    @classmethod
    def _known_material(cls, name: str) -> str:
        material_preset(name)
        return name

    @model_validator(mode="after")
    def _one_way_to_step(self) -> Spec:
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
    def h(self) -> float:
        """Radius of the fiber [m]."""
        return material_preset(self.material).radius if self.radius is None else self.radius

    @property
    def section(self) -> Section:
        """Cross section of the fiber."""
        return Section(self.h)

    @property
    def fiber_material(self) -> Material:
        """The named material with the constants that are given in place of its own."""
        given = {name: getattr(self, name) for name in ("E", "E_b", "nu", "eta")}
        own = material_preset(self.material).material
        return dataclasses.replace(own, **{k: v for k, v in given.items() if v is not None})

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

    def stored(self) -> dict[str, Any]:
        """The fields as a result holds them: those that were given or have defaults."""
        return self.model_dump(mode="json", exclude_none=True)

    def run(
        self,
        progress: Progress | None = None,
        out: str | Path | None = None,
        *,
        resume: bool = False,
        overwrite: bool = False,
    ) -> Result:
        """Do what the specification says.

        Parameters
        ----------
        progress : called as the run goes on
        out : a folder NAME.zarr to write while it runs; NAME.zarr.part until it is complete
        resume : go on with the NAME.zarr.part of an interrupted run of the same specification
        overwrite : replace an earlier result of that name

        Raises
        ------
        TorsadeError
            When the input is unfit, the output cannot be written, or strands would pass through each
            other; frames recorded until then stay in NAME.zarr.part.
        Interrupted
            On Ctrl-C, after saving what there is.
        """
        from torsade.protocols.driving import drive

        return drive(self, progress, out, resume, overwrite)

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

    @classmethod
    @abstractmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`."""
