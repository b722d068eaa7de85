"""Ctrl-C and SIGTERM, as batch systems send it: both stop a command the same way, with an exit code each."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["by_sigterm", "exit_code", "heard", "ours", "sigterm_stops", "stop"]

_last = signal.SIGINT


def heard(number: int) -> None:
    """Remember which signal stops this process."""
    global _last
    _last = signal.Signals(number)


def exit_code() -> int:
    """What a command that was stopped exits with: 130 after Ctrl-C, 143 after SIGTERM."""
    return 128 + _last


def by_sigterm() -> bool:
    """Whether it was SIGTERM that stopped this process."""
    return _last == signal.SIGTERM


def stop(number: int, frame: object) -> None:
    """Handle a signal as Ctrl-C is handled."""
    heard(number)
    raise KeyboardInterrupt


def ours(number: int) -> bool:
    """Whether nobody else handles this signal, so that a run may take it to stop between two steps."""
    plain = (signal.SIG_DFL, stop) if number == signal.SIGTERM else (signal.default_int_handler,)
    return signal.getsignal(number) in plain


@contextmanager
def sigterm_stops() -> Iterator[None]:
    """Meanwhile SIGTERM raises KeyboardInterrupt where it would end the process."""
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
