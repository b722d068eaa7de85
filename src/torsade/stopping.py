"""Ctrl-C and SIGTERM, as batch systems send it: both stop a command the same way, with an exit code each."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["STOPPING", "Late", "Patience", "exit_code", "leave", "sigterm_stops"]

STOPPING = "stopping ... (Ctrl-C again to stop at once)"
"""What is said when the first of them was heard."""

_last = signal.SIGINT


def _heard(number: int) -> None:
    """Remember which signal stops this process."""
    global _last
    _last = signal.Signals(number)


def exit_code() -> int:
    """What a command that was stopped exits with: 130 after Ctrl-C, 143 after SIGTERM."""
    return 128 + _last


def _stop(number: int, frame: object) -> None:
    """Handle a signal as Ctrl-C is handled."""
    _heard(number)
    raise KeyboardInterrupt


def leave(number: int, frame: object) -> None:
    """Handle SIGTERM in a process that others give runs to: it ends, once a run has saved what there is."""
    raise SystemExit(128 + number)


def _ours(number: int) -> bool:
    """Whether nobody else handles this signal, so that a run may take it to stop between two steps."""
    plain = (signal.SIG_DFL, _stop, leave) if number == signal.SIGTERM else (signal.default_int_handler,)
    return signal.getsignal(number) in plain


@contextmanager
def sigterm_stops() -> Iterator[None]:
    """Meanwhile SIGTERM raises KeyboardInterrupt where it would end the process."""
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    signal.signal(signal.SIGTERM, _stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


class Late(KeyboardInterrupt):
    """Ctrl-C or SIGTERM that came when what had patience was about to end: all of that is done."""


class Patience:
    """While it lasts, Ctrl-C and SIGTERM wait for the next call of `end`: no step or write is cut in half.

    `told` is called at the first of them; a second one does not wait. One that comes after the last call of
    `end` is raised as `Late` when this is left, so that whatever was to come next is not begun. Handlers of
    others are left in place.
    """

    def __init__(self, told: Callable[[], None]) -> None:
        self._told = told
        self._asked = self._raised = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Patience:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if _ours(number):
                    self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        if self._asked and not self._raised and kind is None:
            raise Late

    def _note(self, number: int, frame: object) -> None:
        _heard(number)
        self.end()
        self._asked = True
        self._told()

    def end(self) -> None:
        """Raise KeyboardInterrupt if a signal has come."""
        if self._asked:
            self._raised = True
            raise KeyboardInterrupt
