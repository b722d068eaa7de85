"""The commands about many runs, `torsade sweep` and `torsade query`: their options."""

from __future__ import annotations

from typing import Annotated

from cyclopts import App, Parameter

__all__ = ["add_commands"]

SWEEP_EXAMPLES = """Examples:

torsade sweep pieces.toml --dry-run

torsade sweep pieces.toml --out pieces --workers 2

torsade sweep pieces.toml --scheduler tcp://127.0.0.1:8786

torsade sweep pieces.toml --scheduler slurm --workers 64"""

QUERY_EXAMPLES = """Examples:

torsade query pieces

torsade query pieces "SELECT twist, avg(fragments) FROM runs GROUP BY twist ORDER BY twist"

torsade query pieces "SELECT reason, count(*) FROM runs GROUP BY reason" --json"""

_JSON = "Print JSON, and nothing else, on the standard output."


def add_commands(app: App) -> None:
    """Add both."""
    app.command(_sweep, name="sweep", help_epilogue=SWEEP_EXAMPLES, version_flags=[])
    app.command(_query, name="query", help_epilogue=QUERY_EXAMPLES, version_flags=[])


def _sweep(
    file: Annotated[
        str,
        Parameter(
            name="FILE",
            help="TOML file: protocol, and the fields of its specification under [fixed], [grid], [zip], "
            "[[points]] or [random], with units as in a specification.",
        ),
    ],
    /,
    *,
    out: Annotated[
        str | None, Parameter(help="Folder of the sweep [default: the name of FILE without .toml].")
    ] = None,
    workers: Annotated[
        str | None,
        Parameter(help="Processes at a time, or workers to ask a queue for [default: the number of cores]."),
    ] = None,
    scheduler: Annotated[
        str | None,
        Parameter(
            help="Run on the workers of a dask scheduler, such as tcp://127.0.0.1:8786, or as jobs of slurm "
            "or pbs."
        ),
    ] = None,
    retry_failed: Annotated[bool, Parameter(help="Run again the points that failed.")] = False,
    keep: Annotated[
        bool, Parameter(help="Store whole results too, as results/KEY.zarr; by default numbers only.")
    ] = False,
    at_most: Annotated[
        str | None, Parameter(help="Refuse a sweep of more points than this [default: 100000].")
    ] = None,
    dry_run: Annotated[
        bool, Parameter(help="Say how many points there are, show the first; run none.")
    ] = False,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
) -> int:
    """Run a protocol at many points: every combination of the fields that vary, each once.

    What is stored is not run again: a sweep that was stopped goes on, and points that are added are run.

    A point that fails is stored with its reason, and the others go on.
    """
    from torsade.cli.sweep import sweep

    return sweep(
        file,
        out,
        workers=workers,
        scheduler=scheduler,
        retry_failed=retry_failed,
        keep=keep,
        at_most=at_most,
        dry_run=dry_run,
        json=json,
    )


def _query(
    folder: Annotated[str, Parameter(name="DIR", help="Folder of a sweep.")],
    sql: Annotated[
        str | None,
        Parameter(name="SQL", help="A query in DuckDB's SQL; without it, what there is to ask for."),
    ] = None,
    /,
    *,
    csv: Annotated[bool, Parameter(help="Print CSV, every row.")] = False,
    json: Annotated[bool, Parameter(help=_JSON)] = False,
) -> int:
    """Ask a sweep in SQL: its table runs has a row for every point, with fields, status and numbers.

    Values are in SI units. A sweep can be asked while it goes on.
    """
    from torsade.cli.sweep import query

    return query(folder, sql, csv, json)
