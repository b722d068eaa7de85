"""How well what is counted on a drawing orders what is measured on pulled bends: each rule, and all together.

A rule gives every bend a number, or says of every pair which holds better; the rank correlation with c_f
tells how well it orders them. One rule is fitted, and judged on knots that the fit has not seen; one speaks
of some pairs only, so that it has right and wrong ones and no correlation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import bends
from torsade.figures.base import Cell, Choice, Table
from torsade.figures.ranking import agreement, dominance

__all__ = ["ALL_THREE", "FITTED", "RULES", "disagreements", "rules_table", "scores"]

Columns = Mapping[str, Sequence[Any]]

THREE = ("N", "tau", "Gamma")
"""What the thesis counts on a drawing."""

TIED = 1e-12
"""Differences of log c_f that are none."""

ALL_THREE = "N, tau and Gamma agree"
"""The rule that only speaks where a bend has no less of any of the three and more of one."""

FITTED = "linear in N, tau, Gamma"
"""The rule whose coefficients are fitted to log c_f, for each pair of bends, of all other knots."""


def _counted(name: str) -> Callable[[Columns], Floats]:
    return lambda found: np.asarray(found[name], np.float64)


def _in_turn(*names: str) -> Callable[[Columns], Floats]:
    """The order by the first of these; where that is the same, by the second, and so on."""

    def score(found: Columns) -> Floats:
        rows = np.stack([np.asarray(found[name], np.float64) for name in names], axis=1)
        return np.unique(rows.round(9), axis=0, return_inverse=True)[1].reshape(-1).astype(np.float64)

    return score


def _left_out(found: Columns) -> Floats:
    """The order of pairs (n, n) by a linear least-squares fit of log c_f in N, tau and Gamma to other knots.

    Each pair has a fit of its own, which sees neither of its two knots. Predictions of different fits are not
    compared: a fit without the strong knots predicts less, which would rank those that it leaves out low.
    """
    terms = [np.ones(len(found["knot"])), *(np.asarray(found[k], np.float64) for k in THREE)]
    design, target = np.stack(terms, axis=1), np.log(np.asarray(found["c_f"], np.float64))
    families = np.array(_families(found))
    order = np.zeros((len(target), len(target)))
    names = sorted(set(families.tolist()))
    for one, other in combinations_with_replacement(names, 2):
        seen = (families != one) & (families != other)
        fit = np.linalg.lstsq(design[seen], target[seen], rcond=None)[0]
        pair = np.ix_(families == one, families == other)
        apart = (design[:, None] - design[None])[pair] @ fit
        signs = np.sign(np.where(abs(apart) > TIED, apart, 0.0))
        order[pair] = signs
        order.T[pair] = -signs
    return order


RULES: Mapping[str, Callable[[Columns], Floats]] = {
    "N": _counted("N"),
    "N, fewest": _counted("N_fewest"),
    "tau": _counted("tau"),
    "Gamma": _counted("Gamma"),
    "Gamma, least": _counted("Gamma_least"),
    "Gamma, greatest": _counted("Gamma_greatest"),
    "Whitney, absolute": lambda found: np.abs(_counted("Whitney")(found)),
    "N tau": lambda found: _counted("N")(found) * _counted("tau")(found),
    "N, then tau, then Gamma": _in_turn("N", "tau", "Gamma"),
    "tau, then Gamma, then N": _in_turn("tau", "Gamma", "N"),
    FITTED: _left_out,
}
"""What orders bends: columns of a table of bends → a number for each (n,), or the order of pairs (n, n)."""

COLUMNS = (
    *("preset", "bends", "rule", "n"),
    *(f"{name}{end}" for name in ("kendall", "spearman") for end in ("", "_low", "_high")),
    *("kendall_low_by_knot", "kendall_high_by_knot", "pairs_right", "pairs_wrong", "net"),
)


def scores(found: Columns) -> dict[str, Floats]:
    """What each rule gives each bend (n,) or pair (n, n), columns as of `bends.distinct`."""
    return {rule: score(found) for rule, score in RULES.items() if rule != FITTED or _can_fit(found)}


def rules_table(table: Table, choice: Choice) -> Table:
    """How each rule orders bends by c_f: correlations with intervals over bends, and over whole knots.

    The second interval draws all pulls of a knot at once: a knot pulled by other ends has the same N, and is
    no independent witness. net is (right - wrong) over all pairs. The last rule of a block has pairs alone.
    """
    rows: list[tuple[Cell, ...]] = []
    for preset in choice.presets:
        for which, found in bends.distinct(table, preset).items():
            for rule, score in scores(found).items():
                of = agreement(score, found["c_f"])
                by_knot = agreement(score, found["c_f"], _families(found)).kendall
                numbers = (*of.kendall, *of.spearman, by_knot.low, by_knot.high, of.right, of.wrong, of.net)
                rows.append((preset, which, rule, of.n, *numbers))
            right, wrong = (int((_three(found) * _apart(found) == sign).sum()) // 2 for sign in (1, -1))
            blank = (None,) * 8
            rows.append((preset, which, ALL_THREE, len(found["c_f"]), *blank, right, wrong, None))
    return Table(COLUMNS, rows)


def disagreements(table: Table, choice: Choice) -> Table:
    """Pairs of the thesis's bends that N, tau and Gamma all order one way and c_f the other.

    with_fewest_N: whether they still do when N is that of a drawing with fewest crossings.
    """
    columns = (
        *("preset", "stronger_by_rules", "weaker_by_rules"),
        *(f"{name}_{side}" for side in ("stronger", "weaker") for name in (*THREE, "c_f")),
        *("c_f_ratio", "with_fewest_N"),
    )
    rows: list[tuple[Cell, ...]] = []
    for preset in choice.presets:
        found = bends.distinct(table, preset)["thesis"]
        c_f = np.asarray(found["c_f"], np.float64)
        fewest = _three(found, "N_fewest") > 0
        pairs = np.argwhere((_three(found) > 0) & (_apart(found) < 0))
        for i, j in sorted(pairs.tolist(), key=lambda pair: float(c_f[pair[0]] / c_f[pair[1]])):
            numbers = (found[name][k] for k in (i, j) for name in (*THREE, "c_f"))
            last = (float(c_f[i] / c_f[j]), bool(fewest[i, j]))
            rows.append((preset, found["knot"][i], found["knot"][j], *numbers, *last))
    return Table(columns, rows)


def _three(found: Columns, crossings: str = "N") -> Floats:
    """The order of pairs in which N, tau and Gamma agree."""
    names = (crossings, *THREE[1:])
    return dominance(np.stack([np.asarray(found[name], float) for name in names], axis=1))


def _apart(found: Columns) -> Floats:
    """The order of pairs by c_f."""
    c_f = np.asarray(found["c_f"], np.float64)
    return np.asarray(np.sign(c_f[:, None] - c_f[None]))


def _families(found: Columns) -> list[str]:
    """The knot that each bend is, however it is pulled."""
    return [bends.family(str(knot)) for knot in found["knot"]]


def _can_fit(found: Columns) -> bool:
    """Whether any two knots can be left out and four coefficients still be found."""
    families = _families(found)
    most = sorted(map(families.count, set(families)))[-2:]
    return len(families) - sum(most) > 4
