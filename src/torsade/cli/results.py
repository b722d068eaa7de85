"""What `torsade info`, `torsade export` and `torsade open` do."""

from __future__ import annotations

import json as json_format
import math
import re
import stat
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from pydantic.fields import FieldInfo

from torsade import places
from torsade.cli.commands import check_drawings, progress
from torsade.cli.table import print_file, print_grid, print_rows, print_table
from torsade.errors import TorsadeError, counted, quoted
from torsade.protocols.files import PROTOCOLS
from torsade.protocols.sentences import dimension_of
from torsade.results import Result, open_result
from torsade.units import said

__all__ = ["export", "info", "show"]


def info(given: str, json: bool, salvage: bool) -> int:
    """Say what a result is."""
    path = _found(given)
    result = open_result(path, salvage=salvage)
    about = _about(path, result)
    if json:
        print(json_format.dumps(_finite(about), allow_nan=False), flush=True)
        return 0
    print_file("result", str(path))
    print_rows(_state(about))
    print()
    if about["report"] is not None:
        print_table(result, about["report"])
        print()
    print_rows(_provenance(about))
    print()
    columns = ("variable", "dimensions", "unit", "meaning")
    print_grid(columns, [(v["name"], _sized(v), v["units"], v["long_name"]) for v in about["variables"]])
    return 0


def export(
    given: str,
    to: str,
    frames: str | None,
    out: str | None,
    json: bool,
    overwrite: bool,
    salvage: bool,
) -> int:
    """Write a result for other programs, and say what was written."""
    from torsade.export import FORMATS
    from torsade.export import export as write

    path = _found(given)
    result = open_result(path, salvage=salvage)
    if out is None:
        out = str(path.with_name(path.name.removesuffix(".part").removesuffix(".zarr") + FORMATS.get(to, "")))
    try:
        with progress(json) as shown:
            files = [str(p) for p in write(result, to, out, frames, overwrite=overwrite, progress=shown)]
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted before {out!r} was written; nothing of it is kept") from None
    if json:
        print(json_format.dumps({"result": str(path), "to": to, "files": files}), flush=True)
        return 0
    for file in files[:3]:
        print_file("written", file)
    if len(files) > 3:
        print_rows([("", f"and {counted(len(files) - 3, 'more file')}")])
    return 0


def show(
    given: str, frame: str | None, picture: str | None, plot: str | None, json: bool, salvage: bool
) -> int:
    """Show a result in a window, or draw or plot it."""
    if frame is not None and not re.fullmatch(r"-?\d{1,9}", frame.strip(), re.A):
        raise TorsadeError(f"--frame is {quoted(frame)}; give a number such as 10, or -1 for the last frame")
    check_drawings(picture, plot)
    path = _found(given)
    result = open_result(path, salvage=salvage)
    if result.frames == 0:
        raise TorsadeError(f"{str(path)!r} has no frame yet; wait for one")
    if picture is not None or plot is None:
        result.show(picture, None if frame is None else int(frame))
    if plot is not None:
        from torsade.view import plot_result

        plot_result(result.dataset, plot)
    drawn = {"picture": picture, "plot": plot}
    if json:
        print(json_format.dumps({"result": str(path), **drawn}), flush=True)
        return 0
    for what, file in drawn.items():
        if file is not None:
            print_file(what, file)
    return 0


def _found(given: str) -> Path:
    """The result, or where it is not complete yet, what is done of it."""
    path = Path(given)
    if path.name and not path.exists() and places.attributes(places.part_of(path)) is not None:
        return places.part_of(path)
    return path


def _about(path: Path, result: Result) -> dict[str, Any]:
    """All that is known of a result, under the keys of `--json`."""
    data, attrs = result.dataset, result.dataset.attrs
    sizes = list(_sizes(path))
    return {
        "path": str(path),
        "protocol": result.protocol,
        "knot": attrs.get("knot"),
        "status": _status(path, result),
        "complete": result.complete,
        "frames": result.frames,
        "samples": data.sizes.get("sample", 0),
        "reached_s": float(data["time"].values[-1]) if result.frames and "time" in data else None,
        "files": len(sizes),
        "size_bytes": sum(sizes),
        "format": attrs.get("format"),
        "spec": result.spec,
        "report": _report(result),
        "provenance": result.provenance,
        "dimensions": {str(name): int(size) for name, size in data.sizes.items()},
        "variables": [
            {
                "name": str(name),
                "dims": list(variable.dims),
                "shape": list(variable.shape),
                "dtype": str(variable.dtype),
                "units": str(variable.attrs.get("units", "")),
                "long_name": str(variable.attrs.get("long_name", "")),
            }
            for name, variable in data.variables.items()
        ],
    }


def _sizes(path: Path) -> Iterator[int]:
    """Of all files [bytes], but those that a run replaces meanwhile."""
    for file in path.rglob("*"):
        with suppress(OSError):
            about = file.stat()
            if stat.S_ISREG(about.st_mode):
                yield about.st_size


def _status(path: Path, result: Result) -> str:
    """complete, growing, interrupted, failed, or stopped: a run that could not say so any more."""
    if result.status != "running":
        return result.status
    return "stopped" if places.writer(path.with_name(path.name.removesuffix(".part"))) is None else "growing"


def _report(result: Result) -> dict[str, Any] | None:
    """The numbers that a run prints; None before its end, and of protocols that are not known here."""
    return result.report() if result.complete and result.protocol in PROTOCOLS else None


def _state(about: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """How far it came; and what was run, where no report says that."""
    t = "" if about["reached_s"] is None else f", to t = {about['reached_s']:.4g} s"
    yield "status", f"{about['status']}: {counted(about['frames'], 'frame')}{t}"
    yield "size", f"{about['size_bytes'] / 1e6:.3g} MB in {counted(about['files'], 'file')}"
    if about["report"] is None:
        yield "protocol", about["protocol"]


def _provenance(about: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """What was asked for, and where the numbers come from."""
    came = about["provenance"]
    fields = PROTOCOLS[about["protocol"]].model_fields if about["protocol"] in PROTOCOLS else {}
    asked = ((k, _short(v, fields.get(k))) for k, v in about["spec"].items() if k != "protocol")
    yield "asked for", ", ".join(f"{name} = {text}" for name, text in asked)
    if "created" in came:
        yield "begun", str(came["created"])[:19].replace("T", " ") + " UTC"
    if "wall_s" in came and about["report"] is None:
        yield "wall time", f"{came['wall_s']:.1f} s"
    if "seed" in came:
        yield "seed", str(came["seed"])
    versions = dict(came.get("versions", {}))
    yield "versions", ", ".join(f"{name} {version}" for name, version in versions.items())
    if "kernels" in came:
        yield "kernels", str(came["kernels"])
    if machine := came.get("machine"):
        cores = counted(machine.get("cores", 1), "core")
        known = [
            machine.get(name) for name in ("processor", "compiled_for", "architecture", "system", "libc")
        ]
        yield "machine", ", ".join([*(str(word) for word in known if word), cores])
    for again in came.get("resumed", []):
        changed = {k: v for k, v in again.get("versions", {}).items() if versions.get(k) != v}
        other = ", with " + ", ".join(f"{k} {v}" for k, v in changed.items()) if changed else ""
        elsewhere = "" if again.get("machine") == came.get("machine") else ", on another machine"
        when = str(again.get("at", ""))[:19].replace("T", " ")
        yield "gone on with", f"{when} UTC from {counted(again.get('done', 0), 'frame')}{other}{elsewhere}"


def _short(value: object, field: FieldInfo | None) -> str:
    dimension = None if field is None else dimension_of(field)
    if isinstance(value, float) and dimension is not None:
        return said(value, dimension)
    return value if isinstance(value, str) else quoted(value, 80)


def _sized(variable: dict[str, Any]) -> str:
    return ", ".join(f"{d} {n}" for d, n in zip(variable["dims"], variable["shape"], strict=True))


def _finite(value: Any) -> Any:
    """The same, with null for numbers that are not finite and plain numbers for numpy's."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
