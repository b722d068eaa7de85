"""What `torsade tight` does: read a knot, pull it tight, say how long it is."""

from __future__ import annotations

import json as json_format
import re
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsade.centerline import Centerline
from torsade.cli.commands import check_drawings, progress
from torsade.cli.messages import say
from torsade.cli.subject import subject
from torsade.errors import TorsadeError, quoted
from torsade.files import write_centerline
from torsade.knots.loose import listed_ropelength, loose_diagram, loose_knot
from torsade.knots.tight import Interrupted, TightKnot, tighten
from torsade.topology.identify import identify_curves
from torsade.topology.measures import average_crossing_number, writhe
from torsade.units import quantity

__all__ = ["report", "tight"]


def tight(
    given: str,
    ropelength: str | None,
    radius: str | None,
    nodes: str | None,
    tries: str,
    out: str | None,
    picture: str | None,
    json: bool,
) -> int:
    """Read, tighten, write, print."""
    began = time.perf_counter()
    curves = _curves(given)
    options = {
        "ropelength": _number("--ropelength", ropelength, "50"),
        "nodes": _whole("--nodes", nodes),
        "tries": _whole("--tries", tries),
    }
    h = None if radius is None else _radius(radius)
    _check_out(out)
    check_drawings(picture, None)
    try:
        with progress(json) as shown:
            found = tighten(curves, radius=1.0 if h is None else h, progress=shown, **options)  # type: ignore[arg-type]
    except Interrupted as stopped:
        raise KeyboardInterrupt(_kept(stopped.best, out)) from None
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted before there was a shape to keep; nothing is saved") from None
    answer = report(given, found, h, time.perf_counter() - began)
    if out is not None:
        write_centerline(found.centerline, out)
    _print(answer, out, picture, json)
    if picture is not None:
        from torsade.view.scene import render

        render(found.strands, True, found.radius, picture)
    if not found.reached:
        say(f"the knot is tight at L/h = {found.ropelength:.2f}, above the {ropelength} asked for")
    return 0


def report(given: str, found: TightKnot, radius: float | None, seconds: float) -> dict[str, Any]:
    """Everything that is found out; lengths are None unless a radius was given."""
    names = identify_curves(found.strands).names
    return {
        "input": given,
        "names": list(names),
        "ropelength": found.ropelength,
        "ropelength_listed": listed_ropelength(names[0]) if len(names) == 1 else None,
        "reached": found.reached,
        "length_m": None if radius is None else found.length,
        "radius_m": radius,
        "writhe_3d": writhe(found.strands, True),
        "acn": average_crossing_number(found.strands, True),
        "strands": len(found.strands),
        "nodes": sum(len(x) for x in found.strands),
        "contacts": len(found.contacts),
        "kinks": len(found.kinks),
        "residual": found.residual,
        "wall_s": seconds,
    }


def _curves(given: str) -> list[Any]:
    """Closed curves of what was given."""
    asked = subject(given)
    if asked.centerline is not None:
        shape: Centerline = asked.centerline
        if not all(shape.closed):
            k = shape.closed.index(False)
            raise TorsadeError(
                f"strand {k} of {given!r} is open; only closed strands can be tight: "
                "end it with its first node"
            )
        return list(shape.strands)
    if asked.diagram.ends:
        raise TorsadeError(
            f"{quoted(given)} has open strands; give a knot or link such as 3_1 or L5a1, the code of "
            "one, or a CSV file"
        )
    return loose_knot(given) if asked.kind in ("closed", "link") else loose_diagram(asked.diagram)


def _radius(text: str) -> float:
    try:
        return quantity(text, "length")
    except TorsadeError as error:
        raise TorsadeError(f"--radius {error}") from None


def _number(option: str, text: str | None, example: str) -> float | None:
    if text is None:
        return None
    try:
        return float(text)
    except ValueError:
        raise TorsadeError(f"{option} is {quoted(text)}; give a number such as {example}") from None


def _whole(option: str, text: str | None) -> int | None:
    if text is None:
        return None
    if not re.fullmatch(r"\d{1,5}", text.strip(), re.A):
        raise TorsadeError(f"{option} is {quoted(text)}; give a whole number such as 20")
    return int(text)


def _check_out(out: str | None) -> None:
    """Refuse a file that cannot be written before anything is computed."""
    if out is None:
        return
    if Path(out).suffix.lower() != ".csv":
        raise TorsadeError(f"--out is {out!r}; give the name of a file that ends in .csv")
    if not Path(out).absolute().parent.is_dir():
        raise TorsadeError(f"cannot write {out!r}: its folder does not exist; give a file in one that does")


def _kept(best: TightKnot, out: str | None) -> str:
    """Write what there is when Ctrl-C comes, and say so."""
    shape = f"the best shape so far has L/h = {best.ropelength:.2f}"
    if out is None:
        return f"interrupted; {shape} and is not saved, since no --out FILE.csv was given"
    write_centerline(best.centerline, out)
    return f"interrupted; {shape} and is in {out!r}"


def _print(answer: dict[str, Any], out: str | None, picture: str | None, json: bool) -> None:
    if json:
        print(json_format.dumps(answer, allow_nan=False), flush=True)
        return
    from torsade.cli.table import print_file, print_rows

    print_rows(_rows(answer))
    for what, path in (("nodes", out), ("picture", picture)):
        if path is not None:
            print_file(what, path)
    sys.stdout.flush()


def _rows(answer: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield "given", answer["input"]
    yield "name", " or ".join(answer["names"]) or "not in the table"
    yield "ropelength L/h", f"{answer['ropelength']:.4f}, over the diameter {answer['ropelength'] / 2:.4f}"
    if answer["ropelength_listed"] is not None:
        listed = answer["ropelength_listed"]
        yield (
            "shortest listed L/h",
            f"{listed:g}, {100 * (answer['ropelength'] / listed - 1):+z.2f} % to this one",
        )
    if answer["radius_m"] is not None:
        yield "length", f"{1e3 * answer['length_m']:.5g} mm at radius {1e3 * answer['radius_m']:g} mm"
    yield "writhe in space", f"{answer['writhe_3d']:+z.4f}"
    yield "average crossing number", f"{answer['acn']:.4f}"
    yield (
        "contacts, kinks",
        f"{answer['contacts']} pairs of nodes, {answer['kinks']} nodes of {answer['nodes']}",
    )
    yield "force not balanced", f"{answer['residual']:.1e} of the tension"
    yield "time", f"{answer['wall_s']:.1f} s"
