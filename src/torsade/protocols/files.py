"""Specifications in TOML files: `protocol = "prison-escape"`, then fields, with units in text.

protocol = "prison-escape"
knot = "reef"
force = "15 N"
"""

from __future__ import annotations

import difflib
import re
import tomllib
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

from torsade.errors import TorsadeError, named, quoted
from torsade.protocols.base import Spec
from torsade.protocols.battery import Battery
from torsade.protocols.bend_twist import BendTwist
from torsade.protocols.pendulum import Pendulum
from torsade.protocols.prison_escape import PrisonEscape
from torsade.protocols.reidemeister import Reidemeister
from torsade.protocols.snap_quench import SnapQuench
from torsade.protocols.snap_twist import SnapTwist
from torsade.protocols.suture import Suture
from torsade.protocols.tighten import Tighten

__all__ = ["PROTOCOLS", "beside", "check_protocol", "load_spec", "merged", "read_fields", "read_toml"]

PROTOCOLS: MappingProxyType[str, type[Spec]] = MappingProxyType(
    {
        "prison-escape": PrisonEscape,
        "tighten": Tighten,
        "reidemeister": Reidemeister,
        "bend-twist": BendTwist,
        "snap-twist": SnapTwist,
        "snap-quench": SnapQuench,
        "pendulum": Pendulum,
        "battery": Battery,
        "suture": Suture,
    }
)
"""The specification of every protocol, by name."""

LARGEST = 2**20
"""Largest specification or sweep that is read [bytes]."""

_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{32}}", re.A)
"""A key of very many parts: reading one takes a time that goes as their square."""

_REPLACES = MappingProxyType(
    {
        "knot": ("centerline", "length_unit", "smooth"),
        "centerline": ("knot", "lead", "tail"),
        "tolerance": ("fixed_step",),
        "fixed_step": ("tolerance",),
    }
)
"""What a field that is given leaves no room for."""


def load_spec(path: str | Path) -> Spec:
    """Read a specification from a TOML file.

    A relative `centerline` is looked for beside the file, then from the present folder.

    Raises
    ------
    TorsadeError
        When the file is missing or not TOML, names no known protocol, or has a field that is unknown
        (the nearest is named) or unfit.
    """
    fields = read_fields(path)
    return PROTOCOLS[fields["protocol"]](**fields)


def read_fields(path: str | Path) -> dict[str, Any]:
    """The fields in a TOML file, `protocol` among them and known, the others as they are."""
    fields = read_toml(path)
    check_protocol(fields.get("protocol"), named(path))
    if "centerline" in fields:
        fields["centerline"] = beside(path, fields["centerline"])
    return fields


def read_toml(path: str | Path) -> dict[str, Any]:
    """What is in a TOML file.

    Raises
    ------
    TorsadeError
        When the file is missing, cannot be read or is not TOML.
    """
    from torsade.files.regular import Kind, opened

    name = named(path)
    kind = Kind("fields", "reef.toml", "a specification", "leave out what is no field", "one field")
    with opened(Path(path), kind) as (file, _):
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise TorsadeError(f"{name} has more than {LARGEST} bytes; give a TOML specification")
    try:
        text = content.decode("utf-8-sig")
        if _LONG_KEY.search(text):
            raise TorsadeError(f"{name} has a key of more than 32 parts; give a TOML specification")
        return tomllib.loads(text)
    except RecursionError:
        raise TorsadeError(
            f"{name} has brackets too deep within each other; give a TOML specification"
        ) from None
    except tomllib.TOMLDecodeError as error:
        reason = str(error).rstrip(".")
        raise TorsadeError(f'{name} is not TOML: {reason}; write lines such as force = "15 N"') from None
    except UnicodeDecodeError:
        raise TorsadeError(f"cannot read {name} (not text in UTF-8); give a TOML specification") from None
    except ValueError:  # the interpreter makes no whole numbers of so many digits
        raise TorsadeError(f"{name} has a number of thousands of digits; give one in range") from None


def check_protocol(protocol: object, where: str) -> type[Spec]:
    """The specification of a protocol that is given somewhere.

    Raises
    ------
    TorsadeError
        When none is given, or one that is not known; the nearest is named.
    """
    if protocol is None:
        raise TorsadeError(
            f'{where} names no protocol; add a line such as protocol = "prison-escape"; there are '
            f"{', '.join(PROTOCOLS)}"
        )
    if not isinstance(protocol, str) or protocol not in PROTOCOLS:
        near = difflib.get_close_matches(str(protocol), PROTOCOLS, n=1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise TorsadeError(
            f"{where} has protocol {quoted(protocol)}, which is unknown; {hint}choose one of "
            f"{', '.join(PROTOCOLS)}"
        )
    return PROTOCOLS[protocol]


def beside(path: str | Path, centerline: Any) -> Any:
    """A file of nodes that a TOML file names: beside that, where it lies there."""
    found = isinstance(centerline, str) and _is_file(Path(path).parent / centerline)
    return str(Path(path).parent / centerline) if found else centerline


def _is_file(path: Path) -> bool:
    """Whether there is one: a name that is too long, or holds what no name may, is that of none."""
    with suppress(OSError, ValueError):
        return path.is_file()
    return False


def merged(fields: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """Fields of a file with others given in their place; what those exclude is left out."""
    excluded = {name for field in given for name in _REPLACES.get(field, ())}
    return {name: value for name, value in fields.items() if name not in excluded} | given
