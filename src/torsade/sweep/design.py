"""What a sweep runs: a protocol, and which fields of its specification take which values.

protocol = "snap-twist"

[fixed]
disorder = 0.05

[grid]
twist = { from = "0 deg", to = "350 deg", count = 36 }
seed = { from = 0, to = 99 }
"""

from __future__ import annotations

import difflib
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from torsade.errors import TorsadeError, named, quoted
from torsade.protocols import stored
from torsade.protocols.files import beside, check_protocol, read_toml
from torsade.protocols.sentences import dimension_of
from torsade.sweep.axes import DESIGNS, MOST_VALUES, check_field, draws, values
from torsade.units import said

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.sweep.query import Catalogue

__all__ = ["MOST_POINTS", "Point", "Sweep"]

MOST_POINTS = 100_000
"""A sweep of more has to be asked for."""

TABLES = ("protocol", "keep", "fixed", "grid", "zip", "random", "points", "cluster")
KEEP = ("numbers", "results")


class Point(NamedTuple):
    """One specification of a sweep.

    Attributes
    ----------
    number : its place in the design, from 0
    key : a hash of all that decides its result
    spec : what to run
    """

    number: int
    key: str
    spec: Spec


class Axis(NamedTuple):
    """Fields that vary together, and the values they take, a row for each."""

    fields: tuple[str, ...]
    rows: Sequence[Sequence[Any]]


class Sweep:
    """A protocol and the values of its fields: every combination of the axes, the first axis slowest.

    Every field of `grid` is an axis; `zip`, `points` and `random` are one each.

    Parameters
    ----------
    protocol : name of the protocol
    fixed : fields that have one value
    grid : fields, each with a list of values or a range; all combinations are run
    zip : fields with lists or ranges of one length, which go together
    points : tables of fields, each one combination
    random : `count`, `fields`, and where wanted `seed` and `design` (uniform, sobol, latin)
    keep : "numbers", or "results" to store whole results too
    cluster : options of a queue: queue, account, cores, memory, walltime, processes

    Raises
    ------
    TorsadeError
        When a field is unknown or given twice, a list is empty, a unit is wrong.
    """

    def __init__(
        self,
        protocol: str,
        *,
        fixed: Mapping[str, Any] | None = None,
        grid: Mapping[str, Any] | None = None,
        zip: Mapping[str, Any] | None = None,
        points: Sequence[Mapping[str, Any]] = (),
        random: Mapping[str, Any] | None = None,
        keep: str = "numbers",
        cluster: Mapping[str, Any] | None = None,
    ) -> None:
        self.spec = check_protocol(protocol, "the sweep")
        self.protocol = protocol
        if keep not in KEEP:
            raise TorsadeError(f"keep is {quoted(keep)}; give one of {' or '.join(KEEP)}")
        self.keep = keep
        self.cluster = dict(_table("cluster", cluster))
        self.fixed = dict(_table("fixed", fixed))
        for name, value in self.fixed.items():
            check_field(self.spec, name)
            if isinstance(value, list | dict):
                raise TorsadeError(
                    f"{name} in [fixed] is {quoted(value)}; give one value, or put it in [grid]"
                )
        self.axes = tuple(
            self._axes(_table("grid", grid), _table("zip", zip), points, _table("random", random))
        )
        _check_once([*self.fixed, *(name for axis in self.axes for name in axis.fields)])

    def _axes(
        self, grid: Mapping[str, Any], zipped: Mapping[str, Any], points: object, random: Mapping[str, Any]
    ) -> Iterator[Axis]:
        for name, given in grid.items():
            yield Axis((name,), [(value,) for value in values(self.spec, name, given, "[grid]")])
        if zipped:
            yield _zipped({name: values(self.spec, name, given, "[zip]") for name, given in zipped.items()})
        if points:
            yield self._listed(points)
        if random:
            yield self._random(random)

    def _listed(self, points: object) -> Axis:
        if not isinstance(points, Sequence) or not all(isinstance(p, Mapping) and p for p in points):
            raise TorsadeError(
                "points is not a list of tables; begin each with [[points]], then give its fields"
            )
        fields = tuple(points[0])
        for k, point in enumerate(points):
            if set(point) != set(fields):
                raise TorsadeError(
                    f"entry {k + 1} of [[points]] has the fields {', '.join(point)}, the first has "
                    f"{', '.join(fields)}; give all of them the same fields"
                )
        where = "[[points]]"
        columns = [values(self.spec, name, [point[name] for point in points], where) for name in fields]
        return Axis(fields, list(zip(*columns, strict=True)))

    def _random(self, given: Mapping[str, Any]) -> Axis:
        known = ("count", "seed", "design", "fields")
        unknown = next((name for name in given if name not in known), None)
        if unknown is not None:
            raise TorsadeError(
                f"[random] has {unknown!r}; it takes {', '.join(known)}; put a field that varies under "
                "[random.fields]"
            )
        count, seed, design = given.get("count"), given.get("seed", 0), given.get("design", "uniform")
        for name, value, least in (("count", count, 1), ("seed", seed, 0)):
            most = MOST_VALUES if name == "count" else 2**63 - 1
            if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
                was = "is missing" if value is None else f"is {quoted(value)}"
                raise TorsadeError(f"{name} of [random] {was}; give a whole number from {least} to {most}")
        if design not in DESIGNS:
            raise TorsadeError(f"design of [random] is {quoted(design)}; give one of {', '.join(DESIGNS)}")
        fields = _table("random.fields", given.get("fields"))
        if not fields:
            raise TorsadeError("[random] has no fields; put those that vary under [random.fields]")
        for name in fields:
            check_field(self.spec, name)
        columns = draws(self.spec, fields, count, seed, design)  # type: ignore[arg-type]
        return Axis(tuple(columns), list(zip(*columns.values(), strict=True)))

    @classmethod
    def read(cls, path: str | Path) -> Sweep:
        """The sweep in a TOML file; a relative `centerline` is looked for beside the file first.

        Raises
        ------
        TorsadeError
            When the file cannot be read, or says what `Sweep` refuses.
        """
        return cls(**_read(path))

    def run(self, out: str | Path, **options: Any) -> Catalogue:
        """Run what is not stored in a folder yet; see `torsade.sweep.run`."""
        from torsade.sweep.engine import run

        return run(self, out, **options).catalogue

    @property
    def varied(self) -> tuple[str, ...]:
        """The fields that vary, in order."""
        return tuple(name for axis in self.axes for name in axis.fields)

    def __len__(self) -> int:
        """How many points there are."""
        return math.prod(len(axis.rows) for axis in self.axes)

    def points(self, at_most: int = MOST_POINTS) -> list[Point]:
        """All points, every specification checked.

        Raises
        ------
        TorsadeError
            When there are more than `at_most`, one is unfit, or two are the same.
        """
        if len(self) > at_most:
            raise TorsadeError(
                f"the sweep has {len(self)} points, more than {at_most}; give fewer values, or "
                f"at_most={len(self)} (--at-most {len(self)}) if that is meant"
            )
        found: list[Point] = []
        seen: dict[str, int] = {}
        for number, rows in enumerate(itertools.product(*(axis.rows for axis in self.axes))):
            varied = dict(zip(self.varied, itertools.chain.from_iterable(rows), strict=True))
            try:
                spec = self.spec(**self.fixed, **varied)
                key = stored.key(spec)
            except TorsadeError as error:
                told = self.told(varied)
                raise TorsadeError(f"{error} (at {told})" if told else str(error)) from None
            if key in seen:
                raise TorsadeError(
                    f"points {seen[key]} and {number} are the same, {self.told(varied)}; give every "
                    "combination once"
                )
            seen[key] = number
            found.append(Point(number, key, spec))
        return found

    def __repr__(self) -> str:
        return f"<Sweep of {self.protocol} over {', '.join(self.varied) or 'nothing'}>"

    def told(self, varied: Mapping[str, Any]) -> str:
        """The values of fields that vary, in words."""
        return ", ".join(f"{name} = {_with_unit(self.spec, name, value)}" for name, value in varied.items())


def _read(path: str | Path) -> dict[str, Any]:
    """The tables in a TOML file, centerlines being looked for beside it."""
    given, name = read_toml(path), named(path)
    spec = check_protocol(given.get("protocol"), name)
    for word in given:
        if word not in TABLES:
            near = difflib.get_close_matches(word, TABLES, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it takes {', '.join(TABLES)}"
            if word in spec.model_fields:
                hint = "a field belongs under [fixed], or where it varies under [grid]"
            raise TorsadeError(f"{name} has {word!r} at its top; {hint}")
    for table in ("fixed", "grid", "zip"):
        fields = given.get(table)
        if isinstance(fields, dict) and "centerline" in fields:
            files = fields["centerline"]
            found = [beside(path, one) for one in files] if isinstance(files, list) else beside(path, files)
            fields["centerline"] = found
    return given


def _zipped(columns: Mapping[str, list[Any]]) -> Axis:
    sizes = {name: len(column) for name, column in columns.items()}
    if len(set(sizes.values())) > 1:
        told = ", ".join(f"{name} has {size}" for name, size in sizes.items())
        raise TorsadeError(
            f"fields of [zip] go together and have unequal numbers of values: {told}; give as many"
        )
    return Axis(tuple(columns), list(zip(*columns.values(), strict=True)))


def _table(name: str, given: object) -> Mapping[str, Any]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise TorsadeError(f"{name} is {quoted(given)}; give a table, [{name}], with a line for every field")
    return given


def _check_once(names: Sequence[str]) -> None:
    twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
    if twice is not None:
        raise TorsadeError(f"{twice} is given in two places of the sweep; give it in one")


def _with_unit(spec: type[Spec], name: str, value: Any) -> str:
    dimension = dimension_of(spec.model_fields[name])
    return said(value, dimension) if dimension and isinstance(value, float) else quoted(value)
