"""The canonical form tells drawings apart, and nothing else."""

from __future__ import annotations

import random
from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from topology.drawings import scrambled
from torsade.topology import Diagram, canonical_form, is_isomorphic
from torsade.topology.codes import from_braid, from_dt, from_gauss, to_dt
from torsade.topology.tangle import integer, numerator, rational, rotated

TREFOIL = from_braid([1, 1, 1])
FIGURE_EIGHT = from_braid([1, -2, 1, -2])


def renumbered(d: Diagram, rng: random.Random) -> Diagram:
    """The same drawing with its crossings and strands in another order."""
    order = list(range(d.n_crossings))
    rng.shuffle(order)
    new = {p: p if p < 0 else 4 * order[p >> 2] + (p & 3) for p in d.ports}
    mate = [0] * len(d.mate)
    for p in d.ports:
        mate[new[p]] = new[d.mate[p]]
    heads = [
        new[rng.choice(s) ^ 2] if s and start >= 0 else start
        for s, start in zip(d.strands, d.starts, strict=True)
    ]
    rng.shuffle(heads)
    return Diagram.assemble(mate, heads, d.ends, outer=[new[p] for p in d.outer])


@settings(deadline=None)
@given(st.sampled_from([[1, 1, 1], [1, -2] * 3, [1, 1, -3, 2, 4]]), st.integers(0, 10**6))
def test_numbers_do_not_matter(word: list[int], seed: int) -> None:
    rng = random.Random(seed)
    d = scrambled(from_braid(word), 14, rng)
    other = renumbered(d, rng)
    assert canonical_form(other) == canonical_form(d)
    assert is_isomorphic(other, d)
    assert is_isomorphic(other.reverse(), d, unoriented=True)
    assert canonical_form(other, plane=True) == canonical_form(d, plane=True) or not d.outer


@settings(deadline=None)
@given(st.integers(0, 10**6))
def test_tangles_are_held_by_their_ends(seed: int) -> None:
    rng = random.Random(seed)
    d = scrambled(rational(2, 3), 14, rng)
    assert canonical_form(renumbered(d, rng)) == canonical_form(d)
    assert canonical_form(rotated(d)) == canonical_form(d)  # names go along
    assert canonical_form(d.renamed(d.ends[1:] + d.ends[:1])) != canonical_form(d)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.sampled_from([1, -1, 2, -2, 3, -3]), min_size=3, max_size=7), st.integers(0, 10**6))
def test_directions_left_out_are_all_directions_tried(word: list[int], seed: int) -> None:
    rng = random.Random(seed)
    d = from_braid(word, 4)
    other = rng.choice([d, d.mirror(), d.reflected(), from_braid(rng.sample(word, len(word)), 4)])
    strands = range(other.n_strands)
    tried = {canonical_form(other.reverse(chosen)) for n in range(5) for chosen in combinations(strands, n)}
    assert is_isomorphic(d, renumbered(other, rng), unoriented=True) == (canonical_form(d) in tried)


def test_links_of_many_strands() -> None:
    """A chain of thirty rings: no choice of directions is tried one after the other."""
    chain = from_braid([k for i in range(1, 30) for k in (i, i)])
    mixed = chain.reverse(random.Random(1).sample(range(30), 11))
    assert not is_isomorphic(chain, mixed)
    assert is_isomorphic(chain, mixed, unoriented=True)
    assert to_dt(from_dt(to_dt(mixed))) == to_dt(mixed)


def test_mirror_images_and_directions() -> None:
    assert not is_isomorphic(TREFOIL, TREFOIL.mirror(), unoriented=True)
    assert is_isomorphic(TREFOIL, TREFOIL.reverse())
    assert is_isomorphic(FIGURE_EIGHT, FIGURE_EIGHT.mirror(), unoriented=True)
    link = from_braid([1, 1, 1, 1])
    assert not is_isomorphic(link, link.reverse([0]))
    assert is_isomorphic(link, link.reverse([0]), unoriented=True)
    assert not is_isomorphic(TREFOIL, FIGURE_EIGHT)
    assert not is_isomorphic(integer(3), numerator(integer(3)))


def test_the_plane_tells_more_than_the_sphere() -> None:
    """A trefoil with a kink, drawn with different faces outside."""
    d = from_gauss("O1+ U2+ O3+ U1+ O2+ U3+ O4+ U4+")
    drawings = {canonical_form(Diagram(d.mate, d.ends, d.starts, (f[0],)), plane=True) for f in d.faces}
    assert len(drawings) == len(d.faces)
    assert len({canonical_form(Diagram(d.mate, d.ends, d.starts, (f[0],))) for f in d.faces}) == 1


def test_circles_and_pieces_count() -> None:
    forms = [
        canonical_form(d)
        for d in (
            TREFOIL,
            TREFOIL | Diagram.circle(),
            TREFOIL | TREFOIL,
            TREFOIL | FIGURE_EIGHT,
            Diagram.circle(),
        )
    ]
    assert len(set(forms)) == 5
    assert canonical_form(TREFOIL | FIGURE_EIGHT) == canonical_form(FIGURE_EIGHT | TREFOIL)
    assert is_isomorphic(Diagram.circle(), Diagram.circle())
