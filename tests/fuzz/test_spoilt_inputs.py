"""Spoilt inputs of everything that reads: an answer, or one sentence; `python -m fuzz` does so for long."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsade.errors import TorsadeError

sys.path.insert(0, str(Path(__file__).parents[2]))

from fuzz.mutate import LONGEST, WAYS, mutated
from fuzz.samples import samples, words
from fuzz.targets import TARGETS, HarmError, Target, one_sentence, tried

QUICK = ("arrays", "codes", "curves", "names", "specs", "tables")


@pytest.mark.parametrize("target", [*QUICK, "shell"])
def test_valid_inputs_are_answered(tmp_path: Path, target: str) -> None:
    for k, data in enumerate(samples(target)):
        folder = tmp_path / str(k)
        folder.mkdir()
        tried(TARGETS[target], data, folder)


@pytest.mark.parametrize("target", QUICK)
@settings(deadline=None, derandomize=True, max_examples=60)
@given(data=st.data())
def test_spoilt_inputs_are_answered_or_refused(
    tmp_path_factory: pytest.TempPathFactory, target: str, data: st.DataObject
) -> None:
    sound = data.draw(st.sampled_from(samples(target)))
    spoilt = mutated(sound, words(target), Random(data.draw(st.integers(0, 2**32))))
    tried(TARGETS[target], spoilt[: 2**14], tmp_path_factory.mktemp(target))


def test_mutations_repeat_and_keep_what_reads_the_input() -> None:
    sound = samples("curves")[0]
    spoilt = [mutated(sound, words("curves"), Random(k)) for k in range(200)]
    assert spoilt == [mutated(sound, words("curves"), Random(k)) for k in range(200)]
    assert len(set(spoilt)) > 150
    assert all(data.startswith(b"csv\n") and len(data) <= LONGEST + 4 for data in spoilt)


class Longest(Random):
    """Chooses whatever makes an input long."""

    def random(self) -> float:
        return 0.0

    def choice(self, seq: Sequence[Any]) -> Any:
        return max(
            seq, key=lambda one: one if isinstance(one, int) else len(one) if isinstance(one, bytes) else 0
        )


@pytest.mark.parametrize("way", WAYS)
def test_spoiling_takes_little_memory(way: Any) -> None:
    """Or it is the fuzzer that fills it: the same number 300 000 times, each of them to be 5000 digits."""
    body = b"1;x\n" * 260_000
    tracemalloc.start()
    try:
        way(body, [b"word"], Longest(1))
        assert tracemalloc.get_traced_memory()[1] < 100e6
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "message", ["", "two\nlines", "one. two", "a\x1b[31m red", "x" * 1000, "it is\u202eturned around"]
)
def test_what_is_no_sentence_is_found(message: str) -> None:
    with pytest.raises(HarmError):
        one_sentence(message)


def test_other_exceptions_come_through(tmp_path: Path) -> None:
    def spoilt(body: bytes, folder: Path) -> None:
        raise TorsadeError("two. sentences") if body else ZeroDivisionError

    target = Target(lambda kind: spoilt, ())
    with pytest.raises(ZeroDivisionError):
        tried(target, b"a\n", tmp_path)
    with pytest.raises(HarmError):
        tried(target, b"a\nb", tmp_path)
