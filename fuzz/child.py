"""One target, round and round: `python -m fuzz.child TARGET FOLDER SECONDS SEED`, as `fuzz` starts it."""

from __future__ import annotations

import hashlib
import importlib
import mmap
import os
import re
import resource
import shutil
import struct
import sys
import tempfile
import time
import traceback
import warnings
from pathlib import Path
from random import Random

from fuzz import samples
from fuzz.mutate import LONGEST, mutated
from fuzz.targets import TARGETS, HarmError, Target, tried

__all__ = ["MEMORY", "STATE", "Round", "keep"]

MEMORY = 2**30
"""Most memory of the whole process [bytes]."""

STATE = struct.Struct("QddQ")
"""Inputs so far, processor time [s] when the last one began and when it ended, its length; then itself."""


def keep(folder: Path, data: bytes, kind: str, where: str, reason: str) -> None:
    """Write an input that did harm, and why; of those of one kind from one place the shortest stays."""
    name = folder / f"{kind}-{hashlib.sha256(where.encode()).hexdigest()[:10]}"
    old = name.with_suffix(".input")
    if not old.exists() or old.stat().st_size > len(data):
        old.write_bytes(data)
        name.with_suffix(".reason").write_text(reason + "\n", encoding="utf-8", errors="backslashreplace")


class Round:
    """Has inputs read, and keeps those that do harm."""

    def __init__(self, target: Target, folder: Path, seconds: float) -> None:
        self.target, self.folder, self.seconds = target, folder, seconds
        self.place = Path(tempfile.mkdtemp(prefix="fuzz"))
        with (folder / "state").open("r+b") as file:
            self.state = mmap.mmap(file.fileno(), 0)
        self.inputs = STATE.unpack_from(self.state)[0]

    def __call__(self, data: bytes) -> None:
        began = time.process_time()
        if began > self.seconds:
            os._exit(0)
        data = data[:LONGEST]
        self.state[STATE.size : STATE.size + len(data)] = data
        STATE.pack_into(self.state, 0, self.inputs, began, 0.0, len(data))
        try:
            tried(self.target, data, self.place)
        except Exception as error:
            where = _where(error.__cause__ or error)
            keep(self.folder, data, type(error).__name__, where, f"{error}\n{where}")
        finally:
            for path in self.place.iterdir():
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        self.inputs += 1
        STATE.pack_into(self.state, 0, self.inputs, began, time.process_time(), len(data))
        if 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss > MEMORY:
            os._exit(3)  # what is in the state is what took the memory


def _where(error: BaseException) -> str:
    """From where in the package it was raised: the same for inputs that find the same."""
    ours = [f for f in traceback.extract_tb(error.__traceback__) if "/torsade/" in f.filename]
    if isinstance(error, HarmError):  # from the shell: what it says tells where
        return re.sub(r"'.*?'|\W|\d", "", str(error))[:60]
    return "".join(f"{f.filename.partition('/torsade/')[2]}:{f.lineno} in {f.name}" for f in ours[-1:])


def main(name: str, folder: str, seconds: str, seed: str) -> None:
    """Go round until the time is over; with coverage as a guide where atheris is installed."""
    round_, corpus = Round(TARGETS[name], Path(folder), float(seconds)), Path(folder) / "corpus"
    valid, words = samples.samples(name), samples.words(name)
    warnings.simplefilter("error")
    for data in valid:
        (corpus / hashlib.sha256(data).hexdigest()[:16]).write_bytes(data)
        round_(data)
    try:
        import atheris
    except ImportError:
        rng = Random(int(seed))
        while True:
            round_(mutated(rng.choice(valid), words, rng))
    for module in [m for m in sys.modules if m.startswith(TARGETS[name].modules)]:
        if "kernels" not in module:
            del sys.modules[module]
    with atheris.instrument_imports(include=list(TARGETS[name].modules)):
        for module in TARGETS[name].modules:
            importlib.import_module(module)

    def change(data: bytes, most: int, seed: int) -> bytes:
        rng = Random(seed)
        return atheris.Mutate(data, most) if rng.random() < 0.2 else mutated(data, words, rng)[:most]

    options = [f"-seed={seed}", f"-max_len={LONGEST}", "-len_control=0", f"-artifact_prefix={folder}/"]
    options += ["-rss_limit_mb=0", "-timeout=1000000"]  # the parent looks after both
    atheris.Setup([name, *options, str(corpus)], round_, custom_mutator=change)
    atheris.Fuzz()


if __name__ == "__main__":
    main(*sys.argv[1:])
