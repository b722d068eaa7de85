"""The one error that users are meant to read."""

from __future__ import annotations


class TorsadeError(ValueError):
    """Bad input or an unreachable request, said in one sentence.

    The message says what was given, what was expected and what to do. The command line prints it
    without a traceback and exits with code 2.
    """
