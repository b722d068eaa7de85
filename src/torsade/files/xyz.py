"""XYZ: blocks of a count, a comment and lines of element x y z; or bare lines of x y z.

Each block (frame) is a strand. In the bare form a blank line begins the next strand, and lines that begin
with # are comments. A strand that ends with its first node is closed.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, counted
from torsade.files.gathered import MOST_NODES, Gathered, rows
from torsade.files.regular import lines, whole_number

__all__ = ["read", "written"]

ELEMENT = "X"
"""What a node is called: no element."""


def written(centerline: Centerline) -> bytes:
    """A block for each strand."""
    text = []
    for k, (x, closed) in enumerate(zip(centerline.strands, centerline.closed, strict=True)):
        nodes = rows(x, closed)
        text += [str(len(nodes)), f"strand {k} [m], {'closed' if closed else 'open'}"]
        text += [f"{ELEMENT} {a!r} {b!r} {c!r}" for a, b, c in nodes]
    return ("\n".join(text) + "\n").encode()


def read(path: Path) -> Centerline:
    """Strands of either form; a first line that is one whole number begins a block."""
    found = Gathered(path)
    source = lines(path)
    fresh = True
    for where, line in source:
        cells = line.split()
        if not cells:
            fresh = True
        elif cells[0].startswith("#"):
            continue
        elif len(cells) == 1 and fresh:
            _block(found, source, cells[0], where)
        else:
            if len(cells) != 3:
                raise TorsadeError(
                    f"{where} has {counted(len(cells), 'column')}; give x y z, or a count, a comment and "
                    "lines of element x y z"
                )
            if fresh:
                found.begin()
            fresh = False
            found.add(cells, where)
    return found.centerline()


def _block(found: Gathered, source: Iterator[tuple[str, str]], count: str, where: str) -> None:
    """Read the nodes that a count announces."""
    wanted = whole_number(count, "count", where)
    if not 0 < wanted <= MOST_NODES:
        raise TorsadeError(f"{where} announces {wanted} nodes; give from 2 to {MOST_NODES}")
    found.begin()
    next(source, None)  # the comment
    for k in range(wanted):
        at, line = next(source, ("", ""))
        if not at:
            raise TorsadeError(f"{where} announces {wanted} nodes, and the file ends after {k}; complete it")
        cells = line.split()
        if len(cells) < 3:
            raise TorsadeError(
                f"{at} has {counted(len(cells), 'column')} where node {k + 1} of {wanted} is due; give "
                "element x y z"
            )
        # Properties of an atom may follow its position.
        found.add(cells if len(cells) == 3 else cells[1:4], at)
