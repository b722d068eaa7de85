"""The history of any result in one plot: which of the plots belongs to which protocol."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from torsade.errors import TorsadeError, quoted
from torsade.view.battery import plot_battery
from torsade.view.cascade import plot_cascade
from torsade.view.plots import (
    plot_bent,
    plot_move,
    plot_separation,
    plot_swing,
    plot_tightening,
    plot_wound,
)

if TYPE_CHECKING:
    import xarray

__all__ = ["plot_result"]

BY_PROTOCOL = {
    "prison-escape": plot_separation,
    "tighten": plot_tightening,
    "reidemeister": plot_move,
    "bend-twist": plot_bent,
    "pendulum": plot_swing,
    "battery": plot_battery,
    "suture": plot_wound,
    "snap-twist": plot_cascade,
    "snap-quench": plot_cascade,
}


def plot_result(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot the history of a result, as `--plot` does.

    Parameters
    ----------
    dataset : of any protocol
    path : the file to write; its ending chooses the format (png, pdf, svg)

    Raises
    ------
    TorsadeError
        When the protocol is not known here, or the file cannot be written.
    """
    protocol = dataset.attrs.get("protocol")
    if protocol not in BY_PROTOCOL:
        raise TorsadeError(f"there is no plot of {quoted(protocol)}; choose one of {', '.join(BY_PROTOCOL)}")
    return BY_PROTOCOL[protocol](dataset, path)
