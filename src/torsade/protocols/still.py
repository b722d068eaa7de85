"""Specifications of an equilibrium: what comes out is one frame, and there is no time in it."""

from __future__ import annotations

import dataclasses
import time
from abc import abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from torsade.protocols.base import SILENT, Progress, Spec

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly
    from torsade.results import Result

__all__ = ["Found", "Still"]


class Found(NamedTuple):
    """An equilibrium.

    Attributes
    ----------
    assembly : the fibers
    frame : what is recorded of it, by names in `torsade.variables.VARIABLES`
    numbers : what belongs to it as a whole
    """

    assembly: Assembly
    frame: Mapping[str, float | Floats]
    numbers: Mapping[str, Any]


class Still(Spec):
    """A specification of fibers at rest. Its result has one frame, at t = 0."""

    @abstractmethod
    def solve(self) -> Found:
        """The equilibrium."""

    def meaning(self) -> dict[str, Any]:
        material = dataclasses.asdict(self.fiber_material)
        del material["source"]
        return {"material": material, "radius": self.h}

    def run(
        self,
        progress: Progress | None = None,
        out: str | Path | None = None,
        *,
        resume: bool = False,
        overwrite: bool = False,
    ) -> Result:
        """Find the equilibrium.

        It is found at once or not at all: when it is interrupted nothing is saved, and `resume` begins anew.

        Parameters
        ----------
        progress : called when there is something to wait for
        out : a folder NAME.zarr to write
        resume : take what stands complete at `out`, if it is of the same specification
        overwrite : replace an earlier result of that name

        Raises
        ------
        TorsadeError
            When there is no such equilibrium, or the output cannot be written.
        Interrupted
            On Ctrl-C or SIGTERM.
        """
        from torsade import places
        from torsade.protocols.driving import READY, Interrupted, compilation_told
        from torsade.recording import Recording

        if out is not None and not resume:
            places.check_target(out, overwrite)  # before there is something to be lost
        began = time.perf_counter()
        try:
            tell = progress or SILENT
            tell(0.0, READY)
            with compilation_told(tell):
                found = self.solve()
        except KeyboardInterrupt:
            raise Interrupted(0.0, 0, None) from None
        a = found.assembly
        recording = Recording.begin(
            {"time": 1, "sample": 0, "fiber": len(a.closed), "node": len(a.node_length)},
            {"node_start": ("fiber_bound", a.node_start), "closed": ("fiber", a.closed)},
            ("time", *found.frame),
            self.attributes() | {"start": ""},
            lambda history: {},
            (),
            out,
            resume=resume,
            overwrite=overwrite,
        )
        try:
            if not recording.complete:
                recording.add({"time": 0.0, **found.frame})
                recording.keep({}, 0, time.perf_counter() - began)
                return recording.finish(found.numbers)
            return recording.result()
        finally:
            recording.close()
