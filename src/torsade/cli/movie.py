"""What `torsade movie` does: reads its options, and makes a movie of a stored result."""

from __future__ import annotations

import json as json_format
import re
from pathlib import Path

from torsade.cli.commands import check_drawings, progress
from torsade.errors import TorsadeError, quoted
from torsade.stopping import Late

__all__ = ["make"]


def make(
    result: str,
    out: str | None,
    seconds: str,
    fps: str,
    size: str,
    frames: str | None,
    colour: str | None,
    whole: bool,
    json: bool,
) -> int:
    """Make one movie."""
    from torsade.results import Result
    from torsade.view import film

    lasting, rate = _number("--seconds", seconds, "8"), _number("--fps", fps, "30")
    asked = _pair("--size", size, r"(\d{1,5})[x×](\d{1,5})", "1280x720")
    between = None if frames is None else _pair("--frames", frames, r"(-?\d{1,9}):(-?\d{1,9})", "0:80")
    if colour is not None and colour not in film.COLOURS:
        raise TorsadeError(f"--colour is {quoted(colour)}; give one of {', '.join(film.COLOURS)}")
    if out is not None:
        check_drawings(None, None, out)
    dataset = Result.open(result).dataset
    # A result may be the present folder, whose name only the system knows.
    named = Path(result) if Path(result).name else Path(result).resolve()
    path = str(named.with_suffix(".mp4")) if out is None else out
    check_drawings(None, None, path)
    try:
        with progress(json) as shown:
            film.movie(
                dataset, path, seconds=lasting, fps=rate, size=asked, frames=between, colour=colour,
                whole=whole, progress=shown,
            )  # fmt: skip
    except Late:
        raise KeyboardInterrupt(f"interrupted; {path!r} is complete") from None
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted; no movie is written") from None
    if json:
        width, height = film.sides(asked)
        found = {"movie": path, "size": [width, height], "seconds": lasting, "fps": rate}
        print(json_format.dumps(found, allow_nan=False), flush=True)
        return 0
    from torsade.cli.table import print_file

    print_file("movie", path)
    return 0


def _number(option: str, text: str, example: str) -> float:
    if not re.fullmatch(r"\d{1,5}(\.\d{0,6})?", text, re.A):
        raise TorsadeError(f"{option} is {quoted(text)}; give a number such as {example}")
    return float(text)


def _pair(option: str, text: str, pattern: str, example: str) -> tuple[int, int]:
    found = re.fullmatch(pattern, text, re.A)
    if found is None:
        raise TorsadeError(f"{option} is {quoted(text)}; give two whole numbers such as {example}")
    return int(found[1]), int(found[2])
