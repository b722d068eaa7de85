"""Draw the gallery of docs/knots.md: closed knots through 7 crossings and all bends.

    python tools/draw_gallery.py

from the folder above; two pictures in docs/images.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import torsade as ts
from torsade.knots.bends import bends
from torsade.topology.table import contents
from torsade.view.scene import picture

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
CLOSED = [name for name in contents()["knots"] if int(name.split("_")[0]) <= 7]
TILE = (320, 256)
COLUMNS = 5


def main() -> None:
    draw(
        "gallery-closed.png",
        [("unknot", ts.knots.tie("unknot")), *((f"${name}$", ts.knots.tie(name)) for name in CLOSED)],
    )
    known = bends()
    draw(
        "gallery-bends.png",
        [(plain(known[name].title), ts.knots.bend(name)) for name in known if "min" not in name],
    )


def plain(title: str) -> str:
    """A title without what stands in brackets."""
    return re.sub(r" \(.*?\)", "", title)


def draw(file: str, shown: Sequence[tuple[str, Any]]) -> None:
    """A table of pictures with names below them."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows = -(-len(shown) // COLUMNS)
    figure, axes = plt.subplots(rows, COLUMNS, figsize=(1.9 * COLUMNS, 1.75 * rows))
    for ax in axes.flat:
        ax.axis("off")
    for ax, (title, knot) in zip(axes.flat, shown, strict=False):
        image = picture(knot.strands, knot.closed, knot.radius, size=TILE)
        ax.imshow(np.clip(image, 0, 1), interpolation="lanczos")
        ax.set_title(title, fontsize=8, y=-0.12)
    figure.tight_layout(pad=0.4)
    figure.savefig(IMAGES / file, dpi=110, facecolor="white")


if __name__ == "__main__":
    main()
