"""Pictures, movies and plots of a dataset; the libraries that draw are imported when something is drawn.

>>> import torsade as ts
>>> ts.view.plot_separation.__name__
'plot_separation'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from torsade.view.battery import draw_battery, plot_battery
    from torsade.view.cascade import along_rod, draw_pieces, pieces_at, plot_cascade
    from torsade.view.film import movie
    from torsade.view.history import plot_result
    from torsade.view.plots import (
        plot_bent,
        plot_move,
        plot_separation,
        plot_swing,
        plot_tightening,
        plot_wound,
    )
    from torsade.view.scene import render, render_result
    from torsade.view.strands import strands_at
    from torsade.view.window import show

__all__ = [
    "along_rod",
    "draw_battery",
    "draw_pieces",
    "movie",
    "pieces_at",
    "plot_battery",
    "plot_bent",
    "plot_cascade",
    "plot_move",
    "plot_result",
    "plot_separation",
    "plot_swing",
    "plot_tightening",
    "plot_wound",
    "render",
    "render_result",
    "show",
    "strands_at",
]

_HOMES = {
    "along_rod": "torsade.view.cascade",
    "pieces_at": "torsade.view.cascade",
    "draw_battery": "torsade.view.battery",
    "plot_battery": "torsade.view.battery",
    "draw_pieces": "torsade.view.cascade",
    "movie": "torsade.view.film",
    "plot_cascade": "torsade.view.cascade",
    "plot_bent": "torsade.view.plots",
    "plot_move": "torsade.view.plots",
    "plot_result": "torsade.view.history",
    "plot_separation": "torsade.view.plots",
    "plot_swing": "torsade.view.plots",
    "plot_tightening": "torsade.view.plots",
    "plot_wound": "torsade.view.plots",
    "render": "torsade.view.scene",
    "render_result": "torsade.view.scene",
    "show": "torsade.view.window",
    "strands_at": "torsade.view.strands",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'torsade.view' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
