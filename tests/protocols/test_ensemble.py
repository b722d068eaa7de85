"""Many runs in threads: the same bits as one after another, failures said, Ctrl-C heard."""

from __future__ import annotations

import _thread
import threading

import pytest

import torsade as ts
from short_runs import SHORT, assert_same
from torsade.errors import TorsadeError
from torsade.protocols import PrisonEscape, SnapQuench, SnapTwist, Spec, ensemble
from torsade.protocols.ensemble import THREAD


def bends() -> list[Spec]:
    return [PrisonEscape(knot="reef", force=f"{force} N", duration="4 ms", frames=4) for force in (5, 15, 40)]


@pytest.mark.parametrize("protocol", sorted(SHORT))
def test_every_protocol_gives_the_same_bits_in_threads(protocol: str) -> None:
    spec = SHORT[protocol]
    for result in ensemble([spec] * 4, threads=3):
        assert_same(result, spec.run())


def test_cascades_in_threads_are_those_alone() -> None:
    """Each is bent to another shape before it breaks, while others are: what they share does not change."""
    specs: list[Spec] = [
        kind(disorder=0.05, seed=seed, frames=1, **given)
        for seed in range(6)
        for kind, given in ((SnapTwist, {"twist": f"{40 * seed} deg"}), (SnapQuench, {"approach": "1 ms"}))
    ]
    for spec, result in zip(specs, ensemble(specs, threads=3), strict=True):
        assert_same(result, spec.run())


def test_results_come_in_the_order_of_their_specifications() -> None:
    for spec, result in zip(bends(), ensemble(bends(), threads=2), strict=True):
        assert_same(result, spec.run())


def test_threads_are_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two runs wait for each other: they go on at the same time, or never."""
    both, run = threading.Barrier(2, timeout=60), SnapTwist.run

    def met(self: SnapTwist, *args: object) -> ts.Result:
        if self.seed:
            both.wait()
        return run(self, *args)

    monkeypatch.setattr(SnapTwist, "run", met)
    specs = [SnapTwist(frames=1, seed=seed) for seed in range(3)]
    assert len(ensemble(specs, threads=2)) == 3


def test_a_run_that_fails_is_named() -> None:
    specs = [SnapTwist(frames=1), SnapTwist(twist="350 deg", frames=1), SnapTwist(twist="400 deg", frames=1)]
    with pytest.raises(TorsadeError, match=r"run 2 of 3, counted from 0, failed: a twist of 400 deg breaks"):
        ensemble(specs, threads=2)


def test_progress_goes_from_nothing_to_all() -> None:
    told: list[tuple[float, str]] = []
    ensemble(bends(), threads=2, progress=lambda share, note: told.append((share, note)))
    assert told[-1][1] == "3 of 3 runs"
    assert [share for share, _ in told] == sorted(share for share, _ in told)


def test_ctrl_c_ends_all_runs() -> None:
    specs = [PrisonEscape(knot="reef", duration="1 ms" if k == 0 else "100 s") for k in range(3)]
    with pytest.raises(KeyboardInterrupt):
        ensemble(specs, threads=2, progress=lambda share, note: _thread.interrupt_main())
    assert not [thread for thread in threading.enumerate() if thread.name.startswith(THREAD)]


def test_nonsense_is_refused() -> None:
    assert ensemble([]) == []
    with pytest.raises(TorsadeError, match="threads is 0; give a number of at least 1"):
        ensemble(bends(), threads=0)
