"""Asking a sweep: tables of its points and numbers in SQL, read from its folder and never written to."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from torsade.errors import TorsadeError
from torsade.protocols.files import PROTOCOLS
from torsade.sweep import parts as stored_parts
from torsade.sweep.parts import Part, literal, name_of

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection
    from numpy.typing import NDArray

__all__ = ["ABOUT", "POINTS", "Catalogue", "Rows", "read_about"]

ABOUT, POINTS = "sweep.json", "points.parquet"
"""What a sweep is of, and the points that it was last asked for."""

TRIES = 20
"""A query that meets a merge of files is asked again, so often at most."""


class Rows(NamedTuple):
    """What a query gives.

    Attributes
    ----------
    columns : names
    types : of the columns, as SQL calls them
    rows : values, None where there is none
    """

    columns: tuple[str, ...]
    types: tuple[str, ...]
    rows: list[tuple[Any, ...]]

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Columns as arrays, shape (n_rows,), by name; numbers that are not known are nan."""
        import numpy as np

        found: dict[str, NDArray[Any]] = {}
        for k, (name, kind) in enumerate(zip(self.columns, self.types, strict=True)):
            column = [row[k] for row in self.rows]
            if kind in ("DOUBLE", "FLOAT") or (None in column and "INT" in kind and "[" not in kind):
                found[name] = np.array([np.nan if x is None else x for x in column], dtype=np.float64)
            elif "[" in kind:
                found[name] = np.empty(len(column), dtype=object)
                found[name][:] = column
            else:
                found[name] = np.array(column)
        return found


def read_about(folder: Path) -> dict[str, Any] | None:
    """What a folder says of the sweep in it; None where there is none."""
    try:
        found = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
        ours = found["format"] == 1 and found["protocol"] in PROTOCOLS and isinstance(found["varied"], list)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return dict(found) if ours else None


def _complaint(error: Exception) -> str:
    """What DuckDB says of a query, in one sentence."""
    text = " ".join(str(error).split("\n\nLINE")[0].split()).rstrip(".")
    text = re.sub(r"^[\w ]+ Error: ", "", text).replace("! ", "; ").replace(". ", "; ")
    return text[:1].lower() + text[1:]


class Catalogue:
    """The sweep in a folder.

    `runs` has a row for every point that the sweep was last asked for: `point`, its number; `key`; the
    fields of the specification, in SI units; `status`, done, failed or waiting; `reason` of a failure; the
    numbers that the protocol reports; `wall_s`; `versions`. `stored` has all that is in the folder, of
    earlier designs and versions too.

    Raises
    ------
    TorsadeError
        When there is no sweep in the folder.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        about = read_about(self.folder)
        if about is None:
            what = "holds no sweep" if self.folder.exists() else "does not exist"
            raise TorsadeError(f"{str(folder)!r} {what}; give the folder of one that torsade sweep made")
        self.protocol = str(about["protocol"])
        fields = PROTOCOLS[self.protocol].model_fields
        self.varied = tuple(name for name in about["varied"] if name in fields)

    def __repr__(self) -> str:
        return f"<Catalogue of {self.protocol} in {str(self.folder)!r}>"

    def query(self, sql: str) -> Rows:
        """The answer to a query in DuckDB's SQL, which can read nothing else and write nothing.

        Raises
        ------
        TorsadeError
            When the query is wrong, or a file of the sweep is damaged.
        """
        for _ in range(TRIES):
            parts = stored_parts.live(self.folder)
            try:
                return self._answer(sql, parts)
            except (TorsadeError, FileNotFoundError):
                if all(part.path.exists() for part in parts):
                    raise
                # Otherwise the sweep, which goes on, has merged them into another.
        raise TorsadeError(f"{str(self.folder)!r} changes too fast to be read; ask again")

    def columns(self) -> dict[str, str]:
        """The columns of `runs` and their types, as SQL calls them."""
        return {row[0]: row[1] for row in self.query("DESCRIBE runs").rows}

    def counts(self) -> dict[str, int]:
        """How many points are done, failed and waiting."""
        found: Mapping[str, int] = dict(self.query("SELECT status, count(*) FROM runs GROUP BY status").rows)
        return {status: found.get(status, 0) for status in ("done", "failed", "waiting")}

    def _answer(self, sql: str, parts: Sequence[Part]) -> Rows:
        con = stored_parts.connect()
        import duckdb

        try:
            self._fill(con, parts)
            if not con.extract_statements(sql):
                raise TorsadeError('the query is empty; give one such as "SELECT * FROM runs"')
            found = con.execute(sql)
            heads = found.description or []
            return Rows(tuple(h[0] for h in heads), tuple(str(h[1]) for h in heads), found.fetchall())
        except duckdb.Error as error:
            raise TorsadeError(f"the query cannot be answered: {_complaint(error)}") from None
        finally:
            con.close()

    def _fill(self, con: DuckDBPyConnection, parts: Sequence[Part]) -> None:
        """Make the tables, and close the database to everything else."""
        import duckdb

        for part in parts:
            part.verify()
        points = self.folder / POINTS
        paths = ", ".join(literal(path) for path in (points, *(part.path for part in parts)))
        con.execute(f"SET allowed_paths = [{paths}]; SET enable_external_access = false")
        con.execute("SET lock_configuration = true")
        try:
            asked = con.execute(f"DESCRIBE SELECT * FROM read_parquet({literal(points)})").fetchall()
        except duckdb.Error as error:
            raise TorsadeError(
                f"{str(points)!r} is damaged ({str(error).splitlines()[0]}); run torsade sweep again"
            ) from None
        if not parts:
            con.execute("CREATE VIEW stored AS SELECT NULL::VARCHAR AS key, NULL::VARCHAR AS status LIMIT 0")
        else:
            union = stored_parts.union(con, parts)
            con.execute(
                f"CREATE VIEW stored AS SELECT * EXCLUDE (part) FROM ({union}) "
                "QUALIFY row_number() OVER (PARTITION BY key ORDER BY part DESC) = 1"
            )
        fields = [row[0] for row in asked]
        found = [row[0] for row in con.execute("DESCRIBE stored").fetchall()]
        numbers = ", ".join(f"s.{name_of(name)}" for name in found if name not in (*fields, "status"))
        con.execute(
            "CREATE VIEW runs AS SELECT p.*, coalesce(s.status, 'waiting') AS status"
            f"{', ' * bool(numbers)}{numbers} FROM read_parquet({literal(points)}) AS p "
            "LEFT JOIN stored AS s USING (key) ORDER BY p.point"
        )
