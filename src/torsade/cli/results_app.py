"""The commands about stored results: `torsade info`, `torsade export`, `torsade open`, their options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import App, Parameter

__all__ = ["add_commands"]

INFO_EXAMPLES = """Examples:

torsade info reef.zarr

torsade info reef.zarr --json"""

EXPORT_EXAMPLES = """Examples:

torsade export reef.zarr --to vtk

torsade export reef.zarr --to gltf --frames -1 --out reef.glb

torsade export reef.zarr --to csv --frames 0:100:10"""

OPEN_EXAMPLES = """Examples:

torsade open reef.zarr

torsade open reef.zarr --frame 10 --picture reef.png

torsade open reef.zarr --plot reef-speed.pdf"""

_JSON = "Print JSON, and nothing else, on the standard output."
_SALVAGE = "Where files of numbers are lost, take the frames before."
_RESULT = "A result: NAME.zarr, or NAME.zarr.part of a run that goes on or was interrupted."


def add_commands(app: App) -> None:
    """Add all three."""
    app.command(_info, name="info", help_epilogue=INFO_EXAMPLES, version_flags=[])
    app.command(_export, name="export", help_epilogue=EXPORT_EXAMPLES, version_flags=[])
    app.command(_open, name="open", help_epilogue=OPEN_EXAMPLES, version_flags=[])


def _info(
    given: Annotated[str, Parameter(name="RESULT", help=_RESULT)],
    /,
    *,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
    salvage: Annotated[bool, Parameter(help=_SALVAGE)] = False,
) -> int:
    """Say what a result holds: what was run, how far it came, its numbers, where they come from.

    Where there is no NAME.zarr yet, NAME.zarr.part is looked at.
    """
    from torsade.cli.results import info

    return info(given, json, salvage)


def _export(
    given: Annotated[str, Parameter(name="RESULT", help=_RESULT)],
    /,
    *,
    to: Annotated[
        str,
        Parameter(
            help="vtk (a .pvd list of frames, for ParaView), gltf (a .glb of one frame, for browsers and "
            "Blender), csv (histories, samples and nodes of the last frame asked for) or npz (all arrays)."
        ),
    ],
    frames: Annotated[
        str | None,
        Parameter(
            allow_leading_hyphen=True,
            help="Which frames: a number such as 10 or -1, a range such as 0:100:10, or all [default: all; "
            "of gltf the last one, or the last before slipping].",
        ),
    ] = None,
    out: Annotated[
        str | None,
        Parameter(
            name=("--out", "-o"),
            help="File to write, ending in .pvd, .glb, .csv or .npz [default: NAME with that ending, beside "
            "the result].",
        ),
    ] = None,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
    overwrite: Annotated[bool, Parameter(help="Replace files that exist.")] = False,
    salvage: Annotated[bool, Parameter(help=_SALVAGE)] = False,
) -> int:
    """Write a result for other programs.

    Lengths are in m, times in s. Rods that broke are written in their pieces.
    """
    from torsade.cli.results import export

    return export(given, to, frames, out, json, overwrite, salvage)


def _open(
    given: Annotated[str, Parameter(name="RESULT", help=_RESULT)],
    /,
    *,
    frame: Annotated[
        str | None,
        Parameter(
            allow_leading_hyphen=True,
            help="Frame to show first, or to draw; counted from the end where it is negative [default: the "
            "last one, or the last before slipping].",
        ),
    ] = None,
    picture: Annotated[
        str | None, Parameter(help="Draw to this PNG file, in place of opening a window.")
    ] = None,
    plot: Annotated[
        str | None,
        Parameter(help="Plot the history to this file (.png, .pdf or .svg), in place of opening a window."),
    ] = None,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
    salvage: Annotated[bool, Parameter(help=_SALVAGE)] = False,
) -> int:
    """Show the frames of a result in a window that can be turned, draw one of them, or plot its history.

    Drag to turn, scroll to come nearer; the slider, Left and Right go through the frames; Q closes.
    """
    from torsade.cli.results import show

    return show(given, frame, picture, plot, json, salvage)
