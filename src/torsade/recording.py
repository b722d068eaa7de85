"""The history of a run as it grows, in memory and, when asked for, on disk."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade import places, provenance, store, vetting
from torsade.arrays import Floats
from torsade.errors import TorsadeError, counted
from torsade.results import Result
from torsade.variables import FORMAT, SAMPLE, SINGLE_PRECISION, VARIABLES

if TYPE_CHECKING:
    from torsade.motion.moving import Motion

__all__ = ["Recording"]

FLUSH_EVERY = 0.5
"""Least time between writes to disk [s]: frames that come faster are written together."""

PROGRESS = ("done", "sampled", "wall", "steps")
"""What the restart file holds besides what the motion saves."""

NEEDED = ("created", "done", "machine", "resumed", "spec", "status", "steps", "sampled", "wall_s")
"""Attributes without which a run cannot be gone on with."""

Frame = Mapping[str, "float | Floats"]


class Recording:
    """Frames and samples recorded so far, and the exact state behind the last of them.

    Attributes
    ----------
    done, sampled : frames and samples recorded
    saved : all that decides how the motion goes on after the last of them, None before the first
    wall : computing time so far [s]
    complete : whether there is nothing left to do
    part : the growing folder on disk, or None before there is one
    """

    def __init__(
        self,
        sizes: Mapping[str, int],
        fixed: Mapping[str, tuple[str | tuple[str, ...], NDArray[Any]]],
        names: tuple[str, ...],
        attrs: dict[str, Any],
    ) -> None:
        sizes = {"space": 3, **sizes}
        self._arrays: dict[str, NDArray[Any]] = {
            name: np.full(
                [sizes[d] for d in VARIABLES[name][0]],
                np.nan,
                np.float32 if name in SINGLE_PRECISION else np.float64,
            )
            for name in names
        }
        self._fixed = dict(fixed)
        begun = {"format": FORMAT, "created": _now(), **provenance.present(), "resumed": []}
        self.attrs = attrs | begun | {"status": "running"}
        self.done = self.sampled = 0
        self.saved: dict[str, NDArray[Any]] | None = None
        self._restart: tuple[str, ...] = ()
        self.complete = False
        self.wall = 0.0
        self._steps = 0
        self.part: Path | None = None
        self._out: Path | None = None
        self._lock: places.Lock | None = None
        self._written = (0, 0)
        self._flushed = time.monotonic()
        self._derive: Callable[[dict[str, Floats]], dict[str, Floats]] = lambda history: {}

    @classmethod
    def begin(
        cls,
        sizes: Mapping[str, int],
        fixed: Mapping[str, tuple[str | tuple[str, ...], NDArray[Any]]],
        names: tuple[str, ...],
        attrs: dict[str, Any],
        derive: Callable[[dict[str, Floats]], dict[str, Floats]],
        restart: tuple[str, ...],
        out: str | Path | None,
        *,
        resume: bool,
        overwrite: bool,
    ) -> Recording:
        """A new recording, or with resume the one that an interrupted run of the same left at `out`.

        Close it when the run ends, however it does. attrs must hold all that tells one run from another;
        sizes are those of the dimensions, frames (time) and samples (sample) among them; derive gives the
        histories that follow from those recorded; restart names the arrays that the motion saves.
        """
        recording = cls(sizes, fixed, names, attrs)
        recording._derive, recording._restart = derive, restart
        if out is None:
            if resume:
                raise TorsadeError(
                    'resume needs the place of the earlier run; give out="NAME.zarr" (--out NAME.zarr)'
                )
            return recording
        if resume and recording._is_complete(Path(out)):
            return recording
        recording._out = places.check_target(out, overwrite)
        recording._lock = places.Lock(recording._out)
        try:
            places.check_target(out, overwrite)  # before the lock another run may have come to its end
            recording._start(places.part_of(recording._out), resume, overwrite)
        except BaseException:
            recording.close()
            raise
        return recording

    def _start(self, part: Path, resume: bool, overwrite: bool) -> None:
        """Take over the growing folder that is there, or see that a new one may take its place."""
        found = places.attributes(part) or {}
        done = found.get("done", 0)
        if done and resume:
            self._go_on(part)
            return
        if done and not overwrite:
            raise TorsadeError(
                f"{str(part)!r} holds {counted(done, 'frame')} of an interrupted run; add --resume "
                "(resume=True) to go on or --overwrite (overwrite=True) to begin anew"
            )

    def _is_complete(self, out: Path) -> bool:
        """Whether the same run stands complete at `out`; its frames are then taken over."""
        found = places.attributes(out)
        if found is None or found.get("status") != "complete" or places.part_of(out).exists():
            return False
        found, _ = vetting.vetted(out)
        provenance.check_same_run(self.attrs, found, out)
        self._out, self.complete = out, True
        return True

    def _go_on(self, part: Path) -> None:
        """Take over the frames and the state of an interrupted run."""
        found, _ = vetting.vetted(part)
        missing = [name for name in NEEDED if name not in found]
        if missing:
            raise TorsadeError(f"{str(part)!r} does not say {missing[0]!r}; give --overwrite to begin anew")
        provenance.check_same_run(self.attrs, found, part)
        provenance.check_same(found, part)
        for name in ("created", "versions", "machine", "resumed"):
            self.attrs[name] = found[name]
        self.part = part
        if found["status"] == "complete":  # only its name is missing
            assert self._out is not None
            with _or_anew():
                Result.open(part)
            store.give_name(part, self._out)
            self.complete = True
        elif store.has_restart(part):
            self._take_over(part)
            # The state is written before them, and may be ahead.
            store.set_attributes(part, self._progress() | {"status": found["status"]})
            self._read(part)
            again = {"at": _now(), "done": self.done, **provenance.present()}
            self.attrs["resumed"] = [*found["resumed"], again]
            store.set_attributes(part, {name: self.attrs[name] for name in ("status", "resumed")})
        elif found["done"] == len(self._arrays["time"]):  # only the end is missing
            self.done, self.sampled = self._written = found["done"], found["sampled"]
            self._steps, self.wall = found["steps"], float(found["wall_s"])
            self._read(part)
        else:
            raise TorsadeError(
                f"{str(part)!r} holds {counted(found['done'], 'frame')}, but no state to go on from; open it "
                f"for the frames, or {provenance.ANEW}"
            )

    def _take_over(self, part: Path) -> None:
        """Read the restart file, and refuse one that counts frames which there cannot be."""
        saved = store.read_restart(part, (*self._restart, *PROGRESS))
        with store.sound_restart(part):
            self.done, self.sampled = self._written = int(saved["done"]), int(saved["sampled"])
            self.wall, self._steps = float(saved["wall"]), int(saved["steps"])
            samples = max((len(a) for name, a in self._arrays.items() if name.startswith(SAMPLE)), default=0)
            if not (0 < self.done <= len(self._arrays["time"]) and 0 <= self.sampled <= samples):
                raise ValueError
        self.saved = {name: saved[name] for name in self._restart}

    def recover(self, motion: Motion) -> None:
        """Bring a motion, as it is at t = 0, to where the frames that were taken over end."""
        assert self.saved is not None
        assert self.part is not None
        with store.sound_restart(self.part):
            motion.recover(self.saved)

    def _read(self, part: Path) -> None:
        with _or_anew():
            before = Result.open(part).dataset
            for name, values in self._arrays.items():
                taken = values[: self._count(name)]
                if name not in before or before[name].shape != taken.shape:
                    raise TorsadeError(
                        f"{str(part)!r} does not hold {name!r} as this run records it; it is damaged"
                    )
                taken[:] = before[name].values

    def add(self, frame: Frame) -> None:
        """Record a frame."""
        for name, value in frame.items():
            self._arrays[name][self.done] = value
        self.done += 1

    def sample(self, values: Mapping[str, float]) -> None:
        """Record a sample of histories that are followed more finely than frames."""
        for name, value in values.items():
            self._arrays[SAMPLE + name][self.sampled] = value
        self.sampled += 1

    def keep(self, saved: dict[str, NDArray[Any]], steps: int, wall: float) -> None:
        """Hold what the motion saved behind what was recorded last, its steps and the computing time [s]."""
        self.saved, self._steps, self.wall = saved, steps, wall
        if time.monotonic() - self._flushed > FLUSH_EVERY:
            self.flush()

    def histories(self) -> dict[str, Floats]:
        """The recorded scalars so far, shape (done,) or (done, n_fibers)."""
        return {
            name: a[: self.done]
            for name, a in self._arrays.items()
            if name not in SINGLE_PRECISION and not name.startswith(SAMPLE)
        }

    def samples(self) -> dict[str, Floats]:
        """The samples so far, shape (sampled,), without `SAMPLE` in their names."""
        return {
            name.removeprefix(SAMPLE): a[: self.sampled]
            for name, a in self._arrays.items()
            if name.startswith(SAMPLE)
        }

    @property
    def reached(self) -> float:
        """Time of the last frame [s]."""
        return float(self._arrays["time"][self.done - 1]) if self.done else 0.0

    def _count(self, name: str) -> int:
        return self.sampled if name.startswith(SAMPLE) else self.done

    def flush(self) -> None:
        """Write to disk what is not there yet."""
        self._complement()
        if self._out is None or self.saved is None:
            return
        if self.part is None:
            self._begin_folder(None)
        else:
            self._append()
            self._write_restart(self.part)
            store.set_attributes(self.part, self._progress())
        self._flushed = time.monotonic()

    def _complement(self) -> None:
        """Fill in the histories that follow from those recorded."""
        if self.done:
            for name, values in self._derive(self.histories()).items():
                self._arrays[name][: self.done] = values

    def _begin_folder(self, sizes: Mapping[str, int] | None) -> None:
        """Write all that there is to a folder, which then takes the place where others look for it.

        With sizes of dimensions nothing is to come any more, otherwise it grows.
        """
        assert self._out is not None
        part = places.part_of(self._out)
        new = places.private(part, "new")
        self.attrs.update(self._progress())
        try:
            store.create(self._dataset(sizes), new)
            if sizes is None:
                self._write_restart(new)
            places.replace(new, part)
        except BaseException:
            shutil.rmtree(new, ignore_errors=True)
            raise
        self.part = part
        self._written = self.done, self.sampled

    def _append(self) -> None:
        assert self.part is not None
        frames = {name: a for name, a in self._arrays.items() if not name.startswith(SAMPLE)}
        store.append(self.part, frames, self._written[0], self.done)
        samples = {name: a for name, a in self._arrays.items() if name.startswith(SAMPLE)}
        store.append(self.part, samples, self._written[1], self.sampled)
        self._written = self.done, self.sampled

    def _write_restart(self, folder: Path) -> None:
        assert self.saved is not None
        progress = {name: np.array(value) for name, value in self._progress().items() if name in PROGRESS}
        store.write_restart(folder, self.saved | progress | {"wall": np.array(self.wall)})

    def stop(self, status: str) -> None:
        """Save what there is of a run that did not come to its end, and why it did not."""
        self.attrs["status"] = status
        if self.done:
            self.flush()

    def finish(self, numbers: Mapping[str, Any]) -> Result:
        """The result of a run that came to its end, with what belongs to it as a whole."""
        self._complement()
        self.attrs.update({"status": "complete"} | dict(numbers))
        self.attrs.update(self._progress())
        if self._out is not None:
            if self.part is None:
                self._begin_folder(self._sizes())
                store.give_name(places.part_of(self._out), self._out)
            else:
                self._append()
                store.complete(self.part, self._out, self._sizes(), self.attrs)
        self.complete = True
        return self.result()

    def close(self) -> None:
        """Let other processes write to the same place."""
        if self._lock is not None:
            self._lock.release()

    def result(self) -> Result:
        """The frames so far as a result."""
        if self.complete and self.done == 0 and self._out is not None:
            return Result.open(self._out)
        self.attrs.update(self._progress())
        return Result(self._dataset(self._sizes()))

    def _sizes(self) -> dict[str, int]:
        return {"time": self.done, "sample": self.sampled}

    def _progress(self) -> dict[str, Any]:
        return {
            "done": self.done,
            "sampled": self.sampled,
            "steps": self._steps,
            "wall_s": self.wall,
            "status": self.attrs["status"],
        }

    def _dataset(self, sizes: Mapping[str, int] | None) -> Any:
        """All arrays, cut to these sizes, or whole."""
        import xarray

        variables: dict[str, Any] = {}
        for name, values in self._arrays.items():
            dims = VARIABLES[name][0]
            cut = values if sizes is None else values[: sizes[dims[0]]]
            variables[name] = (dims, cut, _about(name))
        time_axis = {"time": variables.pop("time")}
        for name, (given, values) in self._fixed.items():
            variables[name] = (given, values, _about(name))
        return xarray.Dataset(variables, coords=time_axis, attrs=dict(self.attrs))


def _about(name: str) -> dict[str, str]:
    """Unit and meaning of a variable."""
    _, unit, meaning = VARIABLES[name]
    return {"units": unit, "long_name": meaning}


@contextmanager
def _or_anew() -> Iterator[None]:
    """Say of what is damaged what can be done in place of going on with it."""
    try:
        yield
    except TorsadeError as error:
        raise TorsadeError(f"{error}; {provenance.ANEW}") from None


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="microseconds")
