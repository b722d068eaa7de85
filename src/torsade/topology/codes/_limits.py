"""How large a code may be: a slip of the keyboard must not fill the memory, nor take the day."""

from __future__ import annotations

from torsade.errors import TorsadeError

__all__ = ["MOST", "limited"]

MOST = 500
"""Most crossings, and most strands, that a code may have."""


def limited(number: int, what: str, kind: str) -> None:
    """Refuse a code with more crossings or strands than are read.

    >>> limited(501, "strands", "braid word")
    Traceback (most recent call last):
        ...
    torsade.errors.TorsadeError: the braid word has more than 500 strands; give at most so many
    """
    if number > MOST:
        raise TorsadeError(f"the {kind} has more than {MOST} {what}; give at most so many")
