"""What `torsade knots` does: list, show and build what the catalogue has."""

from __future__ import annotations

import json as json_format
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsade import curve
from torsade.cli.codes import codes_of
from torsade.cli.table import print_file, print_rows
from torsade.errors import TorsadeError, counted, quoted
from torsade.knots.entries import KINDS, Entry, facts
from torsade.knots.finding import interpret, search
from torsade.topology.counting import pull_choices, state

__all__ = ["build_knot", "list_knots", "show_knot"]


# --- list


def list_knots(text: str, kind: str | None, json: bool) -> int:
    """Print the entries with a text in their names, kind by kind."""
    found = search(text, kind)
    if json:
        rows = [{"name": e.name, "kind": e.kind, "title": e.title, "aliases": list(e.aliases)} for e in found]
        print(json_format.dumps(rows), flush=True)
        return 0
    if not found:
        raise TorsadeError(
            f"nothing has {quoted(text)} in its name; leave it out to see all, or give part of a name such "
            "as fish"
        )
    for kind_found in dict.fromkeys(entry.kind for entry in found):
        print(f"{kind_found}: {KINDS[kind_found]}")
        print_rows(_listed([entry for entry in found if entry.kind == kind_found], bool(text)))
        print()
    print(f"{counted(len(found), 'name')}; more of each with: torsade knots show NAME")
    return 0


def _listed(found: list[Entry], asked: bool) -> Iterator[tuple[str, str]]:
    """A line each; the tables of closed knots and links in short, unless a text was asked for."""
    if found[0].kind in ("closed", "link") and len(found) > 20 and not asked:
        named = [entry for entry in found if entry.aliases]
        yield from ((entry.name, entry.title) for entry in named)
        yield f"{found[1].name} ... {found[-1].name}", f"{len(found)} in all"
        return
    for entry in found:
        others = [word for word in entry.aliases if word not in entry.title.lower()]
        yield entry.name, entry.title + (f" (also {', '.join(others)})" if others else "")


# --- show


def show_knot(text: str, json: bool) -> int:
    """Print what is known of an entry."""
    entry = interpret(text)
    found = _about(entry)
    if json:
        print(json_format.dumps(found, allow_nan=False), flush=True)
    else:
        print_rows(_rows(found))
    return 0


def _about(entry: Entry) -> dict[str, Any]:
    diagram = entry.diagram
    known = facts(entry.name)
    return {
        "name": entry.name,
        "kind": entry.kind,
        "title": entry.title,
        "aliases": list(entry.aliases),
        "abok": list(entry.abok),
        "strands": diagram.n_strands,
        "ends": list(diagram.ends),
        "pulled": entry.pulled,
        "crossings": diagram.n_crossings,
        "writhe": diagram.writhe,
        "pulls": _pulls(entry),
        "codes": codes_of(diagram),
        "braid": known.get("braid"),
        "symmetry": known.get("symmetry"),
        "unknotting_number": known.get("unknotting"),
        "ropelength": known.get("ropelength"),
        "source": entry.source or None,
        "certainty": entry.certainty or None,
    }


def _pulls(entry: Entry) -> list[dict[str, Any]] | None:
    """What is counted for each choice of pulled ends of two strands."""
    if len(entry.diagram.ends) != 4:
        return None
    return [
        {
            "pulled": "".join(choice),
            "name": entry.pulls.get("".join(choice)),
            "writhe": now.writhe,
            "tau": now.tau,
            "circulation": now.gamma,
            "whitney": now.whitney,
        }
        for choice in pull_choices(entry.diagram)
        for now in [state(entry.diagram, choice)]
    ]


def _rows(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield "name", found["name"]
    yield found["kind"], found["title"]
    if found["aliases"]:
        yield "also called", ", ".join(found["aliases"])
    if found["abok"]:
        yield "Ashley Book of Knots", ", ".join(f"#{number}" for number in found["abok"])
    yield "crossings N", f"{found['crossings']}, writhe {found['writhe']:+d}"
    for pull in found["pulls"] or ():
        mark = ", as usual" if pull["pulled"] == found["pulled"] else ""
        numbers = f"Wr {pull['writhe']:+d}, tau {pull['tau']:.4g}, Gamma {pull['circulation']:.4g}"
        yield f"pulled by {pull['pulled']}", f"{numbers}: {pull['name'] or 'no name of its own'}{mark}"
    for key, label in (("symmetry", "symmetry"), ("unknotting_number", "unknotting number")):
        if found[key] is not None:
            yield label, str(found[key])
    if found["ropelength"] is not None:
        yield "ropelength L/h", f"{found['ropelength']:.5g}, the shortest known"
    if found["braid"]:
        yield "braid", "{" + ",".join(map(str, found["braid"])) + "}"
    for key, label in (("conway", "Conway notation"), ("dt", "Dowker-Thistlethwaite"), ("pd", "PD code")):
        if found["codes"][key]:
            yield label, found["codes"][key].removeprefix("DT: ")
    for key in ("source", "certainty"):
        if found[key]:
            yield key, found[key]


# --- build


def build_knot(
    text: str,
    out: str | None,
    lengths: dict[str, str | None],
    pulled: str | None,
    picture: str | None,
    json: bool,
    overwrite: bool,
) -> int:
    """Make a fiber, write it, and say what it is like."""
    from torsade.files import write_centerline
    from torsade.files.centerlines import format_of
    from torsade.knots.build import build

    if out is None and picture is None and not json:
        raise TorsadeError("there is nowhere to put the fiber; give --out FILE.csv, or --picture FILE.png")
    if out is not None:
        format_of(out, reading=False)
        if Path(out).exists() and not overwrite:
            raise TorsadeError(f"{out!r} exists already; give another name, or --overwrite to replace it")
    entry = interpret(text)
    begun = time.perf_counter()
    given = {name: value for name, value in lengths.items() if value is not None}
    knot = build(entry.diagram, pulled=pulled or entry.pulled, **given)
    wall = time.perf_counter() - begun
    if out is not None:
        write_centerline(knot, out)
    if picture is not None:
        from torsade.view import render

        render(knot.strands, knot.closed, knot.radius, picture)
    found = {
        "name": entry.name,
        "kind": entry.kind,
        "title": entry.title,
        "radius_m": knot.radius,
        "strands": [
            {"nodes": len(x), "length_m": curve.length(x, closed), "closed": closed}
            for x, closed in zip(knot.strands, knot.closed, strict=True)
        ],
        "pulled": knot.pulled,
        "clearance_m": knot.clearance,
        "h_kappa": knot.h_kappa,
        "out": out,
        "picture": picture,
        "wall_s": wall,
    }
    if json:
        print(json_format.dumps(found, allow_nan=False), flush=True)
        return 0
    print_rows(_built(found))
    for label, path in (("fiber written to", out), ("picture", picture)):
        if path is not None:
            print_file(label, path)
    return 0


def _built(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    h = found["radius_m"]
    yield "built", f"{found['name']}: {found['title']}"
    yield "radius h", f"{1e3 * h:g} mm"
    for k, strand in enumerate(found["strands"]):
        kind = "closed" if strand["closed"] else "open"
        size = f"{1e3 * strand['length_m']:.4g} mm = {strand['length_m'] / h:.4g} h"
        yield f"strand {k}", f"{kind}, {size}, {strand['nodes']} nodes"
    if found["pulled"]:
        yield "ends on the x axis", f"{found['pulled'][:2]} at -x, {found['pulled'][2:]} at +x"
    yield "strands apart", f"{found['clearance_m'] / h:.3f} h, axis to axis"
    yield "curvature", f"h kappa at most {found['h_kappa']:.3f}"
    yield "read again", "the curve is this knot"
