"""Fuzz one target for a while in a process of its own, under watch; findings are kept as files.

An input must be read or refused within 10 s of processor time and 1 GB of memory, in one sentence.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from fuzz.child import MEMORY, STATE, keep
from fuzz.mutate import LONGEST
from fuzz.targets import TARGETS, tried

SLOWEST = 10.0
"""Longest processor time of an input [s]."""

TICKS, PAGE = os.sysconf("SC_CLK_TCK"), os.sysconf("SC_PAGE_SIZE")


LIFE = 150.0
"""Longest processor time of one child [s]: what guides inputs remembers all of them, and grows."""


def main() -> None:
    """Read the options; fuzz, try what was found once more, or write the table."""
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    parser.add_argument("target", choices=[*TARGETS, "table"])
    parser.add_argument("--seconds", type=float, default=600, help="of the child's own processor time")
    parser.add_argument("--wall", type=float, default=math.inf, help="stop after so many seconds of time")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("fuzzed"), help="folder for what is found")
    parser.add_argument("--replay", action="store_true", help="try the findings again")
    parser.add_argument("--page", type=Path, default=Path("docs/hardening.md"), help="where the table goes")
    options = parser.parse_args()
    if options.target == "table":
        write_table(options.out, options.page)
    elif options.replay:
        replay(options.target, options.out / options.target)
    else:
        fuzz(options.target, options.out / options.target, options.seconds, options.wall, options.seed)


def fuzz(target: str, folder: Path, seconds: float, wall: float, seed: int) -> None:
    """Keep a child at work until the time is used; one that comes to harm is followed by another."""
    (folder / "corpus").mkdir(parents=True, exist_ok=True)
    state = folder / "state"
    state.write_bytes(bytes(STATE.size + LONGEST))
    used = most = slowest = 0.0
    until = time.monotonic() + wall
    while used < seconds and time.monotonic() < until:
        command = [
            sys.executable,
            "-m",
            "fuzz.child",
            target,
            str(folder),
            str(min(seconds - used, LIFE)),
            str(seed),
        ]
        with (folder / "log").open("wb") as log:
            child = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        spent, harm = 0.0, ""
        while child.poll() is None and not harm:
            time.sleep(0.2)
            spent, memory = _measured(child.pid, spent)
            _, began, ended, _ = STATE.unpack_from(state.read_bytes())
            if began:  # for a moment it is 0, while the child writes it anew
                slowest = max(slowest, (ended or spent) - began)
            most = max(most, memory)
            if time.monotonic() > until:
                harm = "no time"
            elif memory > MEMORY:
                harm = "memory"
            elif began and not ended and spent - began > SLOWEST:
                harm = "hang"
        if harm:
            child.send_signal(signal.SIGKILL)
        code = child.wait()
        inputs, *_, length = STATE.unpack_from(state.read_bytes())
        if harm != "no time" and (harm or code):
            harm = harm or {3: "memory"}.get(code, "death")
            data = state.read_bytes()[STATE.size : STATE.size + length]
            last = (folder / "log").read_text(errors="replace")[-2000:] if harm == "death" else ""
            reason = f"{harm} after {spent:.1f} s, {memory / 2**20:.0f} MB, exit code {code}\n{last}"
            keep(folder, data, harm, str(data), reason)
        used, seed = used + spent, seed + 1
        kept = sorted(folder.glob("*.input"))
        numbers = {"inputs": inputs, "seconds": used, "findings": len(kept), "most_mb": most / 2**20}
        numbers["slowest_s"] = slowest
        (folder / "numbers.json").write_text(json.dumps(numbers))
    print(target, json.dumps(numbers))
    for path in kept:
        print(path, path.with_suffix(".reason").read_text(errors="replace").replace("\n", " "))


def _measured(pid: int, before: float) -> tuple[float, float]:
    """Processor time [s] and memory [bytes] of a process."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, IndexError):
        return before, 0.0
    return max(before, (int(fields[11]) + int(fields[12])) / TICKS), pages * PAGE


def replay(target: str, folder: Path) -> None:
    """Try every finding again, and forget those that do no harm any more."""
    from tempfile import TemporaryDirectory

    for path in sorted(folder.glob("*.input")):
        with TemporaryDirectory() as place:
            try:
                began = time.process_time()
                tried(TARGETS[target], path.read_bytes(), Path(place))
                print(f"{path.name}: mended, {time.process_time() - began:.1f} s")
                path.unlink()
                path.with_suffix(".reason").unlink()
            except Exception as error:
                print(f"{path.name}: {type(error).__name__} {str(error)[:300]}")


def write_table(folder: Path, page: Path) -> None:
    """Put the numbers of all targets between the marks of a page."""
    heads = ("target", "inputs", "processor time [s]", "findings", "slowest [s]", "most memory [MB]")
    rows = [" | ".join(("", *heads, "")).strip(), "| --- | --- | --- | --- | --- | --- |"]
    for target in TARGETS:
        path = folder / target / "numbers.json"
        if path.exists():
            n = json.loads(path.read_text())
            cells = (f"`{target}`", n["inputs"], f"{n['seconds']:.0f}", n["findings"])
            cells += (f"{n['slowest_s']:.1f}", f"{n['most_mb']:.0f}")
            rows.append(f"| {' | '.join(map(str, cells))} |")
    begin, end = "<!-- table -->\n", "<!-- end of table -->"
    before, _, rest = page.read_text(encoding="utf-8").partition(begin)
    page.write_text(before + begin + "\n".join(rows) + "\n" + end + rest.partition(end)[2], encoding="utf-8")


if __name__ == "__main__":
    main()
