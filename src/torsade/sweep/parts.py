"""Rows on disk: parquet files that appear whole or not at all, and are merged as they become many.

part-FIRST-LAST-CHECK.parquet holds the rows of writes FIRST to LAST; CHECK is the CRC-32 of the file. A file
whose writes another holds too has been merged into that and is not read. Files of any other name are not
looked at.
"""

from __future__ import annotations

import json
import os
import re
import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from torsade import places
from torsade.errors import TorsadeError

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

__all__ = [
    "Part",
    "add",
    "connect",
    "damaged",
    "literal",
    "live",
    "merge_all",
    "name_of",
    "sync",
    "union",
    "write_rows",
    "write_table",
]

FAN = 8
"""So many neighbours of like size are merged into one."""

NEVER_GIVEN = "UTINYINT"
"""Type of columns, and of what is in lists, without a value in a file; nothing else is stored so."""

_NAME = re.compile(r"part-(\d{8})-(\d{8})-([0-9a-f]{8})\.parquet", re.A)


class Part(NamedTuple):
    """A file of rows: of which writes, where, and the check that its name holds."""

    first: int
    last: int
    path: Path
    check: str

    @property
    def level(self) -> int:
        """How often it has been merged, at most."""
        width, level = self.last - self.first + 1, 0
        while width >= FAN:
            width, level = width // FAN, level + 1
        return level

    def verify(self) -> None:
        """Read the file, and refuse it where it is not what was written.

        Raises
        ------
        TorsadeError
            When it is damaged or cannot be read.
        """
        try:
            content = self.path.read_bytes()
        except FileNotFoundError:
            raise  # merged into another meanwhile
        except OSError as error:
            raise damaged(self.path, error) from None
        if f"{zlib.crc32(content):08x}" != self.check:
            raise damaged(self.path, "its check sum is another")


def damaged(path: Path, reason: object) -> TorsadeError:
    """What is said of a file that cannot be read."""
    text = " ".join(str(reason).split()).rstrip(".")[:120]
    return TorsadeError(
        f"{str(path)!r} is damaged ({text}); remove it, and torsade sweep runs again what it held"
    )


def connect() -> DuckDBPyConnection:
    """A database in memory, which takes nothing from the network and one thread.

    Raises
    ------
    TorsadeError
        When DuckDB is not installed.
    """
    try:
        import duckdb
    except ImportError:
        raise TorsadeError(
            'sweeps need duckdb, which is not installed; install it with pip install "torsade[sweep]"'
        ) from None
    settings: dict[str, Any] = {"autoinstall_known_extensions": False, "autoload_known_extensions": False}
    return duckdb.connect(":memory:", config=settings | {"threads": 1, "preserve_insertion_order": True})


def literal(text: str | Path) -> str:
    """Text as SQL writes it."""
    return "'" + str(text).replace("'", "''") + "'"


def name_of(column: str) -> str:
    """The name of a column as SQL writes it."""
    return '"' + column.replace('"', '""') + '"'


def live(folder: Path) -> list[Part]:
    """The files that hold rows now, in the order in which they were written."""
    matches = [(_NAME.fullmatch(path.name), path) for path in folder.iterdir()] if folder.is_dir() else []
    parts = [Part(int(m[1]), int(m[2]), path, m[3]) for m, path in matches if m is not None]
    return [part for part in sorted(parts) if not any(_holds(other, part) for other in parts)]


def _holds(one: Part, other: Part) -> bool:
    """Whether a file holds the writes of another, and more."""
    wider = (one.last - one.first) > (other.last - other.first)
    return wider and one.first <= other.first and other.last <= one.last


def add(con: DuckDBPyConnection, folder: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows as a new file, and merge what has become many."""
    parts = live(folder)
    number = max((part.last for part in parts), default=-1) + 1
    write_rows(con, rows)
    parts.append(_stored(con, folder, number, number))
    while len(tail := _alike(parts)) >= FAN:
        parts = parts[: -len(tail)]
        parts.append(_merged(con, folder, tail))


def merge_all(con: DuckDBPyConnection, folder: Path) -> None:
    """Make one file of all."""
    parts = live(folder)
    if len(parts) > 1:
        _merged(con, folder, parts)
    for path in folder.iterdir():
        match = _NAME.fullmatch(path.name)
        if match is not None and path not in [part.path for part in live(folder)]:
            path.unlink(missing_ok=True)  # of a merge that was cut short


def _alike(parts: Sequence[Part]) -> list[Part]:
    """The last files, as far as they are of one level."""
    found: list[Part] = []
    for part in reversed(parts):
        if part.level != parts[-1].level:
            break
        found.insert(0, part)
    return found


def _merged(con: DuckDBPyConnection, folder: Path, parts: Sequence[Part]) -> Part:
    """One file with the rows of several, of which it takes the place."""
    for part in parts:
        part.verify()
    rows = union(con, parts, NEVER_GIVEN)
    # Rows that were written again later, such as failures that were retried, count once.
    con.execute(
        f"CREATE OR REPLACE TEMP TABLE written AS SELECT * EXCLUDE (part) FROM ({rows}) "
        "QUALIFY row_number() OVER (PARTITION BY key ORDER BY part DESC) = 1 ORDER BY key"
    )
    merged = _stored(con, folder, parts[0].first, parts[-1].last)
    for part in parts:
        part.path.unlink(missing_ok=True)
    return merged


def union(con: DuckDBPyConnection, parts: Sequence[Part], unknown: str = "DOUBLE") -> str:
    """A query for the rows of all files, and `part`, the number of the first write of the file.

    Columns have one type in all files, that which holds the values of each; `unknown` where there are none.

    Raises
    ------
    TorsadeError
        When a file cannot be read.
    """
    import duckdb

    shapes: list[dict[str, str]] = []
    for part in parts:
        try:
            found = con.execute(f"DESCRIBE SELECT * FROM read_parquet({literal(part.path)})").fetchall()
        except duckdb.Error as error:
            if not part.path.exists():
                raise FileNotFoundError(part.path) from None
            raise damaged(part.path, str(error).splitlines()[0]) from None
        shapes.append({row[0]: row[1] for row in found})
    names = dict.fromkeys(name for shape in shapes for name in shape)
    kinds = {name: _common(shape.get(name, NEVER_GIVEN) for shape in shapes) for name in names}
    queries = []
    for part, shape in zip(parts, shapes, strict=True):
        columns = [
            f"{'NULL' if kind == NEVER_GIVEN else name_of(name)}"
            f"::{kinds[name].replace(NEVER_GIVEN, unknown)} AS {name_of(name)}"
            for name, kind in shape.items()
        ]
        queries.append(
            f"SELECT {', '.join(columns)}, {part.first} AS part FROM read_parquet({literal(part.path)})"
        )
    return " UNION ALL BY NAME ".join(queries)


def _stored(con: DuckDBPyConnection, folder: Path, first: int, last: int) -> Part:
    """The rows in `written` as a file, which takes its name when it is whole and on disk."""
    new = places.private(folder / "part", "new")
    with places.writing(folder):
        try:
            check = write_table(con, new)
            path = folder / f"part-{first:08d}-{last:08d}-{check}.parquet"
            new.replace(path)
        finally:
            new.unlink(missing_ok=True)
        sync(folder)
    return Part(first, last, path, check)


def write_table(con: DuckDBPyConnection, path: Path) -> str:
    """Write the rows in `written` to a file, to the disk itself; returns its CRC-32."""
    import duckdb

    try:
        con.execute(f"COPY written TO {literal(path)} (FORMAT parquet, COMPRESSION zstd)")
    except duckdb.Error as error:
        raise OSError(str(error).splitlines()[0]) from None
    with path.open("rb") as file:
        os.fsync(file.fileno())
        return f"{zlib.crc32(file.read()):08x}"


def sync(folder: Path) -> None:
    """Let names in a folder be on the disk itself, where the system can do that."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_rows(con: DuckDBPyConnection, rows: Sequence[Mapping[str, Any]]) -> None:
    """Put rows into the table `written`, columns by name with the types of their values."""
    names = dict.fromkeys(name for row in rows for name in row)
    kinds = {name: _kind(row.get(name) for row in rows) for name in names}
    con.execute(
        "CREATE OR REPLACE TEMP TABLE written AS SELECT row.* FROM (SELECT unnest(from_json(?, ?)) AS row)",
        [json.dumps([dict(row) for row in rows], allow_nan=False), json.dumps([kinds])],
    )


def _kind(values: Iterable[Any]) -> str:
    """The type of a column, or of what is in a list."""
    return _common(map(_kind_of, values))


def _common(kinds: Iterable[str]) -> str:
    """The type that holds the values of all of these: text where they have nothing in common."""
    given = set(kinds) - {NEVER_GIVEN}
    if len(given) <= 1:
        return next(iter(given), NEVER_GIVEN)
    if all(kind.endswith("[]") for kind in given):
        return _common(kind.removesuffix("[]") for kind in given) + "[]"
    return "DOUBLE" if given == {"BIGINT", "DOUBLE"} else "VARCHAR"


def _kind_of(value: Any) -> str:
    if value is None:
        return NEVER_GIVEN
    if isinstance(value, list | tuple):
        return f"{_kind(value)}[]"
    kinds = {bool: "BOOLEAN", int: "BIGINT", float: "DOUBLE"}
    return next((name for kind, name in kinds.items() if isinstance(value, kind)), "VARCHAR")
