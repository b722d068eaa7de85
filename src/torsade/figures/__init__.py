"""The thesis's figures from the package's own runs: what is run, what is measured, what is drawn.

>>> NUMBERS[:2]
('3-1', '3-4')
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING

from torsade.errors import TorsadeError, quoted

if TYPE_CHECKING:
    from torsade.figures.base import Figure

__all__ = ["NUMBERS", "figure"]

NUMBERS = (
    *("3-1", "3-4", "3-5", "3-6", "3-7", "3-8"),
    *("4-1", "4-2", "4-3", "4-4", "4-5", "4-6", "4-7", "4-8"),
    *("5-1", "5-2", "5-3"),
    *("6-1", "6-2"),
)
"""Figures that can be made."""


def figure(number: str) -> Figure:
    """The figure of this number in the thesis, such as "4-5"; "4.5" and "Figure 4-5" are read too.

    Raises
    ------
    TorsadeError
        When there is no such figure here.
    """
    name = re.sub(r"^fig(ure|\.)?[\s_-]*", "", number.strip(), flags=re.I).replace(".", "-").replace("_", "-")
    if name not in NUMBERS:
        raise TorsadeError(f"there is no figure {quoted(number)}; give one of {', '.join(NUMBERS)}")
    found: Figure = import_module(f"torsade.figures.figure_{name.replace('-', '_')}").FIGURE
    return found
