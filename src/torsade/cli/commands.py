"""What `torsade demo` and `torsade run` do once their options are read."""

from __future__ import annotations

import json as json_format
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from torsade.cli.messages import say
from torsade.errors import TorsadeError
from torsade.protocols.files import PROTOCOLS, merged, read_fields
from torsade.protocols.prison_escape import PrisonEscape

if TYPE_CHECKING:
    from torsade.protocols.base import Progress, Spec
    from torsade.results import Result

__all__ = ["demo", "run"]

INSTALL_VIEW = 'pip install "torsade[view]"'


def run(
    protocol: type[Spec],
    given: dict[str, str],
    *,
    spec: str | None,
    out: str | None,
    picture: str | None,
    plot: str | None,
    json: bool,
    resume: bool,
    overwrite: bool,
) -> int:
    """Run one specification: the fields of a file, and those given in their place."""
    wanted = _read(protocol, given, spec)
    _check_drawings(picture, plot)
    if out is not None and not resume:
        _announce_restart(out)
    result = _run(wanted, out, resume, overwrite, json)
    files = [] if out is None else [out]
    failure = None
    try:
        if picture is not None:
            files.append(_draw(result, picture))
        if plot is not None:
            files.append(_plot(result, plot))
    except TorsadeError as error:
        failure = error
    _print(result, files, json)
    if failure is not None:
        raise failure
    return 0


def demo(out: str, json: bool) -> int:
    """Pull a reef knot, draw it, and say what to try next."""
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise TorsadeError(f"cannot make the folder {out!r} ({reason}); give another --out") from None
    target = folder / "reef.zarr"
    result = _run(PrisonEscape(knot="reef"), str(target), False, True, json)
    files = [str(target)]
    advice = []
    if _can("pyvista"):
        files.append(_draw(result, str(folder / "reef.png")))
    if _can("matplotlib"):
        files.append(_plot(result, str(folder / "reef-separation.png")))
    if len(files) < 3:
        advice.append(f"For pictures of the knot: {INSTALL_VIEW}")
    _print(result, files, json)
    if not json:
        from rich.console import Console

        advice += [
            "Next, compare a knot that slips:",
            "  torsade run prison-escape --knot thief --plot thief.png",
            "or pull your own, two strands in a CSV file:",
            "  torsade run prison-escape --centerline MINE.csv --out mine.zarr",
        ]
        Console(highlight=False, soft_wrap=True).print("\n".join(advice), markup=False)
    return 0


def _read(protocol: type[Spec], given: dict[str, str], path: str | None) -> Spec:
    if path is None:
        return protocol(**given)
    fields = read_fields(path)
    if PROTOCOLS[fields["protocol"]] is not protocol:
        name = fields["protocol"]
        raise TorsadeError(
            f"{path!r} is a specification of {name}; run it with torsade run {name} --spec {path}"
        )
    return protocol(**merged(fields, given))


def _check_drawings(picture: str | None, plot: str | None) -> None:
    """Refuse pictures that cannot be drawn or written, before anything is computed."""
    for path, module, endings in (
        (picture, "pyvista", (".png",)),
        (plot, "matplotlib", (".png", ".pdf", ".svg")),
    ):
        if path is None:
            continue
        if not _can(module):
            raise TorsadeError(
                f"{path!r} needs {module}, which is not installed; install it with {INSTALL_VIEW}"
            )
        if Path(path).suffix.lower() not in endings:
            raise TorsadeError(f"cannot draw to {path!r}; give a name that ends in {' or '.join(endings)}")
        if Path(path).is_dir():
            raise TorsadeError(f"{path!r} is a folder; give the name of a file in it")
        try:
            with tempfile.TemporaryFile(dir=Path(path).parent):
                pass
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise TorsadeError(
                f"cannot write {path!r} ({reason}); give a file in a folder that exists and can be written"
            ) from None


def _can(module: str) -> bool:
    return find_spec(module) is not None


def _announce_restart(out: str) -> None:
    from torsade import store

    part = store.part_of(Path(out))
    found = store.attributes(part)
    if found is not None and not Path(out).exists():
        frames = found.get("done", 0)
        say(f"beginning anew in place of {str(part)!r}, an interrupted run with {frames} frames")


def _run(spec: Spec, out: str | None, resume: bool, overwrite: bool, quiet: bool) -> Result:
    """Run with a progress bar, and say what is saved when Ctrl-C stops it."""
    try:
        with _progress(quiet) as progress:
            return spec.run(progress, out, resume=resume, overwrite=overwrite)
    except KeyboardInterrupt as error:
        if getattr(error, "part", None) is not None:
            raise KeyboardInterrupt(
                f"{error}, and the same command with --resume goes on from there"
            ) from None
        if out is None and str(error):
            raise KeyboardInterrupt(f"{error}; give --out NAME.zarr to keep what is done") from None
        raise


@contextmanager
def _progress(quiet: bool) -> Iterator[Progress | None]:
    """A progress bar on the terminal; off it, one line when kernels must be compiled."""
    if not sys.stderr.isatty():
        yield None if quiet else _notice
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), TaskProgressColumn(), TimeRemainingColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=1.0)
        yield lambda share, note: bar.update(task, completed=share, description=note)


def _notice(share: float, note: str) -> None:
    if note.startswith("compiling"):
        say(note)


def _draw(result: Result, path: str) -> str:
    from torsade.view.scene import render_result

    render_result(result.dataset, path, frame=result.last_held)
    return path


def _plot(result: Result, path: str) -> str:
    from torsade.view.plots import plot_separation, plot_tightening

    plot = plot_separation if result.protocol == "prison-escape" else plot_tightening
    plot(result.dataset, path)
    return path


def _print(result: Result, files: list[str], json: bool) -> None:
    """The numbers of a result, for machines or for people."""
    report = PROTOCOLS[result.protocol].report(result)
    if json:
        print(json_format.dumps(report, allow_nan=False))
        return
    from torsade.cli.table import print_table

    print_table(result, report, files)
