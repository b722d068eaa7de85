"""Commands and their options; those of a protocol are made from its specification."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Group, Parameter

from torsade import __version__
from torsade.cli import fracture_app, results_app, sweep_app
from torsade.cli.knots_app import knots_app
from torsade.cli.messages import shown
from torsade.cli.movie_app import add_command as add_movie
from torsade.errors import TorsadeError
from torsade.units import said

if TYPE_CHECKING:
    from torsade.protocols.base import Spec

__all__ = ["OPTIONS", "build", "flag", "with_protocol"]

OPTIONS: dict[str, tuple[type, str]] = {
    "spec": (str, "TOML file with the fields above; options given here replace those in it."),
    "out": (str, "Write the result to this folder NAME.zarr while it runs."),
    "picture": (
        str,
        "Draw the last frame, or the last frame before slipping, to this PNG file, coloured by strain.",
    ),
    "plot": (str, "Plot the history to this file (.png, .pdf or .svg)."),
    "movie": (
        str,
        "Make a movie of 8 s in this file (.mp4 or .gif); torsade movie makes others of a result in --out.",
    ),
    "json": (bool, "Print the numbers as JSON, and nothing else, on the standard output."),
    "resume": (bool, "Go on with the --out of an interrupted run of the same specification."),
    "overwrite": (bool, "Replace an earlier result in --out."),
}
"""Options of every protocol besides the fields of its specification: type and help text."""

EXAMPLES = {
    "battery": "--knot 4_1 --twist 1.0 --out battery.zarr --picture battery.png --plot discharge.png",
    "prison-escape": '--knot reef --force "15 N" --out reef.zarr --picture reef.png',
    "bend-twist": '--length "24 cm" --end-distance "19 cm" --twist "270 deg" --plot bent.png',
    "pendulum": '--turn "45 deg" --mass "20 g" --out pendulum.zarr --plot pendulum.png',
    "snap-quench": '--speed "100 mm/s" --disorder 0.05 --seed 1 --out quench.zarr --plot quench.png',
    "snap-twist": '--twist "270 deg" --out snap.zarr --frames 200 --movie snap.mp4',
    "suture": "--throws 5,-3 --out surgeon.zarr --picture surgeon.png --plot wound.png",
    "tighten": '--knot overhand --duration "10 s" --until-still "1 um/s" --out overhand.zarr',
    "reidemeister": "--move R1 --out loop.zarr --plot loop.png",
}

TOPOLOGY_EXAMPLES = """Examples:

torsade topology reef

torsade topology zeppelin --pulled A1B0 --json

torsade topology 5,-3

torsade topology "m3_1#3_1"

torsade topology "X[1,5,2,4] X[3,1,4,6] X[5,3,6,2]"

torsade topology mine.csv --length-unit mm"""

CONVERT_EXAMPLES = """Examples:

torsade convert scan.xyz knot.csv --length-unit mm --smooth "0.1 mm" --spacing "0.1 mm"

torsade convert knot.csv knot.vtk"""

FIGURE_EXAMPLES = """Examples:

torsade figure

torsade figure 4-5

torsade figure 4-1 --out figures --preset standard"""

TIGHT_EXAMPLES = """Examples:

torsade tight 3_1

torsade tight whitehead --out whitehead.csv --picture whitehead.png

torsade tight 4_1 --ropelength 50 --radius "0.2 mm" --out loose.csv"""

_WHAT = Group("What to do", sort_key=1)
_OUTPUT = Group("Input and output", sort_key=2)


def flag(name: str) -> str:
    """The option of a field."""
    return "--" + name.replace("_", "-")


def build(arguments: list[str]) -> App:
    """The commands; those below `run` only when they are asked for, so that help comes at once."""
    app = App(
        name="torsade",
        help="Geometry, topology and mechanics of twisted elastic fibers.",
        help_epilogue="Begin with: torsade demo",
        version=__version__,
        help_format="plaintext",
        default_parameter=Parameter(negative=(), show_default=False),
        suppress_keyboard_interrupt=False,
    )
    app.command(_demo, name="demo", help_epilogue="", version_flags=[])
    app.command(_topology, name="topology", help_epilogue=TOPOLOGY_EXAMPLES, version_flags=[])
    app.command(_convert, name="convert", help_epilogue=CONVERT_EXAMPLES, version_flags=[])
    app.command(knots_app())
    app.command(_tight, name="tight", help_epilogue=TIGHT_EXAMPLES, version_flags=[])
    fracture_app.add_commands(app)
    results_app.add_commands(app)
    sweep_app.add_commands(app)
    add_movie(app)
    app.command(_figure, name="figure", help_epilogue=FIGURE_EXAMPLES, version_flags=[])
    run = App(
        name="run",
        help="Run an experiment: prison-escape (pull a bend), tighten (pull a knot in one strand), "
        "reidemeister (make a Reidemeister move), bend-twist (bend a twisted fiber), snap-twist (break a "
        "twisted rod), snap-quench (break a rod at speed), pendulum (a mass that turns on a rod), battery "
        "(cut a closed, twisted knot) or suture (close a wound with two throws).",
        help_epilogue="See the options with: torsade run prison-escape --help",
        version_flags=[],
    )
    app.command(run)
    if arguments[:1] == ["run"]:
        from torsade.protocols.files import PROTOCOLS

        for name, spec in PROTOCOLS.items():
            example = f"Example: torsade run {name} {EXAMPLES[name]}" if name in EXAMPLES else ""
            run.command(
                _protocol_command(spec), name=name, help=_about(spec), help_epilogue=example, version_flags=[]
            )
    return app


def _about(spec: type[Spec]) -> str:
    """The docstring of a specification with options in place of fields, one line to a paragraph."""
    text = re.sub(r"`(\w+)`", lambda m: flag(m[1]), inspect.getdoc(spec) or "")
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))


def with_protocol(arguments: list[str]) -> list[str]:
    """`run --spec FILE` names its protocol in the file: put it where a protocol is expected."""
    if arguments[:1] != ["run"] or len(arguments) < 2 or not arguments[1].startswith("--"):
        return arguments
    if arguments[1] == "--help":
        return arguments
    path = None
    for k, word in enumerate(arguments):
        if word == "--spec":
            path = "".join(arguments[k + 1 : k + 2])
        elif word.startswith("--spec="):
            path = word.removeprefix("--spec=")
    if path is None:
        from torsade.protocols.files import PROTOCOLS

        known = " or ".join(f"torsade run {name}" for name in PROTOCOLS)
        option = arguments[1].partition("=")[0]
        raise TorsadeError(f"{shown(option)} comes without a protocol; begin with {known}")
    if not path:
        raise TorsadeError("--spec has no value; give a TOML file after it, such as --spec reef.toml")
    from torsade.protocols.files import read_fields

    return ["run", read_fields(path)["protocol"], *arguments[1:]]


def _demo(
    *,
    out: Annotated[str, Parameter(help="Folder for the files, made when missing [default: demo].")] = "demo",
    json: Annotated[bool, Parameter(help=OPTIONS["json"][1])] = False,
) -> int:
    """Pull a reef knot at 15 N for 1 s; write the result, a picture and a plot, and print a table."""
    from torsade.cli.commands import demo

    return demo(out, json)


def _topology(
    given: Annotated[
        str,
        Parameter(
            name="NAME|CODE|FILE",
            allow_leading_hyphen=True,
            help="A name: a bend (reef, thief, carrick, zeppelin ...), a knot or link through 10 or 8 "
            "crossings (3_1, m3_1#4_1, L5a1, unknot), a suture (5,-3). Or a code: PD as X[1,5,2,4] "
            "X[3,1,4,6] ... or [[1,5,2,4],...], DT: 4 6 2, signed Gauss O1+ U2+ ..., unsigned Gauss: -1 2 "
            "..., a braid in braces {1,-2,1,-2} or after braid:, Conway notation in brackets [3 2] or after "
            "C. Or a file of curves (.csv, .xyz, .obj, .vect, .npz or .npy); a strand that ends with its "
            "first node is closed.",
        ),
    ],
    /,
    *,
    pulled: Annotated[
        str | None,
        Parameter(help="Ends of open strands towards which these run, such as A1B0 [default: the name's]."),
    ] = None,
    drawings: Annotated[
        str,
        Parameter(help="How many drawings to look at for the range of Gamma; 0 for none [default: 2000]."),
    ] = "2000",
    direction: Annotated[
        str | None,
        Parameter(
            help="From where a file is looked at: an axis, three numbers such as 1,0,0.5, or fewest, that of "
            "200 directions with fewest crossings [default: z]."
        ),
    ] = None,
    length_unit: Annotated[str, Parameter(help="Unit of x, y, z in a file [default: m].")] = "m",
    json: Annotated[bool, Parameter(help=OPTIONS["json"][1])] = False,
) -> int:
    """Say which knot, link or bend this is: crossings, signs, tau, Gamma, invariants and names.

    A right-handed crossing counts +1; linking numbers are half the sum of signs.

    Strands of a bend run towards the pulled ends.

    An m before a name takes the mirror image; 3_1 is right-handed.
    """
    from torsade.cli.topology import topology

    return topology(given, pulled, drawings, direction, length_unit, json)


def _convert(
    given: Annotated[str, Parameter(name="IN", help="File to read: .csv, .xyz, .obj, .vect, .npz or .npy.")],
    out: Annotated[str, Parameter(name="OUT", help="File to write: one of these, or .vtk.")],
    /,
    *,
    length_unit: Annotated[str, Parameter(help="Unit of x, y, z in IN [default: m]; OUT is in m.")] = "m",
    smooth: Annotated[
        str | None,
        Parameter(
            allow_leading_hyphen=True,
            help='Smooth away what is shorter than this length, such as "0.1 mm", as far as the knot stays '
            "the same.",
        ),
    ] = None,
    spacing: Annotated[
        str | None,
        Parameter(
            allow_leading_hyphen=True,
            help='Spread nodes evenly, at most so far apart, such as "0.1 mm" [default: as given].',
        ),
    ] = None,
    every: Annotated[
        str,
        Parameter(
            allow_leading_hyphen=True,
            help="Take every so many nodes only, where noise is larger than the distance of nodes "
            "[default: 1].",
        ),
    ] = "1",
    json: Annotated[bool, Parameter(help=OPTIONS["json"][1])] = False,
    overwrite: Annotated[bool, Parameter(help="Replace OUT where it exists.")] = False,
) -> int:
    """Read curves, smooth and resample them if asked to, and write them in another format.

    A strand passes through no other on the way: the knot stays what it is.
    """
    from torsade.cli.convert import convert

    return convert(given, out, length_unit, smooth, spacing, every, json, overwrite)


def _tight(
    given: Annotated[
        str,
        Parameter(
            name="NAME|CODE|FILE",
            allow_leading_hyphen=True,
            help="A knot or link by name (3_1, m5_2, 3_1#4_1, L5a1, borromean) or code, as for torsade "
            "topology, or a CSV file of closed strands.",
        ),
    ],
    /,
    *,
    ropelength: Annotated[
        str | None, Parameter(help="Stop where L/h has fallen to this number, such as 50.")
    ] = None,
    radius: Annotated[
        str | None,
        Parameter(help='Radius h of the fiber, such as "0.2 mm"; without it lengths are in radii.'),
    ] = None,
    nodes: Annotated[
        str | None, Parameter(help="Nodes of the result [default: one every fifth of the radius].")
    ] = None,
    tries: Annotated[
        str, Parameter(help="How many other shapes to look at, for a shorter one [default: 14].")
    ] = "14",
    out: Annotated[str | None, Parameter(help="Write the nodes to this CSV file.")] = None,
    picture: Annotated[str | None, Parameter(help="Draw the tight knot to this PNG file.")] = None,
    json: Annotated[bool, Parameter(help=OPTIONS["json"][1])] = False,
) -> int:
    """Pull a knot or link tight: the shortest closed fiber that makes it, its ropelength L/h and its writhe.

    L/h is length over radius; over the diameter it is half as much. It is an upper bound of the ropelength.
    """
    from torsade.cli.tight import tight

    return tight(given, ropelength, radius, nodes, tries, out, picture, json)


def _figure(
    number: Annotated[
        str | None,
        Parameter(
            name="NUMBER", help="Number of the figure in the thesis, such as 4-5; without it they are listed."
        ),
    ] = None,
    /,
    *,
    out: Annotated[
        str,
        Parameter(
            help="Folder for the picture, the tables and, in runs/ and sweeps/, what they come from, which "
            "other figures use too [default: figures]."
        ),
    ] = "figures",
    preset: Annotated[
        str, Parameter(help="Model: standard, published, or both, side by side [default: both].")
    ] = "both",
    quick: Annotated[
        bool, Parameter(help="Short and coarse runs, for a look: not the numbers of the docs.")
    ] = False,
    fresh: Annotated[
        bool, Parameter(help="Run everything anew; by default stored results are used.")
    ] = False,
    workers: Annotated[str | None, Parameter(help="Runs at a time [default: the number of cores].")] = None,
    json: Annotated[bool, Parameter(help=OPTIONS["json"][1])] = False,
) -> int:
    """Make a figure of the thesis from runs of this package: a picture, and tables of its numbers as CSV.

    Runs that are stored already are not run again.
    """
    from torsade.cli import figure

    return (
        figure.show_all(json)
        if number is None
        else figure.draw(number, out, preset, quick, fresh, workers, json)
    )


def _protocol_command(spec: type[Spec]) -> Callable[..., int]:
    """A command with one option for every field of a specification, and `OPTIONS`."""

    def command(**given: Any) -> int:
        from torsade.cli.commands import run

        chosen = {name: value for name, value in given.items() if value is not None}
        options = {name: chosen.pop(name, None) for name in OPTIONS}
        return run(spec, chosen, **options)

    parameters = [
        _option(name, str, _help(spec, name), _WHAT) for name in _ordered(spec) if name != "protocol"
    ]
    parameters += [_option(name, kind, text, _OUTPUT) for name, (kind, text) in OPTIONS.items()]
    command.__signature__ = inspect.Signature(parameters, return_annotation=int)  # type: ignore[attr-defined]
    command.__annotations__ = {p.name: p.annotation for p in parameters} | {"return": int}
    return command


def _ordered(spec: type[Spec]) -> list[str]:
    """Fields of the protocol itself first, those that all protocols have last."""
    by_class = [name for cls in spec.__mro__ for name in vars(cls).get("__annotations__", {})]
    return [name for name in dict.fromkeys(by_class) if name in spec.model_fields]


def _option(name: str, kind: type, text: str, group: Group) -> inspect.Parameter:
    # Directions such as -x begin with a hyphen, and so do negative numbers that are to be refused.
    parameter = Parameter(name=flag(name), help=text, group=group, allow_leading_hyphen=kind is str)
    annotation = Annotated[kind | None, parameter] if kind is str else Annotated[kind, parameter]
    return inspect.Parameter(
        name,
        inspect.Parameter.KEYWORD_ONLY,
        default=None if kind is str else False,
        annotation=annotation,
    )


def _help(spec: type[Spec], name: str) -> str:
    """Description of a field, with an example of its unit and its default."""
    from torsade.protocols.sentences import dimension_of

    field = spec.model_fields[name]
    dimension = dimension_of(field)
    meaning, _, rest = (field.description or "").rstrip(".").partition("; ")
    if dimension is not None:
        example = field.examples[0] if field.examples else dimension.example
        meaning += f', such as "{example}"' if dimension.unit else f", such as {example}"
    text = f"{meaning}; {rest}" if rest else meaning
    if field.default is None or field.is_required():
        return text + "."
    shown = said(field.default, dimension) if dimension else str(field.default)
    return f"{text} [default: {shown}]."
