"""Fuzz the reading of campaigns: mutated files are read or refused in one line, nothing else.

    python tests/fuzz/fuzz_campaign.py SECONDS [--seed N]

Starts from the files in corpus/campaign (``*.toml`` for nominal.toml, ``*.csv`` for touches.csv),
mutates their bytes and tokens, and reads the result. What is accepted must be written and read
back as the same. An input that breaks this is kept in the corpus and the exit status is 1.
"""

import argparse
import hashlib
import random
import re
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

from skiplatch.campaign import (
    CONDITIONS,
    format_nominal,
    format_touches,
    read_conditions,
    read_nominal,
    read_touches,
)
from skiplatch.errors import CampaignWarning, InputError

CORPUS = Path(__file__).parent / "corpus" / "campaign"
MOST_SECONDS = 5.0  # that one small file may take
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


def main() -> int:
    """Run for the time asked and report."""
    arguments = parse_arguments()
    seed = random.SystemRandom().getrandbits(32) if arguments.seed is None else arguments.seed
    rng = random.Random(seed)
    seeds = {path: path.read_bytes() for path in sorted(CORPUS.glob("*.*"))}
    verdicts: Counter[str] = Counter()
    failures = sum(check_and_keep(path.suffix, data, verdicts) for path, data in seeds.items())
    end = time.monotonic() + arguments.seconds
    while time.monotonic() < end:
        path, data = rng.choice(list(seeds.items()))
        failures += check_and_keep(path.suffix, mutated(rng, data, seeds), verdicts)
    print(
        f"fuzz_campaign: seed {seed}, {verdicts.total()} executions "
        f"({verdicts['read']} read, {verdicts['refused']} refused), {failures} failures"
    )
    return 1 if failures else 0


def parse_arguments() -> argparse.Namespace:
    """Give `seconds` and `seed`."""
    parser = argparse.ArgumentParser(description="fuzz the reading of campaigns")
    parser.add_argument("seconds", type=float)
    parser.add_argument("--seed", type=int)
    return parser.parse_args()


def check_and_keep(suffix: str, data: bytes, verdicts: Counter[str]) -> bool:
    """Tell whether the input broke the property; if so print how and keep it."""
    started = time.monotonic()
    try:
        verdict = check(suffix, data)
        assert time.monotonic() - started < MOST_SECONDS, "took too long"
    except Exception:  # noqa: BLE001
        traceback.print_exc()
        kept = CORPUS / f"crash_{hashlib.sha256(data).hexdigest()[:12]}{suffix}"
        kept.write_bytes(data)
        print(f"fuzz_campaign: kept {kept}", file=sys.stderr)
        verdicts["failed"] += 1
        return True
    verdicts[verdict] += 1
    return False


def check(suffix: str, data: bytes) -> str:
    """Read the data and tell whether they were "read" or "refused"; raise if neither is so."""
    with tempfile.TemporaryDirectory(prefix="skiplatch-fuzz-") as folder:
        path = Path(folder) / f"input{suffix}"
        path.write_bytes(data)
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                check_nominal(path) if suffix == ".toml" else check_touches(path)
        except InputError as error:
            expect_one_line(str(error))
            return "refused"
        for warning in caught:
            assert isinstance(warning.message, CampaignWarning), warning.message
            expect_one_line(str(warning.message))
        return "read"


def check_nominal(path: Path) -> None:
    """Read, write and read again."""
    nominal = read_nominal(path)
    expect_accepted(path, format_nominal(nominal))
    assert read_nominal(path) == nominal, "not read back as the same"


def check_touches(path: Path) -> None:
    """Read, write and read again, as touches and as conditions."""
    conditions = format_touches(read_conditions(path), CONDITIONS)
    touches = format_touches(read_touches(path))
    expect_accepted(path, touches)
    assert format_touches(read_touches(path)) == touches, "touches not read back as the same"
    expect_accepted(path, conditions)
    again = format_touches(read_conditions(path), CONDITIONS)
    assert again == conditions, "conditions not read back as the same"


def expect_accepted(path: Path, text: str) -> None:
    """Store what was written; what refuses it now is a failure."""
    path.write_text(text, encoding="utf-8")
    try:
        read_nominal(path) if path.suffix == ".toml" else read_conditions(path)
    except InputError as error:
        raise AssertionError(f"what was written is refused: {error}") from error


def expect_one_line(message: str) -> None:
    """Raise unless the message is one printable line of sensible length."""
    assert message.isprintable(), message
    assert 0 < len(message) < 2000, message


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


if __name__ == "__main__":
    sys.exit(main())
