"""Experiments: a specification in, a result out. One file each, and `load_spec` to read one from TOML."""

from __future__ import annotations

from torsade.protocols.base import Spec
from torsade.protocols.battery import Battery
from torsade.protocols.bend_twist import BendTwist
from torsade.protocols.ensemble import ensemble
from torsade.protocols.files import PROTOCOLS, load_spec
from torsade.protocols.pendulum import Pendulum
from torsade.protocols.prison_escape import PrisonEscape
from torsade.protocols.reidemeister import Reidemeister
from torsade.protocols.snap_quench import SnapQuench
from torsade.protocols.snap_twist import SnapTwist
from torsade.protocols.suture import Suture
from torsade.protocols.tighten import Tighten

__all__ = [
    "PROTOCOLS",
    "Battery",
    "BendTwist",
    "Pendulum",
    "PrisonEscape",
    "Reidemeister",
    "SnapQuench",
    "SnapTwist",
    "Spec",
    "Suture",
    "Tighten",
    "ensemble",
    "load_spec",
]
