"""Draw the picture of docs/tight.md: `python tools/draw_tight.py`, from the folder above."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from torsade.knots import tighten
from torsade.knots.loose import loose_knot
from torsade.view.scene import picture

IMAGE = Path(__file__).resolve().parents[1] / "docs" / "images" / "tight-knots.png"
KNOTS = ("3_1", "4_1", "5_1", "7_4", "L5a1", "L6a4")
TILE = (336, 288)
COLUMNS = 3


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, COLUMNS, figsize=(7.6, 4.7))
    for ax, name in zip(axes.flat, KNOTS, strict=True):
        knot = tighten(loose_knot(name))
        image = picture(knot.strands, True, knot.radius, size=TILE)
        ax.imshow(np.clip(image, 0, 1), interpolation="lanczos")
        ax.set_title(f"{name}: L/h = {knot.ropelength:.2f}", fontsize=9)
        ax.axis("off")
    figure.tight_layout()
    figure.savefig(IMAGE, dpi=110, facecolor="white")


if __name__ == "__main__":
    main()
