"""What a file of trials says: each trial, trials of one speed, sectors of twist and curvature, fits.

Numbers per speed, and the fits to them, are of rods that were not twisted: twist changes the pieces too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from torsade.errors import TorsadeError
from torsade.fracture.criteria import CriterionName, matching_strength, stress
from torsade.fracture.fits import Fit, power_law, saturation
from torsade.fracture.rod import Rod
from torsade.fracture.statistics import (
    Mean,
    Rays,
    Sector,
    Share,
    mean,
    sectors,
    share,
    smallest_fragment,
)
from torsade.fracture.theory.bending_wave import AMPLIFICATION
from torsade.fracture.theory.binary import Threshold, li, li_threshold, threshold
from torsade.fracture.theory.elastica import curvature_at
from torsade.fracture.trials import Trial
from torsade.motion import equilibrium
from torsade.motion.supports import Fiber

__all__ = ["Analysis", "AtSpeed", "Broken", "Fits", "analyse"]

EDGES = 120
"""Of a twisted rod whose shape is computed from the distance of its ends."""


@dataclass(frozen=True)
class Broken:
    """A trial and what follows from it; None where it cannot be known.

    Attributes
    ----------
    trial : as it was read
    kappa, kappa_low, kappa_high : limit curvature, and its range from the error of the distance [1/m]
    planar : whether that curvature is of a planar shape although the rod was twisted, for want of another
    li : weight of twist over bending (3.3)
    stress : of the criterion, when it broke [Pa]
    fragment : lambda* (3.3) [m]
    """

    trial: Trial
    kappa: float | None
    kappa_low: float | None
    kappa_high: float | None
    planar: bool
    li: float | None
    stress: float | None
    fragment: float | None


@dataclass(frozen=True)
class AtSpeed:
    """Untwisted rods that were broken at one speed; None where nothing was measured.

    Attributes
    ----------
    speed : at which the ends approached each other [m/s]
    pieces : their number; breaks are one fewer
    binary : how many broke in two
    fragment : lambda, the mean of lambda* [m]
    kappa : limit curvature [1/m]
    """

    speed: float
    pieces: Mean
    binary: Share
    fragment: Mean | None
    kappa: Mean | None


@dataclass(frozen=True)
class Fits:
    """Curves through what was measured at several speeds; None where it cannot be fitted, with the reason.

    Attributes
    ----------
    fragment : lambda = amplitude v^exponent, -1/4 in theory
    breaks : N_f = amplitude v^exponent at low speed, 1/4 in theory
    saturation : N_f = limit erfc(sqrt(B^2/v))
    reasons : why there is none, by name
    """

    fragment: Fit | None
    breaks: Fit | None
    saturation: Fit | None
    reasons: dict[str, str]


@dataclass(frozen=True)
class Analysis:
    """All that was found out.

    Attributes
    ----------
    each : every trial
    speeds : untwisted rods by speed
    sectors : averages over the plane of twist and limit curvature
    fits : through the speeds
    stress : mean of the stress at breaking [Pa], an estimate of the strength
    threshold : of the criterion, where rods begin to break in two
    beyond, before : how many broke in two with Li above and below the threshold
    """

    each: list[Broken]
    speeds: list[AtSpeed]
    sectors: list[Sector]
    fits: Fits
    stress: Mean | None
    threshold: Threshold
    beyond: Share | None
    before: Share | None


def analyse(
    trials: Sequence[Trial],
    rod: Rod,
    sigma_c: float,
    *,
    criterion: CriterionName = "effective",
    C: float = AMPLIFICATION,
    count: int = 10,
    rays: Rays = "ellipse",
    slow: float = math.inf,
) -> Analysis:
    """Everything.

    Parameters
    ----------
    trials : at least one
    rod : that was broken
    sigma_c : strength [Pa] in terms of `effective`; the others' follow from it
    criterion : of the stresses and the threshold
    C : amplification of the curvature by waves
    count, rays : of sectors, see `statistics.sectors`
    slow : the power law of breaks is fitted up to this speed [m/s]
    """
    each = [_broken(trial, rod, criterion) for trial in trials]
    placed = [b for b in each if b.kappa is not None]
    speeds = _speeds(each, rod)
    limit = li_threshold(C, criterion)
    stresses = [b.stress for b in each if b.stress is not None]
    return Analysis(
        each=each,
        speeds=speeds,
        sectors=sectors(
            [b.trial.twist for b in placed],
            [b.kappa or 0.0 for b in placed],
            [b.trial.pieces for b in placed],
            rod,
            count,
            rays,
        ),
        fits=_fits(speeds, slow),
        stress=mean(stresses) if stresses else None,
        threshold=threshold(rod, matching_strength(sigma_c, criterion), C, criterion),
        beyond=_binary([b for b in placed if b.li is not None and b.li > limit]),
        before=_binary([b for b in placed if b.li is not None and b.li <= limit]),
    )


def _broken(trial: Trial, rod: Rod, criterion: str) -> Broken:
    kappa, planar = trial.limit_curvature, False
    low = high = kappa
    if kappa is None and trial.end_distance is not None:
        (kappa, low, high), planar = _curvature(trial, rod)
    sigma = None
    if kappa is not None:
        sigma = float(stress(kappa, trial.twist / rod.L, rod.E, rod.mu, rod.h, criterion))
    return Broken(
        trial=trial,
        kappa=kappa,
        kappa_low=low,
        kappa_high=high,
        planar=planar,
        li=None if kappa is None or (kappa == 0 and trial.twist == 0) else li(trial.twist, kappa, rod),
        stress=sigma,
        fragment=smallest_fragment(trial.pieces, trial.smallest, rod.L),
    )


def _curvature(trial: Trial, rod: Rod) -> tuple[tuple[float, float, float], bool]:
    """Largest curvature from the end-to-end distance with its range, and whether it is of a planar shape.

    Without twist the elastica in closed form. With it the equilibrium in the twist device, whose error is
    smaller than 1e-3; where there is none, as with straight rods, the elastica again.
    """
    assert trial.end_distance is not None
    if trial.twist:
        fiber = Fiber(rod.L, EDGES, rod.B, rod.C)
        try:
            return (
                equilibrium.curvature_at_distance(
                    fiber, trial.end_distance, trial.twist, trial.end_distance_error
                ),
                False,
            )
        except TorsadeError:
            pass
    return curvature_at(rod.L, trial.end_distance, trial.end_distance_error), trial.twist != 0


def _binary(group: Sequence[Broken]) -> Share | None:
    return share(sum(b.trial.pieces == 2 for b in group), len(group)) if group else None


def _speeds(each: Sequence[Broken], rod: Rod) -> list[AtSpeed]:
    """Untwisted rods, by their speeds in six digits."""
    groups: dict[float, list[Broken]] = {}
    for b in each:
        if b.trial.speed is not None and b.trial.twist == 0:
            groups.setdefault(float(f"{b.trial.speed:.6g}"), []).append(b)
    found = []
    for speed, group in sorted(groups.items()):
        fragments = [b.fragment for b in group if b.fragment is not None]
        curvatures = [b.kappa for b in group if b.kappa is not None]
        found.append(
            AtSpeed(
                speed=speed,
                pieces=mean([b.trial.pieces for b in group]),
                binary=share(sum(b.trial.pieces == 2 for b in group), len(group)),
                fragment=mean(fragments) if fragments else None,
                kappa=mean(curvatures) if curvatures else None,
            )
        )
    return found


def _fits(speeds: Sequence[AtSpeed], slow: float) -> Fits:
    lengths = [(s.speed, s.fragment) for s in speeds if s.fragment is not None]
    numbers = [(s.speed, s.pieces) for s in speeds]
    slowly = [(v, pieces) for v, pieces in numbers if v <= slow]
    found: dict[str, Fit | None] = {}
    reasons: dict[str, str] = {}
    attempts: tuple[tuple[str, list[tuple[float, Mean]], float, Callable[..., Fit]], ...] = (
        ("fragment", lengths, 0.0, power_law),
        ("breaks", slowly, 1.0, power_law),
        ("saturation", numbers, 1.0, saturation),
    )
    for name, points, less, curve in attempts:
        means = [m for _, m in points]
        try:
            found[name] = curve([v for v, _ in points], [m.value - less for m in means], _errors(means))
        except TorsadeError as error:
            found[name], reasons[name] = None, str(error)
    return Fits(**found, reasons=reasons)


def _errors(means: Sequence[Mean]) -> list[float] | None:
    """Standard errors from the deviation of all groups together; None where nothing scatters.

    Deviations of single groups are uncertain, and zero where few trials agree by chance.
    """
    freedom = sum(m.n - 1 for m in means)
    squares = sum((m.n - 1) * m.deviation**2 for m in means if m.n > 1)
    if not freedom or not squares:
        return None
    pooled = math.sqrt(squares / freedom)
    return [float(e) for e in pooled / np.sqrt([m.n for m in means])]
