"""The one error that users are meant to read, and what its sentences are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence


class TorsadeError(ValueError):
    """Bad input or an unreachable request, said in one sentence.

    The message says what was given, what was expected and what to do. The command line prints it
    without a traceback and exits with code 2.
    """


class QuantityError(TorsadeError):
    """A number that cannot be one; the sentence begins with what was given, and needs a name before it."""


def quoted(value: object, longest: int = 60) -> str:
    """What was given, as it is shown in a sentence: never long, numbers as people write them."""
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:g}"
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) >= 10**longest:
        return f"a whole number of {int(value.bit_length() * math.log10(2)) + 1} digits"
    text = repr(value)
    return text if len(text) <= longest else text[: longest - 4] + "..." + text[-1]


def named(path: object, longest: int = 200) -> str:
    """The path of a file as it is shown in a sentence, without the middle of one that is very long."""
    text = repr(str(path))
    half = longest // 2 - 2
    return text if len(text) <= longest else f"{text[:half]}...{text[-half:]}"


def listed(words: Sequence[str], between: str = " ", most: int = 12) -> str:
    """Words in a sentence, the first ones of many."""
    if len(words) <= most:
        return between.join(words)
    return f"{between.join(words[:most])}{between}and {len(words) - most} more"


def counted(number: int, what: str) -> str:
    """A number of things: "1 frame", "4 frames"."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def reason_of(error: Exception) -> str:
    """What the system says about a file or folder."""
    return (getattr(error, "strerror", None) or str(error)).lower()
