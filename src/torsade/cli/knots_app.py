"""The commands below `torsade knots` and their options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import App, Parameter

__all__ = ["ABOUT", "knots_app"]

ABOUT = "The catalogue: list, show and build bends, knots in one strand, sutures, closed knots and links."

LIST_EXAMPLES = """Examples:

torsade knots list

torsade knots list butterfly

torsade knots list --kind suture --json"""

SHOW_EXAMPLES = """Examples:

torsade knots show zeppelin

torsade knots show 8_19

torsade knots show "surgeon's knot\""""

BUILD_EXAMPLES = """Examples:

torsade knots build zeppelin --out zeppelin.csv --picture zeppelin.png

torsade knots build 8_19 --radius "1 mm" --length "20 cm" --out 8_19.csv

torsade knots build "{1,-2,1,-2}" --out mine.obj"""

_NAME = (
    "Name, alias or code: reef, overhand, overhand-7, 3_1, m3_1#4_1, L5a1, T(3,4), 5,-3, alpine24, "
    "'mirror granny', 'open 5_2', or any code that torsade topology reads."
)
_JSON = "Print JSON, and nothing else, on the standard output."


def knots_app() -> App:
    """The commands."""
    app = App(name="knots", help=ABOUT, help_epilogue=LIST_EXAMPLES, version_flags=[])
    app.command(_list, name="list", help_epilogue=LIST_EXAMPLES, version_flags=[])
    app.command(_show, name="show", help_epilogue=SHOW_EXAMPLES, version_flags=[])
    app.command(_build, name="build", help_epilogue=BUILD_EXAMPLES, version_flags=[])
    return app


def _list(
    text: Annotated[str, Parameter(name="TEXT", help="Part of a name or alias [default: all].")] = "",
    /,
    *,
    kind: Annotated[
        str | None,
        Parameter(help="Only bend, strand, suture, torus, closed, link or variant [default: all]."),
    ] = None,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
) -> int:
    """List what there is by name."""
    from torsade.cli.knots import list_knots

    return list_knots(text, kind, json)


def _show(
    given: Annotated[str, Parameter(name="NAME", allow_leading_hyphen=True, help=_NAME)],
    /,
    *,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
) -> int:
    """Show what is known of a knot: other names, codes, what is counted for each pull, and sources."""
    from torsade.cli.knots import show_knot

    return show_knot(given, json)


def _build(
    given: Annotated[str, Parameter(name="NAME", allow_leading_hyphen=True, help=_NAME)],
    /,
    *,
    out: Annotated[
        str | None, Parameter(help="File for the fiber: .csv, .xyz, .obj, .vect, .npz, .npy or .vtk.")
    ] = None,
    radius: Annotated[str | None, Parameter(help='Fiber radius h [default: "0.2 mm"].')] = None,
    length: Annotated[
        str | None,
        Parameter(
            help="Length of a closed knot, or of a knot in one strand [default: the shortest loose one]."
        ),
    ] = None,
    lead: Annotated[
        str | None,
        Parameter(help="Fiber from the knot to its clamped and to its pulled end [default: 16 radii]."),
    ] = None,
    tail: Annotated[str | None, Parameter(help="Length of free ends [default: 25 radii].")] = None,
    spacing: Annotated[
        str | None, Parameter(help="Greatest distance of nodes along the fiber [default: half a radius].")
    ] = None,
    pulled: Annotated[
        str | None, Parameter(help="Clamped end, then pulled end, such as A1B0 [default: the name's].")
    ] = None,
    picture: Annotated[str | None, Parameter(help="Draw the fiber to this PNG file.")] = None,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
    overwrite: Annotated[bool, Parameter(help="Replace --out where it exists.")] = False,
) -> int:
    """Make a loose, smooth fiber of a knot, ready to be simulated, and check that it is this knot."""
    from torsade.cli.knots import build_knot

    lengths = {"radius": radius, "length": length, "lead": lead, "tail": tail, "spacing": spacing}
    return build_knot(given, out, lengths, pulled, picture, json, overwrite)
