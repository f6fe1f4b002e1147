"""Mutations of texts and bytes, and what every refusal has to be."""

import random
import re
from pathlib import Path

from skiplatch.errors import MOST_TOLD, InputError

TOKEN = re.compile(rb"[A-Za-z0-9_.+-]+|\s+|[^A-Za-z0-9_.+\s-]")

TEXTS = (
    *("", "0", "-0", "-1", "1", "+1", "1.0", "1e5", "1e999", "-1e999", "1e-300", ".5", "5."),
    *("1e15", "1000000000000001", "9007199254740992", "1" * 30, "9" * 5000, "0x1f", "0o7"),
    *("nan", "-nan", "inf", "Infinity", "1_000", "true", "1,5", " 1 ", "١", "--1", "1e", "e1"),
    *("skip", "plc", "X", "Y", "Z", "ok", "missed", "false", "touch", "status", "path"),
    *("time_s", "feed_mm_min", "latch_us", "deviation_um", "edge_us", "probe", "delay_us"),
    *("[", "]", "[[", "]]", "{", "}", "=", ".", ",", ",,,,", '"', '""', "'", '"""', "'''"),
    *("#", "\n", "\r", "\r\n", "\n\n", "\t", "\x00", "\x1b", "\u2028", "\ufeff", "\\", "\\u0"),
    *("[" * 900, "a." * 300, "{a=" * 300, "x" * 70_000, "2020-01-01", "12:00:00", "µ", "𝟙"),
    *("a.b = 1\n", "[probe]\n", "probe.x = 1\n", "probe = {}\n", '"a\\nb" = 1\n', "[x.y]\n"),
)
WORDS = (*(text.encode() for text in TEXTS), b"\xff", b"\xc3", b"\xed\xa0\x80", b"\xff\xfe")


def expect_one_line(message: str) -> None:
    """Raise unless the message is one printable line of sensible length."""
    assert message.isprintable(), message
    assert 0 < len(message) < 2000, message


def expect_refusal(error: InputError) -> None:
    """Raise unless all that is wrong is told, each as such a line, and not too much at once."""
    for one in error.apart:
        expect_one_line(str(one))
    assert str(error).count("\n") <= MOST_TOLD


def mutated(rng: random.Random, data: bytes, seeds: dict[Path, bytes]) -> bytes:
    """Apply a few mutations, mostly one."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        data = rng.choice((mutate_bytes, mutate_tokens, mutate_lines))(rng, data)
    if rng.random() < 0.05:
        other = rng.choice(list(seeds.values()))
        data = data[: rng.randint(0, len(data))] + other[rng.randint(0, len(other)) :]
    return data


def mutate_bytes(rng: random.Random, data: bytes) -> bytes:
    """Change, drop or double some bytes, or cut the end off."""
    at = rng.randint(0, len(data))
    length = rng.choice((1, 1, 2, 4, 16))
    match rng.randrange(4):
        case 0:
            return data[:at] + rng.randbytes(length) + data[at + length :]
        case 1:
            return data[:at] + data[at + length :]
        case 2:
            return data[: at + length] + data[at:]
    return data[:at] if rng.random() < 0.2 else data[:at] + b"\x00" + data[at:]


def mutate_tokens(rng: random.Random, data: bytes) -> bytes:
    """Replace, drop, double or exchange a token, or put a word beside it."""
    tokens = TOKEN.findall(data) or [b""]
    at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
    match rng.randrange(5):
        case 0:
            tokens[at] = rng.choice(WORDS)
        case 1:
            del tokens[at]
        case 2:
            tokens[at] *= rng.choice((2, 2, 50))
        case 3:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        case _:
            tokens.insert(at, rng.choice(WORDS))
    return b"".join(tokens)


def mutate_lines(rng: random.Random, data: bytes) -> bytes:
    """Drop, double or move a line, or a column of all lines."""
    lines = data.split(b"\n")
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(4):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case _:
            lines = [mutate_column(line, other) for line in lines]
    return b"\n".join(lines)


def mutate_column(line: bytes, column: int) -> bytes:
    """Drop one cell."""
    cells = line.split(b",")
    return b",".join(cells[:column] + cells[column + 1 :])
