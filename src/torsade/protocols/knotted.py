"""Specifications of what is done to a knot: one known by name, or a centerline in a file."""

from __future__ import annotations

from pathlib import PurePath
from typing import Annotated

from pydantic import Field, field_validator

from torsade.errors import QuantityError, TorsadeError, quoted
from torsade.protocols.pulled import Pulled
from torsade.units import Length, quantity

__all__ = ["Knotted"]


class Knotted(Pulled):
    """A specification whose fibers are a built-in knot or a file of strands."""

    knot: str | None
    centerline: str | None
    length_unit: str | None = Field(
        None, description="Unit of x, y, z in the centerline's file, such as mm; by default m."
    )
    smooth: Annotated[Length, Field(ge=0)] | None = Field(
        None,
        description="Smooth the centerline over this length first, without changing its knot; by default not "
        "at all.",
        examples=["0.1 mm"],
    )

    @field_validator("length_unit")
    @classmethod
    def _a_unit(cls, unit: str | None) -> str | None:
        if unit is not None:
            try:
                quantity(f"1 {unit}", "length")
            except QuantityError:
                raise QuantityError(
                    f"{quoted(unit)} is no unit of length; give m, mm, cm, um or in"
                ) from None
        return unit

    def check_shape(self, advice: str) -> None:
        """Refuse two shapes, or none, or a unit for none."""
        if self.knot is not None and self.centerline is not None:
            raise TorsadeError(
                f"knot {quoted(self.knot)} and centerline {quoted(self.centerline)} are both given; give one "
                "of them"
            )
        if self.knot is None and self.centerline is None:
            raise TorsadeError(f"nothing to pull is given; {advice}")
        if self.knot is not None and self.length_unit is not None:
            raise TorsadeError(
                f"length_unit {quoted(self.length_unit)} belongs to a centerline; leave it out, or give one"
            )
        if self.knot is not None and self.smooth is not None:
            raise TorsadeError("a built-in knot needs no smoothing; leave smooth out, or give a centerline")

    @property
    def node_spacing(self) -> float | None:
        """Greatest distance between nodes [m]; None to keep those of a centerline, when published."""
        if self.spacing is None and self.preset == "published" and self.knot is None:
            return None
        return super().node_spacing

    @property
    def shape_name(self) -> str:
        """Name of what is pulled, for tables and titles: the knot's, or that of the centerline's file."""
        return self.knot or PurePath(str(self.centerline)).stem
