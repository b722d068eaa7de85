"""Ctrl-C during a run: heard at once, obeyed between two steps."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from pathlib import Path

from torsade.errors import counted

__all__ = ["Interrupted", "Patience"]


class Patience:
    """While it lasts, Ctrl-C waits for the next call of `end`, so that no step or write is cut in half.

    `told` is called at the first Ctrl-C; a second one does not wait. Another handler than Python's own is
    left in place.
    """

    def __init__(self, told: Callable[[], None]) -> None:
        self._told = told
        self._asked = False
        self._installed = False

    def __enter__(self) -> Patience:
        ours = threading.current_thread() is threading.main_thread()
        if ours and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._note)
            self._installed = True
        return self

    def __exit__(self, *_: object) -> None:
        if self._installed:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def _note(self, *_: object) -> None:
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True
        self._told()

    def end(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C was pressed."""
        if self._asked:
            raise KeyboardInterrupt


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run, after what there is was saved.

    Attributes: `time` of the last frame [s], `frames` recorded, `part`, the folder that holds them, or None.
    """

    def __init__(self, time: float, frames: int, part: Path | None) -> None:
        self.time, self.frames, self.part = time, frames, part
        reached = f"at t = {time:.4g} s" if frames else "before the first frame"
        what = f"{counted(frames, 'frame')} {'is' if frames == 1 else 'are'} saved"
        kept = "nothing is saved" if part is None else f"{what} in {str(part)!r}"
        super().__init__(f"interrupted {reached}; {kept}")
