"""How valid inputs are spoilt: by what a number, a word, a line or a bracket can be, not only by bytes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from random import Random

__all__ = ["LONGEST", "WAYS", "mutated"]

NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")

NUMBERS = (
    *b"0 -0 1 -1 2 3 4 7 12 99 100 255 500 501 65536 1000000 -1000000 2147483648 9223372036854775808".split(),
    *b"nan inf -inf NaN Infinity 1e308 -1e308 1e309 1e-308 5e-324 1e-400 1e99999999999 1e155 1e-170".split(),
    *b"0.1 .5 5. 1e5 1E-3 0x10 1_000 +-1 --1 1e 1.2.3 1,5 1/0 1e77 1e-80 1e103 1e-110 True null".split(),
    *"９ ٣ ² ½ −1 ∞ 1٫5 ൧".encode().split(),
    b"9" * 19,
    b"9" * 400,
    b"9" * 5000,
    b"0." + b"0" * 500 + b"1",
    b"",
)
"""What may stand where a number does."""

SIGNS = (
    *(
        c.encode()
        for c in "\0\r\n\t \x0b\x0c\x7f\ufeff\x85\u2028\u200b\u202e\u00a0é𝟙İ\"'\\#,;:.|*+-/_=()[]{}^~$`"
    ),
    *(b"\r\n", b"\n\n", b"\x1b[31m", b"\xff", b'""', b"..", b"((", b"))", b". ", b"{}", b"%s", b"--"),
)
"""What may stand anywhere."""

BRACKETS = (
    *((b"(", b")"), (b"[", b"]"), (b"{", b"}"), (b'"', b'"'), (b"(", b")^9")),
    *((b"-", b""), (b"mirror ", b""), (b"open ", b"")),
)
"""What may stand around a piece, many times."""

TIMES = (2, 3, 10, 50, 51, 60, 300, 501, 1100, 5000, 100_000)

LONGEST = 2**20
"""Longest input that is made [bytes]."""


def mutated(data: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """The input changed in one place or a few; its first line, which says what reads it, stays."""
    head, end, body = data.partition(b"\n")
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        body = rng.choice(WAYS)(body, words, rng)[:LONGEST]
    return head + end + body


def _number(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """Another number in place of one, or of all that are equal to it."""
    found = list(NUMBER.finditer(body[:100_000]))
    if not found:
        return rng.choice(NUMBERS) + body
    one, new = rng.choice(found), rng.choice(NUMBERS)
    if rng.random() < 0.2:
        return body.replace(one[0], new, LONGEST // max(1, len(new)))
    return body[: one.start()] + new + body[one.end() :]


def _word(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """A known word in place of another, or put in."""
    new = rng.choice([*words, b""])
    found = list(re.finditer(rb"[^\W\d]+", body[:100_000]))
    if found and rng.random() < 0.7:
        one = rng.choice(found)
        return body[: one.start()] + new + body[one.end() :]
    at = rng.randint(0, len(body))
    return body[:at] + new + body[at:]


def _sign(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """A separator, bracket or strange sign put in, or in place of others."""
    at = rng.randint(0, len(body))
    return body[:at] + rng.choice(SIGNS) + body[at + rng.choice((0, 0, 0, 1, 2)) :]


def _lines(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """A line left out, doubled, moved or emptied; or other ends of all lines."""
    if rng.random() < 0.1:
        return body.replace(b"\n", rng.choice((b"\r\n", b"\r", b"\n\n", b" \n", b"\x85")))
    rows = body.split(b"\n")
    i, j = rng.randrange(len(rows)), rng.randrange(len(rows))
    way = rng.randrange(4)
    if way == 0:
        del rows[i]
    elif way == 1:
        rows.insert(j, rows[i])
    elif way == 2:
        rows[i], rows[j] = rows[j], rows[i]
    else:
        rows[i] = b""
    return b"\n".join(rows)


def _tokens(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """A token left out, doubled or exchanged for another."""
    parts = re.split(rb"([\s,;|=]+)", body[:100_000])
    i, j = rng.randrange(len(parts)), rng.randrange(len(parts))
    parts[i] = rng.choice((b"", parts[j], parts[i] + parts[j]))
    return b"".join(parts) + body[100_000:]


def _again(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """A piece repeated, often."""
    i = rng.randint(0, len(body))
    piece = body[i : i + rng.choice((1, 1, 2, 3, 5, 10, 30, 1000))]
    return body[:i] + piece * min(rng.choice(TIMES), LONGEST // max(1, len(piece))) + body[i + len(piece) :]


def _nested(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """A piece within many brackets."""
    i = rng.randint(0, len(body))
    j = rng.randint(i, min(len(body), i + 20))
    (left, right), n = rng.choice(BRACKETS), rng.choice(TIMES)
    return body[:i] + left * n + body[i:j] + right * n + body[j:]


def _bytes(body: bytes, words: Sequence[bytes], rng: Random) -> bytes:
    """Some bytes changed, or the end cut off."""
    if rng.random() < 0.3:
        return body[: rng.randint(0, len(body))]
    changed = bytearray(body)
    for _ in range(rng.randint(1, 4) if body else 0):
        changed[rng.randrange(len(body))] = rng.choice((0, 1, 127, 128, 255, rng.randrange(256)))
    return bytes(changed)


WAYS = (*(_number,) * 3, *(_word, _sign, _tokens) * 2, _lines, _again, _nested, _bytes)
