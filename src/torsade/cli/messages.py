"""What goes wrong on the command line, in one sentence."""

from __future__ import annotations

import difflib
import re
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cyclopts import CycloptsError

__all__ = ["parse_error", "say"]

TOPOLOGY_OPTIONS = ("--pulled", "--drawings", "--direction", "--length-unit")
"""Options of `torsade topology` that take a value."""


def say(message: str) -> None:
    """Print one sentence on the standard error stream."""
    sentence = " ".join(message.split()).removesuffix(".")
    print(f"torsade: {sentence}{'' if sentence.endswith('?') else '.'}", file=sys.stderr)


def parse_error(error: CycloptsError, arguments: Sequence[str]) -> str:
    """What was given, what was expected and what to do, for a command line that cannot be read."""
    kind = type(error).__name__
    unused = list(getattr(error, "unused_tokens", None) or [])
    token = getattr(getattr(error, "token", None), "keyword", None)
    if kind == "UnknownOptionError" and token:
        return _unknown_option(str(token), arguments)
    if arguments[:1] == ["topology"]:
        return _about_topology(kind, unused, arguments)
    if kind == "UnknownCommandError" or (kind == "UnusedCliTokensError" and arguments[:1] != ["run"]):
        return _unknown_command(unused[0] if unused else arguments[0], arguments)
    if kind == "UnusedCliTokensError":
        if unused[0] in arguments[2:3]:
            option = "--centerline" if unused[0].endswith(".csv") else "--knot"
            return f"{unused[0]!r} comes without its option; did you mean {option} {unused[0]}?"
        return (
            f"{unused[0]!r} belongs to no option; give every value after its option, and quote values with "
            'units, such as --force "15 N"'
        )
    if kind == "MissingArgumentError":
        last = next((a for a in reversed(arguments) if a.startswith("--")), "an option")
        return f"{last} has no value; give one after it, such as {last} VALUE"
    if kind == "RepeatArgumentError":
        return f"{token or 'an option'} is given more than once; give it once"
    text = " ".join(str(error).split()).rstrip(".")
    return text.replace(". ", "; ") + "; see torsade --help"


def _about_topology(kind: str, unused: Sequence[str], arguments: Sequence[str]) -> str:
    """What `torsade topology` cannot read, other than unknown options."""
    if kind == "MissingArgumentError" and arguments[-1] in TOPOLOGY_OPTIONS:
        return f"{arguments[-1]} has no value; give one after it, such as {arguments[-1]} VALUE"
    if kind == "RepeatArgumentError":
        return "an option is given more than once; give each once"
    if unused:
        return f"{unused[0]!r} comes after what the command is about; quote names and codes that have spaces"
    return "nothing is given; give a name such as reef or 5_1, a code, or a CSV file"


def _unknown_option(option: str, arguments: Sequence[str]) -> str:
    from torsade.cli.app import OPTIONS, flag
    from torsade.protocols.files import PROTOCOLS

    command = " ".join(["torsade", *(a for a in arguments[:2] if not a.startswith("-"))])
    known = ["--help", "--version"]
    if arguments[:1] == ["demo"]:
        known = ["--out", "--json", "--help"]
        command = "torsade demo"
    elif arguments[:1] == ["topology"]:
        known = [*TOPOLOGY_OPTIONS, "--json", "--help"]
        command = "torsade topology"
    elif arguments[:1] == ["run"] and len(arguments) > 1 and arguments[1] in PROTOCOLS:
        spec = PROTOCOLS[arguments[1]]
        name = option.lstrip("-").replace("-", "_")
        if name in spec.hints:
            return re.sub(r"'(\w+)'", lambda m: flag(m[1]), spec.hints[name]).replace("field", "option")
        known = [flag(k) for k in spec.model_fields if k != "protocol"] + [flag(k) for k in OPTIONS]
    near = difflib.get_close_matches(option, known, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]}?" if near else f"see {command} --help"
    return f"{command.removeprefix('torsade ')} has no option {option}; {hint}"


def _unknown_command(word: str, arguments: Sequence[str]) -> str:
    from torsade.protocols.files import PROTOCOLS

    if arguments[:1] == ["run"] and word != "run":
        if word.endswith(".toml"):
            return f"{word!r} is not a protocol; give a file with --spec {word}"
        near = difflib.get_close_matches(word, PROTOCOLS, n=1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        return f"there is no protocol {word!r}; {hint}choose one of {', '.join(PROTOCOLS)}"
    if word in PROTOCOLS:
        return f"{word!r} is a protocol; give torsade run {word}"
    near = difflib.get_close_matches(word, ["demo", "run", "topology", "--help", "--version"], n=1)
    hint = f"did you mean {near[0]!r}?" if near else "choose demo, run or topology, or see torsade --help"
    what = "option" if word.startswith("-") else "command"
    return f"there is no {what} {word!r}; {hint}"
