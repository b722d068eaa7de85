"""Results: labelled arrays with what was asked and what came of it, in zarr folders that anyone can open.

A result is an `xarray.Dataset` in SI units; every variable has the attributes `units` and `long_name`.
Histories have the dimension `time`; `twist` also `fiber`. Frames are `position` [m] and `velocity` [m/s]
`(time, node, space)`, `log_strain (time, node)` and its parts `strain_stretch`, `strain_bend` and
`strain_twist`, and `self_torque (time, edge)` [N], edges counted through all fibers, stored in single
precision. Samples, `sample_time (sample)` [s] and `sample_separation (sample)` [m], are finer in time and do
not depend on frames: what a run concludes comes from them. `node_start (fiber_bound)` says where each fiber
begins, `closed (fiber)` which are closed. Fibers at rest have one frame, at t = 0.

The attributes hold `format`, `protocol`, `spec` and `model` (JSON: what was asked, and the numbers that it
meant), `knot` where there is one, `radius` [m], `seed` where chance has a part, `status`, `done` (frames),
`sampled`, `steps`, what the protocol concludes, such as `c_f`, and where the numbers come from: `created`,
`wall_s`, `versions`, `kernels`, `machine` and, for every time that the run was gone on with, an entry of
`resumed`. On disk there is `chunks` too, the number of files that hold each variable.
"""

from __future__ import annotations

import json
import os
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsade import places, reading, store
from torsade.errors import TorsadeError, counted

if TYPE_CHECKING:
    import xarray

__all__ = ["Result", "open_result"]

READ_AT_ONCE = 50_000_000
"""Largest array that opening a result reads [bytes]."""

READ_IN_ALL = 10 * READ_AT_ONCE
"""Most that opening a result reads [bytes]."""

PROVENANCE = ("created", "wall_s", "seed", "versions", "kernels", "machine", "resumed")
"""Attributes that say where numbers come from."""


class Result:
    """What a run gave: the dataset, and the numbers asked for most.

    `open` reads one, complete or still growing; plain `xarray.open_zarr` reads the same folder.
    """

    def __init__(self, dataset: xarray.Dataset) -> None:
        self._dataset = dataset
        self._behind: Path | None = None

    @classmethod
    def open(cls, path: str | Path, *, salvage: bool = False) -> Result:
        """Read a result from NAME.zarr, or what is done of one from NAME.zarr.part.

        Variables of more than `READ_AT_ONCE` bytes stay on disk until they are used. With salvage, where
        files of numbers are lost, the frames before are read.

        Raises
        ------
        TorsadeError
            When there is no result at that path, or one that is damaged or that no run wrote; of variables
            that stay on disk, when they are used.
        """
        path = Path(path)
        if places.attributes(path) is None:
            part = places.part_of(path) if path.name else path
            if places.attributes(part) is not None:
                raise TorsadeError(
                    f"{str(path)!r} is not complete; open {str(part)!r} for what is done of it"
                )
            raise TorsadeError(f"{str(path)!r} {_what_else(path)}; give a folder NAME.zarr written by a run")
        dataset, late = reading.read(path, READ_AT_ONCE, READ_IN_ALL, salvage)
        result = cls(dataset)
        result._behind = path if late else None
        return result

    @property
    def dataset(self) -> xarray.Dataset:
        """The labelled arrays, in SI units."""
        if self._behind is not None:
            now = places.attributes(self._behind) or {}
            if now.get("created") != self._dataset.attrs.get("created"):
                raise TorsadeError(
                    f"{str(self._behind)!r} was moved or replaced since it was opened; open it again"
                )
        return self._dataset

    @property
    def spec(self) -> dict[str, Any]:
        """The specification: fields that were given or have defaults, in SI units."""
        return dict(json.loads(self._dataset.attrs["spec"]))

    @property
    def protocol(self) -> str:
        """The protocol that was run."""
        return str(self._dataset.attrs["protocol"])

    @property
    def status(self) -> str:
        """How far it came: running, interrupted, failed or complete."""
        return str(self._dataset.attrs["status"])

    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return self.status == "complete"

    @property
    def provenance(self) -> dict[str, Any]:
        """Where the numbers come from: when it was begun, computing time [s], seed, versions, kernels,
        machine, and each time that it was gone on with."""
        attrs = self._dataset.attrs
        return {name: attrs[name] for name in PROVENANCE if name in attrs}

    @property
    def frames(self) -> int:
        """Recorded frames."""
        return int(self._dataset.sizes["time"])

    @property
    def c_f(self) -> float | None:
        """Topological friction F 2h/(eta A v) of a pulled bend; None where it is not known."""
        return self._number("c_f")

    @property
    def slipped_at(self) -> float | None:
        """When a pulled bend slipped [s]; None while it holds."""
        return self._number("slipped_at_s")

    @property
    def last_held(self) -> int:
        """The last frame, or of a bend that slipped the last one before it did."""
        slipped = self.slipped_at
        if slipped is None:
            return self.frames - 1
        return max(0, int(self._dataset["time"].searchsorted(slipped * (1 - 1e-9))) - 1)

    def report(self) -> dict[str, Any]:
        """The numbers that its command prints, under the keys of `--json`.

        Raises
        ------
        TorsadeError
            When the run has not come to its end, its protocol is not known here, or what it wrote is damaged.
        """
        return dict(_above("torsade.protocols.stored").report(self))

    def save(self, path: str | Path, overwrite: bool = False) -> Path:
        """Write the result to a folder NAME.zarr.

        Raises
        ------
        TorsadeError
            When the folder cannot be written, or exists and is not a result that may be overwritten.
        """
        out = places.check_target(path, overwrite)
        lock = places.Lock(out)
        try:
            part = places.part_of(out)
            done = (places.attributes(part) or {}).get("done", 0)
            if done:
                raise TorsadeError(
                    f"{str(part)!r} holds {counted(done, 'frame')} of an interrupted run; finish it or give "
                    "another name"
                )
            store.save(self.dataset, out)
        finally:
            lock.release()
        return out

    def export(
        self,
        to: str,
        path: str | Path,
        frames: str | int | slice | None = None,
        *,
        overwrite: bool = False,
    ) -> list[Path]:
        """Write the result for other programs: vtk, gltf, csv or npz; see `torsade.export.export`."""
        return list(_above("torsade.export").export(self, to, path, frames, overwrite=overwrite))

    def show(self, picture: str | Path | None = None, frame: int | None = None) -> None:
        """Show all frames in a window, or draw one to a picture; see `torsade.view.show`."""
        _above("torsade.view").show(self, picture, frame)

    def _number(self, name: str) -> float | None:
        value = self._dataset.attrs.get(name)
        return None if value is None else float(value)

    def __repr__(self) -> str:
        attrs = self._dataset.attrs
        last = float(self._dataset["time"][-1]) if self.frames else 0.0
        what = f" on {attrs['knot']}" if "knot" in attrs else ""
        return f"<Result of {attrs['protocol']}{what}: {self.frames} frames to t = {last:.4g} s>"


def _what_else(path: Path) -> str:
    """What a path is that is no result."""
    try:
        (path / "zarr.json").stat()
    except PermissionError:
        return "may not be read (permission denied)"
    except (OSError, ValueError):
        return "is not a result of torsade" if os.path.lexists(path) else "does not exist"
    return "is not a result of torsade" if os.access(path / "zarr.json", os.R_OK) else "may not be read"


def _above(module: str) -> Any:
    """A module that stands above results, imported when something is asked of it that needs more."""
    return import_module(module)


def open_result(path: str | Path, *, salvage: bool = False) -> Result:
    """Read a result; see `Result.open`."""
    return Result.open(path, salvage=salvage)
