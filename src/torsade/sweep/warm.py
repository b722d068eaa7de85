"""Kernels compiled once, before several workers would each compile them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING

from torsade.errors import TorsadeError

if TYPE_CHECKING:
    from torsade.protocols.base import Spec

__all__ = ["warm_up"]


class _Warm(BaseException):
    """A run has made its first steps: all that is needed is compiled."""


def warm_up(spec: Spec, tell: Callable[[str], None]) -> None:
    """Begin a run of this protocol, and let it go when its kernels are compiled; where they are, do nothing.

    A run of little time comes to its end; either way nothing of it is kept.
    """
    from torsade import _compile
    from torsade.protocols.driving import preparation

    if _compile.CACHE is None:
        tell(preparation())
        return
    # Compiled code is kept apart for every copy of the package.
    place = hashlib.sha256(str(_compile.PACKAGE).encode()).hexdigest()[:8]
    mark = _compile.CACHE / f"compiled-{spec.protocol}-{place}"
    if mark.exists():
        return
    tell(preparation())

    def heed(share: float, note: str) -> None:
        if share > 0:
            raise _Warm

    try:
        with suppress(_Warm):
            spec.run(heed)
        with suppress(OSError):
            mark.touch()
    except TorsadeError:
        pass  # the sweep will say so of the point
