"""What `torsade topology` finds out: one dictionary, for the table and for `--json`.

Keys are always the same; what does not apply is None.
"""

from __future__ import annotations

import json as json_format
import re
from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from torsade.cli.codes import codes_of
from torsade.cli.subject import Subject, subject
from torsade.errors import TorsadeError, listed, quoted
from torsade.topology.codes import to_pd
from torsade.topology.counting import State, circulation_range, pull_choices, state
from torsade.topology.diagram import Diagram
from torsade.topology.identify import Identity, identify, identify_open, identify_strands
from torsade.topology.invariants import Laurent, alexander, determinant, jones, oriented, signature
from torsade.topology.measures import average_crossing_number, writhe_matrix
from torsade.topology.simplify import simplify
from torsade.topology.tangle import close, closures

__all__ = ["report", "topology"]

DIRECTIONS = 100
"""In how many directions an open strand is closed at infinity."""

CHOICES = 16
"""Of pulled ends, as many are listed: all those of four strands."""

MOST_CROSSINGS = 60
"""Drawings of tangles with more crossings are counted, but not redrawn to find the range of Gamma."""


def topology(
    given: str, pulled: str | None, drawings: str, direction: str | None, length_unit: str, json: bool
) -> int:
    """Read, find out, print."""
    found = report(subject(given, length_unit, direction), pulled, _drawings(drawings))
    if json:
        print(json_format.dumps(found, allow_nan=False), flush=True)
        return 0
    from torsade.cli.table import print_rows
    from torsade.cli.topology_table import rows

    print_rows(rows(found))
    return 0


def _drawings(text: str) -> int:
    if not re.fullmatch(r"\d{1,6}", text.strip(), re.A):
        raise TorsadeError(
            f"--drawings is {quoted(text)}; give a whole number from 0 to 999999, such as 2000"
        )
    return int(text)


def report(given: Subject, pulled: str | None, drawings: int) -> dict[str, Any]:
    """Everything that is found out.

    Args:
        given: what it is about.
        pulled: ends named by the user.
        drawings: at how many drawings to look for the range of Gamma; 0 leaves it out.
    """
    diagram = given.diagram
    ends = _pulled(given, pulled)
    drawn = diagram if ends is None else diagram.pulled(ends)
    simpler = simplify(drawn)
    counts = state(drawn)
    found: dict[str, Any] = {
        "input": given.given,
        "kind": given.kind,
        "title": given.title,
        "notes": list(given.notes),
        "strands": diagram.n_strands,
        "ends": list(diagram.ends),
        "pulled": ends,
        **_counted(counts),
        "charges": list(drawn.signs),
        "linking": drawn.linking.tolist() if drawn.n_strands > 1 else None,
        "faces": _faces(counts),
        "outside": _outside(diagram),
        "fewest": _counted(state(simpler)),
        "codes": codes_of(simplify(diagram)),
    }
    found |= (
        _of_tangle(given, drawn, simpler, drawings)
        if diagram.ends
        else _of_closed(simpler, None if given.handed else drawn)
    )
    return found | _of_curves(given)


def _pulled(given: Subject, pulled: str | None) -> str | None:
    """The names of the pulled ends, in the order of strands."""
    if not given.diagram.ends:
        if pulled is not None:
            raise TorsadeError(f"--pulled is {quoted(pulled)}, but all strands are closed; leave it out")
        return None
    if pulled is None:
        return given.pulled or "".join(next(pull_choices(given.diagram)))
    text = pulled.strip().upper()
    names = sorted(re.findall(r"[A-Z]+\d+", text))
    tips = sorted(given.diagram.ends)
    pairs = list(zip(tips[::2], tips[1::2], strict=True))
    if sum(map(len, names)) != len(text) or not _is_choice(names, pairs):
        choices = listed([" or ".join(two) for two in pairs], " and ")
        raise TorsadeError(f"--pulled is {quoted(pulled)}; give one of each open strand, {choices}")
    return "".join(names)


def _is_choice(names: Sequence[str], pairs: Sequence[tuple[str, str]]) -> bool:
    """Whether these are one of each pair, in order."""
    return len(names) == len(pairs) and all(name in two for name, two in zip(names, pairs, strict=True))


def _counted(counts: State) -> dict[str, Any]:
    return {
        "crossings": counts.crossings,
        "writhe": counts.writhe,
        "tau": counts.tau,
        "circulation": counts.gamma,
        "whitney": counts.whitney,
    }


def _faces(counts: State) -> list[dict[str, Any]]:
    return [{"edges": f.edges, "circulation": f.circulation, "bounded": f.bounded} for f in counts.faces]


def _outside(diagram: Diagram) -> str | None:
    """Whether what was given says which face of a closed drawing lies outside: the longest is taken else."""
    if diagram.ends or not diagram.n_crossings:
        return None
    given = {diagram.piece_at[p] for p in diagram.outer}
    return "given" if len(given) == len(diagram.pieces) else "longest face"


def _of_tangle(given: Subject, drawn: Diagram, simpler: Diagram, drawings: int) -> dict[str, Any]:
    """What is said of open strands."""
    spread = None
    if drawings and simpler.n_crossings <= MOST_CROSSINGS:
        found = circulation_range(simpler, limit=drawings)
        spread = {
            "least": found.least,
            "greatest": found.greatest,
            "crossings": found.crossings,
            "drawings": found.drawings,
            "complete": found.complete,
        }
    closed = [(joins, identify(diagram)) for joins, diagram in closures(drawn)] if _few(drawn) else []
    return {
        "circulation_range": spread,
        "pulls": [
            {"pulled": "".join(choice), "name": _pull_name(given, "".join(choice))}
            | _counted(state(drawn, choice))
            for choice in islice(pull_choices(drawn), CHOICES)
        ],
        "strand_types": [_identity(one) for one in identify_strands(drawn)],
        "closures": [{"joins": ["-".join(two) for two in joins], **_identity(one)} for joins, one in closed],
        **_of_closure(drawn),
    }


def _of_closure(drawn: Diagram) -> dict[str, Any]:
    """Names and invariants of a knot in one strand: those of the closed knot, which is the only one."""
    keys = ("names", "certain", "reason", "alexander", "determinant", "signature", "jones")
    if len(drawn.ends) != 2:
        return dict.fromkeys(keys)
    closed = _of_closed(simplify(close(drawn, [(drawn.ends[0], drawn.ends[1])])))
    return {key: closed[key] for key in keys}


def _few(drawn: Diagram) -> bool:
    """Whether there are few ways to join the ends: 14 of four strands, 429 of seven."""
    return len(drawn.ends) <= 8


def _pull_name(given: Subject, pulled: str) -> str | None:
    return given.pulls.get(pulled)


def _of_closed(simpler: Diagram, unhanded: Diagram | None = None) -> dict[str, Any]:
    """What is said of knots and links.

    Args:
        simpler: the diagram, simplified.
        unhanded: as it was given, if its code leaves mirror images open.
    """
    code = oriented(to_pd(simpler.without_circles()), simpler.circles)
    one = identify(unhanded, handed=False) if unhanded else identify(simpler, patience=0)
    try:
        v = _polynomial(jones(code))
    except TorsadeError:  # too wide; the reason is in the identity
        v = None
    return {
        "circulation_range": None,
        "pulls": None,
        "strand_types": [_identity(part) for part in one.components] or None,
        "closures": None,
        "names": list(one.names),
        "certain": one.certain,
        "reason": one.reason or None,
        "alexander": _polynomial(alexander(code)),
        "determinant": determinant(code),
        "signature": signature(code),
        "jones": v,
    }


def _of_curves(given: Subject) -> dict[str, Any]:
    """What is measured in space, of a file."""
    if given.centerline is None or given.projection is None:
        return dict.fromkeys(("writhe_3d", "acn", "linking_3d", "projection", "closed_at_infinity"))
    x, closed = given.centerline.strands, given.centerline.closed
    matrix = writhe_matrix(x, closed)
    seen = given.projection
    return {
        "writhe_3d": float(matrix.sum()),
        "acn": average_crossing_number(x, closed),
        "linking_3d": (matrix - np.diag(np.diag(matrix))).tolist() if len(x) > 1 else None,
        "projection": {
            "direction": seen.direction.tolist(),
            "refused": list(seen.refused),
            "led_out": seen.n_led_out,
        },
        "closed_at_infinity": [
            None if shut else identify_open(nodes, DIRECTIONS).fractions
            for nodes, shut in zip(x, closed, strict=True)
        ],
    }


def _identity(one: Identity) -> dict[str, Any]:
    return {
        "names": list(one.names),
        "certain": one.certain,
        "reason": one.reason or None,
        "linking": [list(row) for row in one.linking] if one.linking else None,
    }


def _polynomial(p: Laurent) -> dict[str, Any]:
    return {"text": str(p), "lowest": float(p.lowest), "coefficients": list(p.coefficients)}
