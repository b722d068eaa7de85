"""Codes of diagrams, in and out.

| code | in | out |
| --- | --- | --- |
| PD | `from_pd` | `to_pd`, and `to_open_pd` for tangles |
| Gauss, signed or not | `from_gauss` | `to_gauss`, `to_unsigned_gauss` |
| Dowker-Thistlethwaite | `from_dt` | `to_dt` |
| braid word | `from_braid` | `to_braid` |
| Conway notation | `from_conway` | `to_conway`, of prime diagrams |
| any of these as text | `from_text` | |
"""

from torsade.topology.codes.braid import from_braid, to_braid
from torsade.topology.codes.conway import from_conway
from torsade.topology.codes.conway_out import to_conway
from torsade.topology.codes.dowker import from_dt, to_dt
from torsade.topology.codes.gauss import from_gauss, to_gauss, to_unsigned_gauss
from torsade.topology.codes.pd import from_pd, to_open_pd, to_pd
from torsade.topology.codes.text import BEGINNINGS, code_kind, from_text, leaves_mirror_open

__all__ = [
    "BEGINNINGS",
    "code_kind",
    "from_braid",
    "from_conway",
    "from_dt",
    "from_gauss",
    "from_pd",
    "from_text",
    "leaves_mirror_open",
    "to_braid",
    "to_conway",
    "to_dt",
    "to_gauss",
    "to_open_pd",
    "to_pd",
    "to_unsigned_gauss",
]
