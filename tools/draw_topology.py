"""Draw the pictures of docs/topology.md: `python tools/draw_topology.py`, from the folder above."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import torsade as ts
from torsade.topology import braid_curves, project, state

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
STRANDS = ("#2f6f9f", "#d08a2e", "#5d8f4e")
POSITIVE, NEGATIVE, GREY = "#b3312c", "#3b4da0", "#555555"
REACH = 8.5  # radii from the middle of a bend to where its strands are cut


def rope(x: np.ndarray, color: str, width: float, closed: bool = False) -> list[tuple[float, Any]]:
    """Pieces of a strand with their heights, to be drawn from below."""
    nodes = np.concatenate([x, x[:1]]) if closed else x
    step = max(len(nodes) // 240, 1)
    return [
        (float(nodes[k : k + step + 1, 2].mean()), (nodes[max(k - 1, 0) : k + step + 2, :2], color, width))
        for k in range(0, len(nodes) - 1, step)
    ]


def weave(axes: Any, pieces: list[tuple[float, Any]]) -> None:
    """Draw pieces from the lowest up, each on a wider white one."""
    for rank, (_, (points, color, width)) in enumerate(sorted(pieces, key=lambda piece: piece[0])):
        axes.plot(*points.T, color="white", lw=2.0 * width, solid_capstyle="butt", zorder=rank)
        axes.plot(*points.T, color=color, lw=width, solid_capstyle="round", zorder=rank + 0.5)


def arrow(axes: Any, start: np.ndarray, end: np.ndarray, color: str, size: float = 16) -> None:
    axes.annotate(
        "", end, start, zorder=10_000,
        arrowprops={
            "arrowstyle": "-|>", "color": color, "lw": 0, "mutation_scale": size, "shrinkA": 0, "shrinkB": 0
        },
    )  # fmt: skip


def crossings(plt: Any) -> None:
    """A right-handed and a left-handed crossing."""
    figure, both = plt.subplots(1, 2, figsize=(5.2, 2.6))
    t = np.linspace(-1, 1, 60)[:, None]
    for axes, sign in zip(both, (1, -1), strict=True):
        rising, falling = t * (1, 1, 0) + (0, 0, sign), t * (-1, 1, 0) - (0, 0, sign)
        weave(axes, [*rope(rising, STRANDS[0], 5), *rope(falling, STRANDS[1], 5)])
        for x, color in ((rising, STRANDS[0]), (falling, STRANDS[1])):
            arrow(axes, x[-8, :2], x[-1, :2] * 1.12, color, 26)
        angle = np.radians(np.linspace(45, 135, 30))[:: 1 if sign > 0 else -1]
        turn = 0.62 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        axes.plot(*turn[:-3].T, color=GREY, lw=1.2, zorder=900)
        arrow(axes, turn[-5], turn[-1], GREY, 12)
        color = POSITIVE if sign > 0 else NEGATIVE
        words = "right-handed, +1" if sign > 0 else "left-handed, −1"
        axes.text(0, -1.25, words, ha="center", color=color, fontsize=11)
        axes.set(xlim=(-1.3, 1.3), ylim=(-1.45, 1.25), aspect="equal")
        axes.axis("off")
    save(plt, figure, "topology-crossings.png")


def bends(plt: Any) -> None:
    """The reef and the thief: strands run towards the pulled ends; charges and circulations."""
    figure, both = plt.subplots(1, 2, figsize=(9.6, 3.2))
    for axes, name in zip(both, ("reef", "thief"), strict=True):
        knot = ts.knots.bend(name, radius=1.0)
        seen = project(knot.strands)
        drawn = seen.diagram.pulled(knot.pulled)
        above = zip(seen.strand[:, 0], seen.edge[:, 0], seen.parameter[:, 0], strict=True)
        centre = [between(knot.strands[i], e, p) for i, e, p in above]
        pieces: list[tuple[float, Any]] = []
        for x, color in zip(knot.strands, STRANDS, strict=False):
            near = x[np.abs(x[:, 0]) < REACH]
            pieces += rope(near, color, 4.5)
        weave(axes, pieces)
        ends(axes, knot)
        for x, sign in zip(centre, drawn.signs, strict=True):
            out = np.sign(np.where(np.abs(x) < 0.5, 0, x))
            badge(axes, x + out / np.linalg.norm(out), sign)
        faces(axes, knot, seen, drawn)
        found = state(drawn)
        numbers = f"N = {found.crossings}, τ = {found.tau:g}, Γ = {found.gamma:g}"
        axes.set_title(f"{name}, pulled by {knot.pulled}: {numbers}", fontsize=11)
        axes.set(xlim=(-10.2, 10.2), ylim=(-5.2, 6), aspect="equal")
        axes.axis("off")
    save(plt, figure, "topology-reef-thief.png")


def ends(axes: Any, knot: Any) -> None:
    """Names of the ends, and arrows where each strand runs."""
    for k, (x, letter) in enumerate(zip(knot.strands, "AB", strict=True)):
        pulled = int(knot.pulled[2 * k + 1])
        near = x[np.abs(x[:, 0]) < REACH]
        for end in (0, 1):
            tip, before = (near[-1], near[-6]) if end else (near[0], near[5])
            out = (tip - before)[:2] / np.linalg.norm((tip - before)[:2])
            if end == pulled:
                arrow(axes, tip[:2] - 0.6 * out, tip[:2] + 0.8 * out, STRANDS[k], 30)
            place = tip[:2] + np.array([0, 1.1 if tip[1] >= 0 else -1.1])
            weight = "bold" if end == pulled else "normal"
            axes.text(*place, f"{letter}{end}", ha="center", va="center", color=STRANDS[k], weight=weight)


def faces(axes: Any, knot: Any, seen: Any, drawn: Any) -> None:
    """The circulation of each bounded face, with an arrow round it that says which way."""
    for f, face in enumerate(drawn.faces):
        if not drawn.is_bounded(f):
            continue
        middle = centroid(np.concatenate([side(knot, seen, drawn, p) for p in face]))
        circulation = drawn.circulation(f)
        axes.text(
            *middle, f"{abs(circulation)}/{len(face)}", ha="center", va="center", fontsize=8, zorder=20_000
        )
        if circulation:
            angle = np.radians(np.linspace(-60, 240, 60))[:: 1 if circulation > 0 else -1]
            turn = middle + 0.62 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            axes.plot(*turn[:-4].T, color=GREY, lw=1.1, zorder=19_000)
            arrow(axes, turn[-8], turn[-1], GREY, 9)


def side(knot: Any, seen: Any, drawn: Any, dart: int) -> np.ndarray:
    """The points of the curve along a dart, as seen from above."""
    ports = (dart, drawn.mate[dart])
    at = [seen.edge[p >> 2, 1 - (p & 1)] + seen.parameter[p >> 2, 1 - (p & 1)] for p in ports]
    x = knot.strands[seen.strand[dart >> 2, 1 - (dart & 1)]]
    s = np.linspace(*at, 30)
    return np.stack([np.interp(s, np.arange(len(x)), x[:, k]) for k in (0, 1)], axis=1)


def centroid(x: np.ndarray) -> np.ndarray:
    """The middle of a polygon's area."""
    y = np.roll(x, -1, axis=0)
    area = x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]
    return np.asarray(((x + y) * area[:, None]).sum(axis=0) / (3 * area.sum()))


def between(x: np.ndarray, edge: int, parameter: float) -> np.ndarray:
    """A point of a polyline as seen from above, counted in edges from a node; closed ones go on."""
    k = int(np.floor(edge + parameter))
    part = edge + parameter - k
    return np.asarray(x[k % len(x)] * (1 - part) + x[(k + 1) % len(x)] * part)[:2]


def badge(axes: Any, place: np.ndarray, sign: int) -> None:
    """A charge beside its crossing."""
    axes.text(
        *place, "+" if sign > 0 else "−", ha="center", va="center", fontsize=10, color="white", zorder=20_000,
        bbox={"boxstyle": "circle,pad=0.1", "fc": POSITIVE if sign > 0 else NEGATIVE, "ec": "none"},
    )  # fmt: skip


def links(plt: Any) -> None:
    """A right-handed Hopf link and a Whitehead link: half-sums, and the thesis's sums."""
    figure, both = plt.subplots(1, 2, figsize=(6.4, 3.2))
    for axes, word, name in zip(both, ([1, 1], [-1, -1, 2, -1, 2]), ("Hopf", "Whitehead"), strict=True):
        curves = braid_curves(word, nodes=500)
        seen = project(curves, True)
        width = 1.2 * float(max(np.abs(x).max() for x in curves))
        pieces = [p for x, c in zip(curves, STRANDS, strict=False) for p in rope(x, c, 5, True)]
        weave(axes, pieces)
        lk = seen.diagram.linking[0, 1]
        numbers = f"Lk = {lk:g} (figure 4-4: {2 * lk:g}), Wr = {seen.diagram.writhe}"
        axes.set_title(f"{name}: {numbers}", fontsize=9.5)
        above = zip(seen.strand[:, 0], seen.edge[:, 0], seen.parameter[:, 0], strict=True)
        places = [between(curves[i], e, p) for i, e, p in above]
        for place, sign in zip(places, seen.diagram.signs, strict=True):
            badge(axes, place * (1 + 0.11 * width / np.linalg.norm(place)), sign)
        for x, color in zip(curves, STRANDS, strict=False):
            # Where it is farthest from all crossings.
            k = int(np.argmax(np.linalg.norm(x[:, None, :2] - places, axis=2).min(axis=1)))
            arrow(axes, between(x, k, -3), between(x, k, 3), color, 26)
        axes.set(xlim=(-width, width), ylim=(-width, width), aspect="equal")
        axes.axis("off")
    save(plt, figure, "topology-links.png")


def save(plt: Any, figure: Any, name: str) -> None:
    figure.tight_layout()
    figure.savefig(IMAGES / name, dpi=160, facecolor="white")
    plt.close(figure)


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    crossings(plt)
    bends(plt)
    links(plt)


if __name__ == "__main__":
    main()
