"""Stored results as datasets: small variables at once, large ones when they are used, all of them vetted."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.variables import ENDS, VARIABLES, grown
from torsade.vetting import Stored, check_files, sound_rows, vetted

if TYPE_CHECKING:
    import xarray

__all__ = ["read"]


def read(path: Path, at_once: int, in_all: int, salvage: bool = False) -> tuple[xarray.Dataset, bool]:
    """The recorded part of a stored result, and whether some of it stays on disk.

    Parameters
    ----------
    at_once : largest variable that is read now [bytes]
    in_all : most that is read now [bytes]
    salvage : where files are lost, read the frames before

    Raises
    ------
    TorsadeError
        When it is damaged, or no run wrote it; of variables that stay on disk, when they are used.
    """
    import xarray

    attrs, described = vetted(path)
    counts = attrs.pop("chunks", {})
    if salvage:
        _cut(path, attrs, described, counts)
    upto = {dim: attrs[name] for dim, name in ENDS.items() if name in attrs}
    late = _large(described, upto, at_once, in_all)
    for name, about in described.items():
        if name not in late:
            check_files(path, name, about, counts.get(name), grown(about.dims, attrs))
    with _sound(path), _quiet():
        opened = xarray.open_dataset(
            path, engine="zarr", chunks=None, consolidated=False, decode_times=False, decode_timedelta=False
        )
        order = [name for name in VARIABLES if name in described]
        whole = {name: opened.variables[name] for name in dict.fromkeys([*order, *described])}
        for name in late:
            about, count = described[name], counts.get(name)
            whole[name] = _late(whole[name], path, name, about, count, grown(about.dims, attrs))
        dataset = xarray.Dataset(whole, attrs=attrs).set_coords(list(opened.coords))
        dataset = dataset.isel({dim: slice(0, n) for dim, n in upto.items() if dim in dataset.dims})
        for at_hand in set(dataset.variables) - late:
            dataset.variables[at_hand].load()
    return dataset, bool(late)


def _cut(path: Path, attrs: dict[str, Any], described: dict[str, Stored], counts: dict[str, Any]) -> None:
    """Change attributes to what there is before the first file that is lost; of that no file is missing."""
    ends = {name: attrs[name] for name in ENDS.values() if name in attrs}
    known = []
    for name, about in described.items():
        upto = grown(about.dims, attrs)
        rows = None if upto is None else sound_rows(path, name, about, counts.get(name), upto)
        if rows is not None:
            known.append(name)
            ends[ENDS[about.dims[0]]] = min(ends[ENDS[about.dims[0]]], rows)
    if ends.get("done"):
        attrs |= ends
        for name in known:
            counts.pop(name, None)


def _large(described: dict[str, Stored], upto: dict[str, int], at_once: int, in_all: int) -> set[str]:
    """The variables that are read when they are used: large ones, and whatever is too much together."""
    sizes = {
        name: math.prod(min(n, upto.get(dim, n)) for dim, n in zip(about.dims, about.shape, strict=True))
        * about.itemsize
        for name, about in described.items()
    }
    late: set[str] = set()
    for name in sorted(sizes, key=lambda name: sizes[name]):
        in_all -= sizes[name]
        if (sizes[name] > at_once or in_all < 0) and name not in described[name].dims:
            late.add(name)
    return late


@contextmanager
def _quiet() -> Iterator[None]:
    """Leave out what zarr says of other files in the folder."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Object at .* is not recognized as a component")
        yield


@contextmanager
def _sound(path: Path, name: str | None = None) -> Iterator[None]:
    """Turn whatever readers of damaged files stumble over into one sentence."""
    try:
        yield
    except TorsadeError:
        raise
    except MemoryError:
        raise TorsadeError(
            f"{name or 'a variable'} of {str(path)!r} does not fit into memory; read it frame by frame"
        ) from None
    except Exception as error:
        reason = " ".join(str(error).split()).rstrip(".")[:160] or type(error).__name__
        what = f"{name!r} in {str(path)!r}" if name else repr(str(path))
        raise TorsadeError(
            f"{what} cannot be read ({reason}); it is damaged: run it anew, or take it from a copy"
        ) from None


def _late(
    variable: xarray.Variable, path: Path, name: str, about: Stored, count: object, upto: int | None
) -> xarray.Variable:
    """A variable that is read, and its files looked at, when it is used; see `check_files`."""
    import xarray
    from xarray.backends import BackendArray
    from xarray.core import indexing

    class Late(BackendArray):
        shape, dtype = variable.shape, variable.dtype
        looked_at = False

        def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
            outer = indexing.IndexingSupport.OUTER
            return indexing.explicit_indexing_adapter(key, self.shape, outer, self.numbers)

        def numbers(self, key: Any) -> NDArray[Any]:
            if not self.looked_at:
                check_files(path, name, about, count, upto)
                self.looked_at = True
            with _sound(path, name):
                return np.asarray(variable[key].values)

    kept = indexing.MemoryCachedArray(  # type: ignore[no-untyped-call]
        indexing.LazilyIndexedArray(Late())
    )
    return xarray.Variable(variable.dims, kept, variable.attrs)
