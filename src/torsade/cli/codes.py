"""Codes of a diagram as text, for reports."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from torsade.errors import TorsadeError
from torsade.topology.codes import to_conway, to_dt, to_gauss, to_open_pd, to_pd
from torsade.topology.diagram import Diagram

__all__ = ["codes_of"]


def codes_of(diagram: Diagram) -> dict[str, str | None]:
    """Codes as `from_text` reads them: PD, Gauss, DT and Conway; None where there is none."""
    if diagram.ends:
        return {"pd": _pd_text(to_open_pd(diagram)), "gauss": None, "dt": None, "conway": None}
    writers: dict[str, Callable[[Diagram], str]] = {
        "pd": lambda d: _pd_text(to_pd(d)),
        "gauss": to_gauss,
        "dt": lambda d: f"DT: {to_dt(d)}",
        "conway": lambda d: f"[{to_conway(d)}]",
    }
    return {name: _if_any(write, diagram) for name, write in writers.items()}


def _if_any(write: Callable[[Diagram], str], diagram: Diagram) -> str | None:
    try:
        return write(diagram)
    except TorsadeError:
        return None


def _pd_text(rows: Iterable[Iterable[object]]) -> str:
    return " ".join(f"X[{','.join(map(str, row))}]" for row in rows)
