"""Ctrl-C and SIGTERM during a run: heard at once, obeyed between two steps."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from torsade import stopping
from torsade.errors import counted

__all__ = ["STOPPING", "Interrupted", "Patience"]

STOPPING = "stopping ... (Ctrl-C again to stop at once)"
"""What is said when the first of them was heard."""


class Patience:
    """While it lasts, Ctrl-C and SIGTERM wait for the next call of `end`: no step or write is cut in half.

    `told` is called at the first of them; a second one does not wait. Handlers of others are left in place.
    """

    def __init__(self, told: Callable[[], None]) -> None:
        self._told = told
        self._asked = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Patience:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if stopping.ours(number):
                    self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: object) -> None:
        stopping.heard(number)
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True
        self._told()

    def end(self) -> None:
        """Raise KeyboardInterrupt if a signal has come."""
        if self._asked:
            raise KeyboardInterrupt


class Interrupted(KeyboardInterrupt):
    """Ctrl-C or SIGTERM during a run, after what there is was saved.

    Attributes: `time` of the last frame [s], `frames` recorded, `part`, the folder that holds them, or None;
    `earlier`, the folder of a run that was to be gone on with, which is as it was.
    """

    def __init__(self, time: float, frames: int, part: Path | None, earlier: Path | None = None) -> None:
        self.time, self.frames, self.part = time, frames, part
        reached = f"at t = {time:.4g} s" if frames else "before the first frame"
        what = f"{counted(frames, 'frame')} {'is' if frames == 1 else 'are'} saved"
        lost = "nothing is saved" if earlier is None else f"{str(earlier)!r} is as it was"
        kept = lost if part is None else f"{what} in {str(part)!r}"
        super().__init__(f"interrupted {reached}; {kept}")
