"""What every protocol's specification has in common: the fiber, how it runs, and its messages.

A specification says what to do and nothing about how: it is frozen, holds SI numbers only, and is
written into every result. Nothing heavy is imported until it runs, so that help texts come at once.
"""

from __future__ import annotations

import dataclasses
import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from torsade.errors import TorsadeError
from torsade.material import Material, Section
from torsade.material import preset as material_preset
from torsade.protocols.sentences import sentence
from torsade.units import Length, Number, Pressure, Whole

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from torsade.arrays import Floats
    from torsade.motion.moving import Motion, Outcome
    from torsade.results import Result

__all__ = ["SILENT", "Driven", "Positive", "Progress", "Spec", "Trial"]

Progress = Callable[[float, str], None]
"""Called with the share done, from 0 to 1, and what is going on."""

SILENT: Progress = lambda share, note: None  # noqa: E731

Positive = Field(gt=0)


class Spec(BaseModel, ABC):
    """A protocol's specification: numbers in SI units, given as such or as text with a unit.

    Fields left out (None) take the value of the material or of the preset.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    hints: ClassVar[Mapping[str, str]] = {
        "diameter": "there is no field 'diameter'; give 'radius', half of it",
        "thickness": "there is no field 'thickness'; give 'radius', half of it",
    }
    """What to say to those who give a field that this protocol does not have."""

    pictured: ClassVar[bool] = True
    """Whether there is a picture to draw of a result."""

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

    if not TYPE_CHECKING:  # a checker sees the signature that the fields make

        def __init__(self, **fields: Any) -> None:
            """Raises TorsadeError, in one sentence, where pydantic would raise ValidationError."""
            try:
                super().__init__(**fields)
            except ValidationError as error:
                raise TorsadeError(sentence(type(self), error)) from None

    @field_validator("material")
    @classmethod
    def _known_material(cls, name: str) -> str:
        material_preset(name)
        return name

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
        own = material_preset(self.material).material
        names = [f.name for f in dataclasses.fields(Material) if f.name in type(self).model_fields]
        given = {name: getattr(self, name) for name in names}
        return dataclasses.replace(own, **{k: v for k, v in given.items() if v is not None})

    def stored(self) -> dict[str, Any]:
        """The fields as a result holds them: those that were given or have defaults."""
        return self.model_dump(mode="json", exclude_none=True)

    @abstractmethod
    def meaning(self) -> dict[str, Any]:
        """The numbers behind names in the specification, which another version may understand otherwise."""

    def attributes(self) -> dict[str, Any]:
        """What every result of this specification says of itself."""
        about = {
            "protocol": self.protocol,
            "spec": json.dumps(self.stored()),
            "radius": self.h,
            "model": json.dumps(self.meaning()),
        }
        seed = getattr(self, "seed", None)
        return about if seed is None else about | {"seed": seed}

    @abstractmethod
    def run(
        self,
        progress: Progress | None = None,
        out: str | Path | None = None,
        *,
        resume: bool = False,
        overwrite: bool = False,
    ) -> Result:
        """Do what the specification says."""

    @classmethod
    @abstractmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`."""


class Trial(NamedTuple):
    """A specification at work: fibers that move, and what is measured on them.

    Attributes
    ----------
    motion : the fibers, at t = 0
    names : what is recorded at every frame
    frame : everything recorded at the present time, by these names
    derive : recorded histories (n_frames,) → further histories that follow from them
    conclude : samples, and the time [s] at which nothing resisted the load any more or None → numbers and
        lists that belong to the run as a whole
    sizes : of the dimensions of what is recorded, besides time and samples
    fixed : arrays that do not change, by name, each with its dimension or dimensions
    start : what tells this start from that of another run of the same specification
    derived : names of the derived histories
    sampled : names recorded at times that do not depend on the number of frames
    sample : their present values
    catch : called with a time [s] when nothing resists the load: bring the fibers to where something does,
        at that time at the latest, and say how, or None where there is no such place
    about : attributes of the result, in words
    over : asked whenever something is recorded after t = 0: whether there is nothing left to see
    later : times [s] at which ends and loads change
    begin : called with the present time [s] before the fibers move on: put these ends and loads in place
    frame_times, sample_times : of frames and samples [s], from 0 on; evenly spaced unless given
    """

    motion: Motion
    names: tuple[str, ...]
    frame: Callable[[], dict[str, float | Floats]]
    conclude: Callable[[Mapping[str, Floats], float | None], Mapping[str, Any]]
    sizes: Mapping[str, int]
    fixed: Mapping[str, tuple[str | tuple[str, ...], NDArray[Any]]]
    start: str
    derive: Callable[[Mapping[str, Floats]], dict[str, Floats]] = lambda history: {}
    derived: tuple[str, ...] = ()
    sampled: tuple[str, ...] = ()
    sample: Callable[[], dict[str, float]] = dict
    catch: Callable[[float], Outcome | None] = lambda until: None
    about: Mapping[str, str] = MappingProxyType({})
    over: Callable[[], bool] = lambda: False
    later: tuple[float, ...] = ()
    begin: Callable[[float], None] = lambda time: None
    frame_times: Floats | None = None
    sample_times: Floats | None = None


class Driven(Spec):
    """A specification of something that goes on in time, recorded as it does."""

    frames: Whole = Field(
        100,
        ge=1,
        le=1_000_000,
        description="Frames to record after the one at t = 0, evenly spaced: N of them end N intervals.",
    )

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
            On Ctrl-C or SIGTERM, after saving what there is.
        """
        from torsade.protocols.driving import drive

        return drive(self, progress, out, resume, overwrite)

    @property
    @abstractmethod
    def lasting(self) -> float:
        """How long it goes on [s]."""

    @abstractmethod
    def trial(self) -> Trial:
        """The fibers at t = 0, checked, what is done to them and what is measured on them."""

    def prepared(self, tell: Progress) -> Trial:
        """The trial, by a specification whose fibers take long to be made: it tells how far it has come."""
        return self.trial()
