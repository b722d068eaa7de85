"""Which frames are meant: one, a range of them, or all."""

from __future__ import annotations

import re

from torsade.errors import TorsadeError, quoted
from torsade.view.strands import frame_index

__all__ = ["chosen"]

_NUMBER = r"-?\d{1,9}"
_RANGE = re.compile(rf"({_NUMBER})?:({_NUMBER})?(?::({_NUMBER})?)?", re.A)


def chosen(wanted: str | int | slice | None, frames: int, usual: slice | int) -> range:
    """Numbers of frames, from 0.

    Parameters
    ----------
    wanted : a number, counted from the end where it is negative; a slice, or text such as "10", "-1",
        "0:50:5" or "all"; None for the usual ones
    frames : how many there are

    Raises
    ------
    TorsadeError
        When it is none of these, or none of them is there.
    """
    if wanted is None:
        wanted = usual
    if isinstance(wanted, str):
        wanted = _read(wanted.strip())
    if isinstance(wanted, int):
        frame = frame_index(wanted, frames)
        return range(frame, frame + 1)
    if wanted.step == 0:
        raise TorsadeError("frames are asked for in steps of 0; give a step of 1 or more, such as 0:100:10")
    found = range(frames)[wanted]
    if not found:
        raise TorsadeError(f"none of the {frames} frames, numbered from 0, is among those asked for")
    return found


def _read(text: str) -> int | slice:
    if text == "all":
        return slice(None)
    if re.fullmatch(_NUMBER, text, re.A):
        return int(text)
    if found := _RANGE.fullmatch(text):
        return slice(*(None if part is None else int(part) for part in found.groups()))
    raise TorsadeError(
        f"frames are {quoted(text)}; give a number such as 10 or -1, a range such as 0:100:10, or all"
    )
