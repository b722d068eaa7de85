"""What goes wrong on the command line, in one sentence."""

from __future__ import annotations

import difflib
import re
import sys
from collections.abc import Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from torsade.errors import quoted

if TYPE_CHECKING:
    from cyclopts import CycloptsError

__all__ = ["first_words", "parse_error", "say", "shown"]


class _Command(NamedTuple):
    """A command that is not made from a specification: its options, and what to say.

    Attributes:
        valued: options that take a value.
        switches: those that take none.
        nothing: what to say where nothing is given.
        more: what to say of a word too many.
    """

    valued: tuple[str, ...]
    switches: tuple[str, ...]
    nothing: str
    more: str


_QUOTE = "{} comes after what the command is about; quote names and codes that have spaces"

_RESULT = "{} comes after the result; give one folder at a time, and every value after its option"
_NO_RESULT = "no result is given; give a folder that a run wrote, such as reef.zarr"
_NO_EXPORT = "export needs a result and what to export to, such as torsade export reef.zarr --to vtk"

COMMANDS = MappingProxyType(
    {
        "topology": _Command(
            ("--pulled", "--drawings", "--direction", "--length-unit"),
            ("--json",),
            "nothing is given; give a name such as reef or 5_1, a code, or a file of curves",
            _QUOTE,
        ),
        "tight": _Command(
            ("--ropelength", "--radius", "--nodes", "--tries", "--out", "--picture"),
            ("--json",),
            "nothing is given; give a closed knot or link such as 3_1 or L5a1, a code, or a file of curves",
            _QUOTE,
        ),
        "convert": _Command(
            ("--length-unit", "--smooth", "--spacing", "--every"),
            ("--json", "--overwrite"),
            "convert takes two files; give one to read and one to write, such as scan.xyz knot.csv",
            "{} comes after both files; give one to read and one to write",
        ),
        "trials": _Command(
            (
                "--length",
                "--radius",
                "--material",
                "--strength",
                "--criterion",
                "--amplification",
                "--sectors",
                "--rays",
                "--slow",
            ),
            ("--json",),
            "nothing is given; give a CSV file of trials, such as trials.csv",
            _QUOTE,
        ),
        "material": _Command(
            (
                "--radius",
                "--radius-error",
                "--buckling",
                "--weights",
                "--pendulum",
                "--inertia",
                "--inertia-error",
                "--mass-height",
            ),
            ("--json",),
            'the radius is not given; give --radius, such as --radius "0.7 mm"',
            "{} belongs to no option; give every value after its option, and quote values with units",
        ),
        "figure": _Command(
            ("--out", "--preset", "--workers"),
            ("--quick", "--fresh", "--json"),
            "",
            "{} comes after the number; make one figure at a time, such as torsade figure 4-5",
        ),
        "sweep": _Command(
            ("--out", "--workers", "--scheduler", "--at-most"),
            ("--retry-failed", "--keep", "--dry-run", "--json"),
            "nothing is given; give a TOML file, such as pieces.toml",
            "{} comes after the file; give one file, and every value after its option",
        ),
        "query": _Command(
            (),
            ("--csv", "--json"),
            "nothing is given; give the folder of a sweep, such as pieces",
            "{} comes after the query; put the whole query in one pair of quotes",
        ),
        "info": _Command((), ("--json", "--salvage"), _NO_RESULT, _RESULT),
        "export": _Command(
            ("--to", "--frames", "--out"), ("--json", "--overwrite", "--salvage"), _NO_EXPORT, _RESULT
        ),
        "open": _Command(("--frame", "--picture", "--plot"), ("--json", "--salvage"), _NO_RESULT, _RESULT),
        "movie": _Command(
            ("--out", "--seconds", "--fps", "--size", "--frames", "--colour"),
            ("--whole", "--json"),
            "nothing is given; give the result of a run, such as snap.zarr",
            "{} comes after the result; give one result at a time, such as torsade movie snap.zarr",
        ),
        "knots list": _Command(("--kind",), ("--json",), "", _QUOTE),
        "knots show": _Command((), ("--json",), "nothing is given; give a name such as reef or 5_1", _QUOTE),
        "knots build": _Command(
            ("--out", "--radius", "--length", "--lead", "--tail", "--spacing", "--pulled", "--picture"),
            ("--json", "--overwrite"),
            "nothing is given; give a name such as reef or 5_1, or a code",
            _QUOTE,
        ),
    }
)
"""By their words in the shell."""

MEANT = MappingProxyType(dict.fromkeys(("plot", "draw", "view", "show"), "open"))
"""Commands by words that are likely to be tried for them."""


def first_words() -> list[str]:
    """The commands that there are, in the order of the alphabet."""
    from torsade.cli.app import build

    return sorted(name for name in build([]) if not name.startswith("-"))


def _command(arguments: Sequence[str]) -> str | None:
    """Which of `COMMANDS` is given."""
    words = (" ".join(arguments[:2]), *arguments[:1])
    return next((word for word in words if word in COMMANDS), None)


def say(message: str) -> None:
    """Print one sentence on the standard error stream."""
    sentence = " ".join(message.split()).removesuffix(".")
    # What a file or an argument holds must not steer the terminal.
    sentence = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in sentence)
    print(f"torsade: {sentence}{'' if sentence.endswith('?') else '.'}", file=sys.stderr)


def parse_error(error: CycloptsError, arguments: Sequence[str]) -> str:
    """What was given, what was expected and what to do, for a command line that cannot be read."""
    kind = type(error).__name__
    unused = list(getattr(error, "unused_tokens", None) or [])
    token = getattr(getattr(error, "token", None), "keyword", None)
    if kind == "UnknownOptionError" and token:
        return _unknown_option(str(token), arguments)
    if name := _command(arguments):
        return _about(COMMANDS[name], kind, unused, arguments)
    if kind == "UnknownCommandError" or (kind == "UnusedCliTokensError" and arguments[:1] != ["run"]):
        return _unknown_command(unused[0] if unused else arguments[0], arguments)
    if kind == "UnusedCliTokensError":
        if unused[0] in arguments[2:3] and (option := _meant(unused[0], arguments[1])):
            return f"{quoted(unused[0])} comes without its option; did you mean {option} {shown(unused[0])}?"
        if whole := _parted(unused[0], arguments):
            return f"{quoted(unused[0])} belongs to the value before it; did you mean {whole}?"
        return (
            f"{quoted(unused[0])} belongs to no option; give every value after its option, and quote values "
            'with units, such as --force "15 N"'
        )
    if kind == "MissingArgumentError":
        last = shown(next((a for a in reversed(arguments) if a.startswith("--")), "an option"))
        return f"{last} has no value; give one after it, such as {last} VALUE"
    if kind == "RepeatArgumentError":
        return f"{token or 'an option'} is given more than once; give it once"
    text = " ".join(str(error).split()).rstrip(".")
    return text.replace(". ", "; ") + "; see torsade --help"


def _meant(word: str, protocol: str) -> str | None:
    """The option that a word alone after a protocol belongs to: what the protocol cannot do without."""
    from torsade.cli.app import flag
    from torsade.files import SUFFIXES
    from torsade.protocols.files import PROTOCOLS

    fields = PROTOCOLS[protocol].model_fields if protocol in PROTOCOLS else {}
    needed = [name for name, field in fields.items() if field.is_required() and name != "protocol"]
    if word.lower().endswith(SUFFIXES):
        needed.insert(0, "centerline")
    return next((flag(name) for name in (*needed, "knot") if name in fields), None)


def _parted(word: str, arguments: Sequence[str]) -> str | None:
    """The option with its whole value, where a word is the rest of one: a unit, or the second throw."""
    k = list(arguments).index(word) if word in arguments else 0
    option, value = arguments[max(k - 2, 0)], arguments[k - 1]
    if not re.fullmatch(r"--[a-z-]+", option, re.I) or not re.fullmatch(
        r"[+-]?[\d.]+(e[+-]?\d+)?,?", value, re.A
    ):
        return None
    if option == "--throws" and re.fullmatch(r"[+-]?\d+", word, re.A):
        return f"{option} {value.rstrip(',')},{word}"
    return f'{option} "{value} {word}"' if re.fullmatch(r"[^\W\d][\w/^ ]{0,20}|[%°]", word) else None


def shown(word: str) -> str:
    """A word as it was typed, or quoted where it is long or strange."""
    return word if re.fullmatch(r"[\w./=-]{1,60}", word) and word.isprintable() else quoted(word)


def _about(command: _Command, kind: str, unused: Sequence[str], arguments: Sequence[str]) -> str:
    """What one of `COMMANDS` cannot read, other than unknown options."""
    if kind == "MissingArgumentError" and arguments[-1] in command.valued:
        return f"{arguments[-1]} has no value; give one after it, such as {arguments[-1]} VALUE"
    if kind == "RepeatArgumentError":
        return "an option is given more than once; give each once"
    if unused and unused[0].startswith("--"):
        return _unknown_option(unused[0].partition("=")[0], arguments)
    return command.more.format(quoted(unused[0])) if unused else command.nothing


def _unknown_option(option: str, arguments: Sequence[str]) -> str:
    from torsade.cli.app import OPTIONS, flag
    from torsade.protocols.files import PROTOCOLS

    command = " ".join(["torsade", *(shown(a) for a in arguments[:2] if not a.startswith("-"))])
    known = ["--help", "--version"]
    if arguments[:1] == ["demo"]:
        known = ["--out", "--json", "--help"]
        command = "torsade demo"
    elif name := _command(arguments):
        known = [*COMMANDS[name].valued, *COMMANDS[name].switches, "--help"]
        command = f"torsade {name}"
    elif arguments[:1] == ["run"] and len(arguments) > 1 and arguments[1] in PROTOCOLS:
        spec = PROTOCOLS[arguments[1]]
        name = option.lstrip("-").replace("-", "_")
        if name in spec.hints:
            return re.sub(r"'(\w+)'", lambda m: flag(m[1]), spec.hints[name]).replace("field", "option")
        known = [flag(k) for k in spec.model_fields if k != "protocol"] + [flag(k) for k in OPTIONS]
    longer = [name for name in known if name.startswith(f"{option}-")]
    near = longer or difflib.get_close_matches(option, known, n=1, cutoff=0.6)
    hint = f"did you mean {' or '.join(near)}?" if near else f"see {command} --help"
    return f"{command.removeprefix('torsade ')} has no option {shown(option)}; {hint}"


def _unknown_command(word: str, arguments: Sequence[str]) -> str:
    from torsade.protocols.files import PROTOCOLS

    if arguments[:1] == ["run"] and word != "run":
        if word.endswith(".toml"):
            return f"{word!r} is not a protocol; give a file with --spec {word}"
        near = difflib.get_close_matches(word, PROTOCOLS, n=1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        return f"there is no protocol {quoted(word)}; {hint}choose one of {', '.join(PROTOCOLS)}"
    if word in PROTOCOLS:
        return f"{word!r} is a protocol; give torsade run {word}"
    if arguments[:1] == ["knots"] and word != "knots":
        return f"there is no command {quoted('knots ' + word)}; choose knots list, knots show or knots build"
    first = first_words()
    near = (
        [MEANT[word]]
        if word in MEANT
        else difflib.get_close_matches(word, [*first, "--help", "--version"], n=1)
    )
    known = f"choose {', '.join(first[:-1])} or {first[-1]}, or see torsade --help"
    hint = f"did you mean {near[0]!r}?" if near else known
    what = "option" if word.startswith("-") else "command"
    return f"there is no {what} {quoted(word)}; {hint}"
