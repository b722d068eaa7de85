"""Codes that leave mirror images open: DT codes, and Gauss codes without signs."""

from __future__ import annotations

from itertools import product

import pytest

from hanging import no_hang
from torsade.topology import identify, named_diagram, tangle
from torsade.topology.codes import from_dt, from_gauss, to_dt, to_unsigned_gauss


@pytest.mark.parametrize(
    "name", ["3_1", "m5_2", "4_1", "3_1#m3_1", "3_1#3_1", "3_1#4_1", "3_1#mL5a1", "m5_1#6_2"]
)
def test_all_choices_of_mirror_images_are_named(name: str) -> None:
    """The names and those of their mirror images are what mirroring each summand by hand gives."""
    by_hand = set()
    for flips in product(("", "m"), repeat=name.count("#") + 1):
        parts = (named_diagram(p) for p in name.split("#"))
        whole, *more = (d.mirror() if flip else d for d, flip in zip(parts, flips, strict=True))
        for d in more:
            whole = tangle.connected_sum(whole, d)
        by_hand |= set(identify(whole).names)
    given = named_diagram(name)
    for drawn in (from_dt(to_dt(given)), from_gauss(to_unsigned_gauss(given))):
        found = identify(drawn, handed=False)
        assert (
            set(found.names) | {identify(named_diagram(one).mirror()).names[0] for one in found.names}
            == by_hand
        )
        assert set(identify(drawn).names) <= set(found.names)
        assert found.certain == (len(found.names) == 1)
        assert ("the code leaves the mirror image" in found.reason) == (len(by_hand) > 1)
    assert (identify(given).certain, identify(given).reason) == (True, "")


def test_split_pieces_are_open_each_by_itself() -> None:
    pieces = tangle.union(named_diagram("3_1"), named_diagram("5_1"))
    assert identify(pieces, handed=False).names == ("3_1 ⊔ 5_1", "3_1 ⊔ m5_1")
    ring = tangle.union(named_diagram("3_1"), named_diagram("unknot"))
    assert identify(ring, handed=False).names == ("0_1 ⊔ 3_1",)


def test_many_summands() -> None:
    assert len(identify(named_diagram("3_1#5_1#5_2#m7_1"), handed=False).names) == 8
    with no_hang():
        found = identify(named_diagram("3_1#5_1#5_2#6_1#6_2#7_1#7_2#7_3"), handed=False)
    assert (len(found.names), found.certain) == (1, False)
    assert "of the others one choice out of many" in found.reason
