"""Run the sweep of docs/sweeps.md and draw its picture: `python tools/draw_sweep.py` from above."""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

import numpy as np

from torsade.sweep import Sweep
from torsade.view.colours import STRAND_COLOURS
from torsade.view.plots import STYLE

DOCS = Path(__file__).resolve().parents[1] / "docs"
IMAGE = DOCS / "images" / "sweep-pieces.png"
COLOURS = (STRAND_COLOURS[2], STRAND_COLOURS[0], STRAND_COLOURS[1])
MARKS = ("o", "s", "D")


def design_and_query() -> tuple[str, str]:
    """The first design and the query for means that the page shows."""
    page = (DOCS / "sweeps.md").read_text(encoding="utf-8")
    (query,) = re.findall(r'^torsade query pieces "(SELECT disorder, round.*)"$', page, re.M)
    return re.findall(r"^```toml\n(.*?)^```$", page, re.M | re.S)[0], query


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    text, query = design_and_query()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(place) / "pieces"
        file = Path(place) / "pieces.toml"
        file.write_text(text)
        found = Sweep.read(file).run(folder).query(query).arrays()
    with plt.rc_context(STYLE):
        figure, ax = plt.subplots(figsize=(4.6, 2.9))
        levels = np.unique(found["disorder"])
        for k, (level, colour, mark) in enumerate(zip(levels, COLOURS, MARKS, strict=True)):
            own = found["disorder"] == level
            ax.errorbar(
                found["deg"][own] + 2.5 * (k - 1),
                found["pieces"][own],
                found["error"][own],
                color=colour,
                marker=mark,
                markersize=3.5,
                linewidth=1.1,
                elinewidth=0.8,
                label=f"disorder {level:g}",
            )
        ax.set_xlabel("twist (degrees)")
        ax.set_ylabel("pieces, mean and its error")
        ax.set_xticks(range(0, 301, 60))
        ax.set_ylim(1.7, 6.3)
        ax.legend(frameon=False, loc="lower left")
        figure.tight_layout()
        figure.savefig(IMAGE, dpi=160, facecolor="white")
        plt.close(figure)


if __name__ == "__main__":
    main()
