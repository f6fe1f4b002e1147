"""Fuzz the reading of campaigns: mutated files are read or refused in one line, nothing else.

    python tests/fuzz/fuzz_campaign.py SECONDS [--seed N]

Starts from the files in corpus/campaign (``*.toml`` for nominal.toml, ``*.csv`` for touches.csv),
mutates their bytes and tokens, and reads the result. What is accepted must be written and read
back as the same. An input that breaks this is kept in the corpus and the exit status is 1.
"""

import argparse
import hashlib
import random
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

from mutations import expect_one_line, expect_refusal, mutated

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
MOST_SECONDS = 5.0  # of processor time that one small file may take


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
    started = time.process_time()
    try:
        verdict = check(suffix, data)
        assert time.process_time() - started < MOST_SECONDS, "took too long"
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
            expect_refusal(error)
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


if __name__ == "__main__":
    sys.exit(main())
