"""Specifications in TOML files: `protocol = "prison-escape"`, then fields, with units in text.

protocol = "prison-escape"
knot = "reef"
force = "15 N"
"""

from __future__ import annotations

import difflib
import tomllib
from pathlib import Path
from types import MappingProxyType
from typing import Any

from torsade.errors import TorsadeError, reason_of
from torsade.protocols.base import Spec
from torsade.protocols.battery import Battery
from torsade.protocols.bend_twist import BendTwist
from torsade.protocols.pendulum import Pendulum
from torsade.protocols.prison_escape import PrisonEscape
from torsade.protocols.reidemeister import Reidemeister
from torsade.protocols.snap_quench import SnapQuench
from torsade.protocols.snap_twist import SnapTwist
from torsade.protocols.tighten import Tighten

__all__ = ["PROTOCOLS", "load_spec", "merged", "read_fields"]

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
    }
)
"""The specification of every protocol, by name."""

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
    path, name = Path(path), repr(str(path))
    try:
        fields = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise TorsadeError(f"there is no file {name}; give the path of a TOML specification") from None
    except (OSError, ValueError) as error:
        if isinstance(error, tomllib.TOMLDecodeError):
            reason = str(error).rstrip(".")
            raise TorsadeError(f'{name} is not TOML: {reason}; write lines such as force = "15 N"') from None
        reason = reason_of(error) if isinstance(error, OSError) else "not text in UTF-8"
        raise TorsadeError(f"cannot read {name} ({reason}); give a TOML specification") from None
    protocol = fields.get("protocol")
    if protocol is None:
        raise TorsadeError(
            f'{name} names no protocol; add a line such as protocol = "prison-escape"; there are '
            f"{', '.join(PROTOCOLS)}"
        )
    if not isinstance(protocol, str) or protocol not in PROTOCOLS:
        near = difflib.get_close_matches(str(protocol), PROTOCOLS, n=1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise TorsadeError(
            f"{name} has protocol {protocol!r}, which is unknown; {hint}choose one of {', '.join(PROTOCOLS)}"
        )
    centerline = fields.get("centerline")
    if isinstance(centerline, str) and (path.parent / centerline).is_file():
        fields["centerline"] = str(path.parent / centerline)
    return fields


def merged(fields: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """Fields of a file with others given in their place; what those exclude is left out."""
    excluded = {name for field in given for name in _REPLACES.get(field, ())}
    return {name: value for name, value in fields.items() if name not in excluded} | given
