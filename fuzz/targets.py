"""What is fuzzed, and what may come of an input: an answer, or a TorsadeError of one sentence."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple
from unittest import mock

from torsade.errors import TorsadeError

__all__ = ["TARGETS", "HarmError", "Target", "one_sentence", "tried"]

Reader = Callable[[bytes, Path], Any]
"""Takes the body of an input and an empty folder to work in."""


LONGEST_SENTENCE = 700
"""Most signs of a sentence: some name all choices that there are."""


class HarmError(Exception):
    """Something that must not come of any input."""


class Target(NamedTuple):
    """What reads, and the modules whose branches guide the way."""

    reads: Callable[[str], Reader]
    modules: tuple[str, ...]


def tried(target: Target, data: bytes, folder: Path) -> None:
    """Have an input read by what its first line names; whatever is wrong is raised."""
    kind, _, body = data.partition(b"\n")
    try:
        reader = target.reads(kind.decode("ascii", "replace"))
    except KeyError:
        return
    try:
        reader(body, folder)
    except TorsadeError as error:
        try:
            one_sentence(str(error))
        except HarmError as found:
            raise found from error


def one_sentence(message: str) -> None:
    """Refuse to call something a sentence that is none.

    Raises
    ------
    HarmError
        Of several lines or sentences outside what it quotes, with signs that cannot be shown, or endless.
    """
    plain = re.sub(r"'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\"", "''", message)
    several = re.search(r"(?<!\.)\. ", plain.strip())
    if several or not message.strip() or not message.isprintable() or len(message) > LONGEST_SENTENCE:
        raise HarmError(f"not one sentence that can be shown: {message[:1000]!r}")


# --- files


def _of_files(read: Callable[[Path], Any]) -> Callable[[str], Reader]:
    """Inputs are the content of a file; the first line is how its name ends."""

    def reads(suffix: str) -> Reader:
        if not re.fullmatch(r"\w{1,12}", suffix):
            raise KeyError(suffix)

        def one(body: bytes, folder: Path) -> None:
            path = folder / f"a.{suffix}"
            path.write_bytes(body)
            read(path)

        return one

    return reads


def _curves(path: Path) -> None:
    from torsade.centerline import check
    from torsade.files import read_centerline, write_centerline

    found = read_centerline(path)
    write_centerline(found, path.with_name("b.npz"))
    again = read_centerline(path.with_name("b.npz"))
    degenerate = any((x[0] == x[-1]).all() for x in found.strands)
    if not degenerate and [x.tobytes() for x in again.strands] != [x.tobytes() for x in found.strands]:
        raise HarmError("strands are not read back as they were written")
    check(found, 2e-4)


def _arrays(kind: str) -> Reader:
    """NPY and NPZ, as bytes; or as JSON: [name, header, length of data, whether packed] of each member."""
    if kind != "members":
        return _of_files(_curves)(kind)

    def one(body: bytes, folder: Path) -> None:
        try:
            members = [(str(n), str(h), min(int(k), 2**27), bool(p)) for n, h, k, p in json.loads(body)]
        except (ValueError, TypeError, OverflowError, RecursionError):
            return
        with zipfile.ZipFile(folder / "a.npz", "w") as archive, contextlib.suppress(ValueError, UserWarning):
            for name, header, length, packed in members[:20]:
                info = zipfile.ZipInfo(name[:1000])
                info.compress_type = zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED
                head = header.encode("utf-8", "replace") + b"\n"
                with archive.open(info, "w", force_zip64=True) as stream:
                    stream.write(b"\x93NUMPY\x01\x00" + (len(head) % 65536).to_bytes(2, "little") + head)
                    for start in range(0, length, 2**20):
                        stream.write(bytes(min(2**20, length - start)))
        _curves(folder / "a.npz")

    return one


def _tables(kind: str) -> Reader:
    arguments = {
        "trials": ["trials", "a.csv"],
        "buckling": ["material", "--radius", "0.7 mm", "--buckling", "a.csv"],
        "weights": ["material", "--radius", "0.7 mm", "--weights", "a.csv"],
        "pendulum": ["material", "--radius", "0.7 mm", "--pendulum", "a.csv", "--inertia", "2 kg mm^2"],
    }[kind]

    def one(body: bytes, folder: Path) -> None:
        (folder / "a.csv").write_bytes(body)
        _shell(arguments, folder)
        _shell([*arguments, "--json"], folder)

    return one


def _results(name: str) -> Reader:
    """Inputs are the content of one file, which the first line names, in the folder of a sound result."""
    from fuzz.samples import result_folder

    whole = result_folder()
    if name not in {str(p.relative_to(whole)) for p in whole.rglob("*") if p.is_file()}:
        raise KeyError(name)

    def one(body: bytes, folder: Path) -> None:
        from torsade.results import Result

        sound = (whole / name).read_bytes()
        (whole / name).write_bytes(body)
        try:
            found = Result.open(whole, salvage=len(body) % 2 == 0)
            str((found, found.spec, found.complete, found.frames, found.c_f, found.last_held))
            found.report()
        finally:
            (whole / name).write_bytes(sound)

    return one


# --- texts


def _codes(kind: str) -> Reader:
    from torsade.cli.codes import codes_of
    from torsade.topology.codes import from_text, leaves_mirror_open

    if kind != "code":
        raise KeyError(kind)

    def one(body: bytes, folder: Path) -> None:
        text = body.decode("utf-8", "surrogateescape")
        leaves_mirror_open(text)
        diagram = from_text(text)
        if diagram.n_crossings > 30:
            return
        for name, code in codes_of(diagram).items():
            again = None if code is None else from_text(code).n_crossings
            if name != "conway" and again not in (None, diagram.n_crossings) and not diagram.circles:
                raise HarmError(f"the {name} code {code!r} is of another number of crossings")

    return one


def _names(kind: str) -> Reader:
    from torsade.knots.finding import interpret, known_bend, known_strand, search
    from torsade.units import DIMENSIONS, quantity

    if kind in DIMENSIONS:
        return lambda body, folder: quantity(body.decode("utf-8", "surrogateescape"), kind)
    find = {"name": interpret, "bend": known_bend, "strand": known_strand, "search": search}[kind]

    def one(body: bytes, folder: Path) -> None:
        found = find(body.decode("utf-8", "surrogateescape"))
        for entry in found if isinstance(found, tuple) else (found,):
            str((entry.diagram, entry.title))

    return one


def checked_spec(spec: Any) -> None:
    """A valid specification means the same when it is stored and read, and knows what a result says of it."""
    stored = spec.stored()
    if type(spec)(**json.loads(json.dumps(stored, allow_nan=False))) != spec:
        raise HarmError(f"{stored} is another specification when it is read again")
    json.dumps(json.loads(spec.attributes()["model"]))
    if hasattr(spec, "lasting") and not 0 < spec.lasting < float("inf"):
        raise HarmError(f"{stored} lasts {spec.lasting} s")


def _specs(kind: str) -> Reader:
    from torsade.protocols import PROTOCOLS, load_spec

    def toml(body: bytes, folder: Path) -> None:
        (folder / "a.toml").write_bytes(body)
        checked_spec(load_spec(folder / "a.toml"))

    def of_fields(body: bytes, folder: Path) -> None:
        try:
            fields = json.loads(body)
        except (ValueError, RecursionError):
            return
        if isinstance(fields, dict):
            checked_spec(PROTOCOLS[kind](**fields))

    return toml if kind == "toml" else dict.fromkeys(PROTOCOLS, of_fields)[kind]


# --- the shell


def _command(kind: str) -> Reader:
    """Inputs are arguments, one in each line."""
    if kind != "torsade":
        raise KeyError(kind)

    from fuzz.samples import files

    def one(body: bytes, folder: Path) -> None:
        for name, content in files().items():
            (folder / name).write_bytes(content)
        arguments = [os.fsdecode(word) for word in body.split(b"\n") if b"\0" not in word]
        if not any(".." in word or word.startswith(("/", "~")) for word in arguments):
            _shell(arguments, folder)

    return one


SLOW = (
    "torsade.protocols.driving.drive",
    "torsade.protocols.still.Still.run",
    "torsade.knots.build.build",
    "torsade.cli.tight.tighten",
    "torsade.cli.tight.loose_knot",
    "torsade.cli.tight.loose_diagram",
    "torsade.figures.runs.results",
    "torsade.view.film.movie",
)
"""What computes for long, and is not what is fuzzed."""


@contextlib.contextmanager
def _nothing_slow() -> Iterator[None]:
    with contextlib.ExitStack() as stack:
        for name in SLOW:
            stack.enter_context(mock.patch(name, side_effect=TorsadeError("this would take long; stop here")))
        yield


def _shell(arguments: list[str], folder: Path) -> None:
    """Run a command line in a folder; it ends with code 0, or with 2 and one sentence."""
    from torsade.cli import main

    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", errors) for errors in ("strict", "backslashreplace"))
    code: Any = None
    shown = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
    with contextlib.chdir(folder), shown[0], shown[1], _nothing_slow():
        try:
            main(arguments)
        except SystemExit as done:
            code = done.code
        out.flush()
        err.flush()
    printed, said = (f.buffer.getvalue().decode() for f in (out, err))  # type: ignore[attr-defined]
    if code not in (0, 2) or "Traceback" in said:
        raise HarmError(f"exit code {code}: {said[:1000]}")
    if code == 2:
        if printed or not said.startswith("torsade: ") or said.count("\n") != 1:
            raise HarmError(f"exit code 2, and not one line: {printed[:300]!r}, {said[:700]!r}")
        # The name of a file is shown in full.
        for path in (word for word in arguments if len(word) > 100 and re.search(r"[./]", word)):
            said = said.replace(repr(path), "''").replace(path, "")
        one_sentence(said.strip())


TARGETS = MappingProxyType(
    {
        "curves": Target(_of_files(_curves), ("torsade.files", "torsade.centerline")),
        "arrays": Target(_arrays, ("torsade.files",)),
        "tables": Target(_tables, ("torsade.files", "torsade.fracture.trials", "torsade.cli")),
        "codes": Target(_codes, ("torsade.topology.codes", "torsade.topology.tangle", "torsade.cli.codes")),
        "names": Target(_names, ("torsade.knots.finding", "torsade.units", "torsade.topology.named")),
        "specs": Target(_specs, ("torsade.protocols", "torsade.units", "torsade.knots.finding")),
        "results": Target(_results, ("torsade.results", "torsade.store", "torsade.places")),
        "shell": Target(_command, ("torsade.cli", "torsade.protocols", "torsade.knots.finding")),
    }
)
