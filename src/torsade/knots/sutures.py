"""Sutures as diagrams: two throws stacked on each other, as a surgeon ties them (thesis, chapter 6).

A throw of n crossings, n odd, wraps one strand about the other; it is right-handed if n > 0. With both
strands running from end 0 to end 1, (3, -3) is the reef, (3, 3) the granny and (5, -3) the surgeon's knot.
"""

from __future__ import annotations

from torsade.errors import TorsadeError
from torsade.topology.codes import from_gauss
from torsade.topology.diagram import Diagram

__all__ = ["suture_diagram"]

LONGEST = 99


def suture_diagram(bottom: int, top: int) -> Diagram:
    """The diagram of a suture, with strands A and B running towards A1 and B1.

    Args:
        bottom: half turns of the throw tied first, odd; right-handed if positive.
        top: those of the throw on it.

    >>> suture_diagram(5, -3).writhe
    2

    Raises:
        TorsadeError: a number that is even, or a throw of more than 99 crossings.
    """
    for n in (bottom, top):
        if n % 2 == 0 or abs(n) > LONGEST:
            raise TorsadeError(
                f"a suture of {bottom} and {top} half turns is asked for; give two odd numbers up to "
                f"{LONGEST}, negative where left-handed, such as 5,-3"
            )
    first, count = abs(bottom), abs(bottom) + abs(top)
    signs = [bottom > 0] * first + [top > 0] * abs(top)
    # In a right-handed throw A begins above in the first and below in the second.
    over = [(k % 2 == 0) == right for k, right in enumerate(signs)]

    def passage(k: int, above: bool) -> str:
        return f"{'O' if above else 'U'}{k + 1}{'+' if signs[k] else '-'}"

    a = [passage(k, over[k]) for k in range(count)]
    b = [passage(k, not over[k]) for k in (*range(first - 1, -1, -1), *range(count - 1, first - 1, -1))]
    return from_gauss(f"{' '.join(a)} | {' '.join(b)}", closed=False)
