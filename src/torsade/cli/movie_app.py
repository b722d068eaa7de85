"""The command `torsade movie` and its options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import App, Parameter

__all__ = ["add_command"]

EXAMPLES = """Examples:

torsade movie snap.zarr

torsade movie reef.zarr --out reef.gif --size 640x360 --fps 15 --seconds 6

torsade movie snap.zarr --frames 0:80 --colour strands --seconds 12"""


def add_command(app: App) -> None:
    """Add it."""
    app.command(_movie, name="movie", help_epilogue=EXAMPLES, version_flags=[])


def _movie(
    result: Annotated[
        str, Parameter(name="RESULT", help="Result of a run that goes on in time: a folder NAME.zarr.")
    ],
    /,
    *,
    out: Annotated[
        str | None,
        Parameter(
            name=("--out", "-o"), help="File to write, .mp4 or .gif [default: NAME.mp4 beside the result]."
        ),
    ] = None,
    seconds: Annotated[str, Parameter(help="How long the movie lasts [default: 8].")] = "8",
    fps: Annotated[str, Parameter(help="Pictures a second [default: 30].")] = "30",
    size: Annotated[
        str,
        Parameter(help="Width and height in pixels, rounded to multiples of 16 [default: 1280x720]."),
    ] = "1280x720",
    frames: Annotated[
        str | None,
        Parameter(
            allow_leading_hyphen=True,
            help="First and last stored frame to show, such as 0:80, from 0, or from the last one if "
            "negative [default: all, or from just before the first break on].",
        ),
    ] = None,
    colour: Annotated[
        str | None,
        Parameter(
            help="What colours say: strain, stress (over strength), energy (per length, of batteries), or "
            "strands, one colour for each strand or piece [default: stress of rods that break, energy of "
            "batteries, else strain]."
        ),
    ] = None,
    whole: Annotated[bool, Parameter(help="Hold all of every fiber in view, not the knot alone.")] = False,
    json: Annotated[bool, Parameter(help="Print JSON, and nothing else, on the standard output.")] = False,
) -> int:
    """Make a movie of a result: a knot being pulled, a rod that breaks, whatever was recorded in time.

    Time runs evenly, of batteries ever faster; between stored frames nodes move straight: record more of them
    with --frames.

    Rods that break are drawn three times as thick as they are.
    """
    from torsade.cli.movie import make

    return make(result, out, seconds, fps, size, frames, colour, whole, json)
