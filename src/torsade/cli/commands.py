"""What `torsade demo` and `torsade run` do once their options are read."""

from __future__ import annotations

import json as json_format
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from torsade import places
from torsade.cli.messages import say
from torsade.errors import TorsadeError, quoted, reason_of
from torsade.protocols.base import Driven, Progress
from torsade.protocols.files import PROTOCOLS, merged, read_fields
from torsade.protocols.prison_escape import PrisonEscape

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["check_drawings", "demo", "now_and_then", "progress", "run"]

SAY_EVERY = 30.0
"""Time between lines about progress where there is no bar [s]."""

INSTALL_VIEW = 'pip install "torsade[view]"'


def run(
    protocol: type[Spec],
    given: dict[str, str],
    *,
    spec: str | None,
    out: str | None,
    picture: str | None,
    plot: str | None,
    movie: str | None,
    json: bool,
    resume: bool,
    overwrite: bool,
) -> int:
    """Run one specification: the fields of a file, and those given in their place."""
    wanted = _read(protocol, given, spec)
    if picture is not None and not protocol.pictured:
        raise TorsadeError(f"{wanted.protocol} has nothing to be pictured; give --plot in place of --picture")
    if movie is not None and not (protocol.pictured and issubclass(protocol, Driven)):
        raise TorsadeError(f"{wanted.protocol} has no fibers that move; give --plot in place of --movie")
    check_drawings(picture, plot, movie)
    result = _run(wanted, out, resume, overwrite, json)
    _print(result, out, json)
    _draw(result, out, picture, plot, movie, json)
    return 0


def demo(out: str, json: bool) -> int:
    """Pull a reef knot, draw it, and say what to try next."""
    spec = PrisonEscape(knot="reef", tail=8e-3)
    target, picture, plot = _demo_files(out, spec)
    result = _run(spec, target, False, True, json)
    _print(result, target, json)
    can_draw, can_plot = _can("pyvista"), _can("matplotlib")
    _draw(result, target, picture if can_draw else None, plot if can_plot else None, None, json)
    if not json:
        advice = [] if can_draw and can_plot else [f"For pictures of the knot: {INSTALL_VIEW}"]
        advice += [
            "Next, compare a knot that slips:",
            "  torsade run prison-escape --knot thief --plot thief.png",
            "or pull your own, two strands in a file (CSV, XYZ, OBJ, VECT, NPZ):",
            "  torsade run prison-escape --centerline MINE.csv --out mine.zarr",
        ]
        print("\n".join(advice))
    return 0


def _demo_files(out: str, spec: Spec) -> tuple[str, str, str]:
    """Paths of the result, the picture and the plot; refused when something else has one of the names."""
    if not out:
        raise TorsadeError("--out is empty; give the name of a folder, such as --out demo")
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TorsadeError(
            f"cannot make the folder {quoted(out, 200)} ({reason_of(error)}); give another --out"
        ) from None
    target, *drawings = (folder / name for name in ("reef.zarr", "reef.png", "reef-separation.png"))
    found = [places.attributes(path) for path in (target, places.part_of(target))]
    ours = [json_format.loads(f["spec"]) == spec.stored() for f in found if f is not None]
    if not all(ours):
        raise TorsadeError(f"{str(target)!r} is the result of another run; give another --out")
    for path in drawings:
        if path.exists() and not ours:
            raise TorsadeError(f"{str(path)!r} exists and may not be the demo's; give another --out")
    return str(target), str(drawings[0]), str(drawings[1])


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


def check_drawings(picture: str | None, plot: str | None, movie: str | None = None) -> None:
    """Refuse pictures and movies that cannot be drawn or written, before anything is computed."""
    for path, module, endings in (
        (picture, "pyvista", (".png",)),
        (plot, "matplotlib", (".png", ".pdf", ".svg")),
        (movie, "pyvista", (".mp4", ".gif")),
        (movie, "imageio_ffmpeg", (".mp4", ".gif")),
    ):
        if path is None:
            continue
        if not _can(module):
            raise TorsadeError(
                f"{quoted(path, 200)} needs {module}, which is not installed; install it with {INSTALL_VIEW}"
            )
        if Path(path).suffix.lower() not in endings:
            raise TorsadeError(
                f"cannot draw to {quoted(path, 200)}; give a name that ends in {' or '.join(endings)}"
            )
        if Path(path).is_dir():
            raise TorsadeError(f"{quoted(path, 200)} is a folder; give the name of a file in it")
        try:
            with tempfile.TemporaryFile(dir=Path(path).parent):
                pass
        except OSError as error:
            raise TorsadeError(
                f"cannot write {quoted(path, 200)} ({reason_of(error)}); give a file in a folder that exists "
                "and can be written"
            ) from None
    if picture is not None and plot is not None and Path(picture).resolve() == Path(plot).resolve():
        raise TorsadeError(
            f"--picture and --plot are both {quoted(picture, 200)}; give each a file of its own"
        )


def _can(module: str) -> bool:
    return find_spec(module) is not None


def _run(spec: Spec, out: str | None, resume: bool, overwrite: bool, quiet: bool) -> Result:
    """Run with a progress bar, and say what is saved when Ctrl-C stops it."""
    try:
        with progress(quiet) as shown:
            return spec.run(shown, out, resume=resume, overwrite=overwrite)
    except KeyboardInterrupt as error:
        if getattr(error, "part", None) is not None:
            raise KeyboardInterrupt(
                f"{error}, and the same command with --resume goes on from there"
            ) from None
        if out is None and getattr(error, "frames", None):
            raise KeyboardInterrupt(f"{error}; give --out NAME.zarr to keep what is done") from None
        raise


def _notice(share: float, note: str) -> None:
    """One line when kernels must be compiled."""
    if note.startswith(("compiling", "stopping")):
        say(note)


def now_and_then() -> Progress:
    """Says what it is told, at times: for what is long and told often."""
    said = [time.monotonic()]

    def notice(share: float, note: str) -> None:
        if note.startswith(("compiling", "stopping")):
            say(note)
        elif time.monotonic() - said[0] > SAY_EVERY:
            said[0] = time.monotonic()
            say(note)

    return notice


@contextmanager
def progress(quiet: bool, notice: Progress = _notice, *, estimate: bool = True) -> Iterator[Progress | None]:
    """A progress bar on the terminal, with an estimate of the time left; off it, what `notice` says."""
    if not sys.stderr.isatty():
        yield None if quiet else notice
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    left = (TimeRemainingColumn(),) if estimate else ()
    columns = (BarColumn(), TaskProgressColumn(), *left, TextColumn("{task.description}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=1.0)
        yield lambda share, note: bar.update(task, completed=share, description=note)


def _draw(
    result: Result, out: str | None, picture: str | None, plot: str | None, movie: str | None, quiet: bool
) -> None:
    """Draw what is asked for; what cannot be drawn does not keep the other from being drawn."""
    from torsade.cli.table import print_file

    failures = []
    drawings = (
        ("picture", picture, _picture),
        ("plot", plot, _plot),
        ("movie", movie, lambda result, path: _movie(result, path, quiet)),
    )
    for what, path, draw in drawings:
        if path is None:
            continue
        try:
            draw(result, path)
            if not quiet:
                print_file(what, path)
        except TorsadeError as error:
            failures.append(str(error).rstrip("."))
        except KeyboardInterrupt:
            kept = f"is complete in {out!r}" if out else "is not kept, since no --out NAME.zarr was given"
            raise KeyboardInterrupt(f"interrupted while drawing {path!r}; the result {kept}") from None
    if failures:
        raise TorsadeError("; ".join(failures))


def _picture(result: Result, path: str) -> None:
    from torsade.view.window import draw_result

    draw_result(result, path)


def _movie(result: Result, path: str, quiet: bool) -> None:
    from torsade.view.film import movie

    with progress(quiet) as shown:
        movie(result.dataset, path, progress=shown)


def _plot(result: Result, path: str) -> None:
    from torsade.view.history import plot_result

    plot_result(result.dataset, path)


def _print(result: Result, out: str | None, json: bool) -> None:
    """The numbers of a result, for machines or for people."""
    report = result.report()
    if json:
        print(json_format.dumps(report, allow_nan=False), flush=True)
        return
    from torsade.cli.table import print_file, print_table

    print_table(result, report)
    if out is not None:
        print_file("result", out)
