"""The corpora of the fuzzers in Python, seeds and former crashes, hold their properties."""

import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parents[1] / "fuzz"
FUZZERS = [path.name for path in sorted(FUZZ.glob("fuzz_*.py"))]
FOR_EACH = {"fuzz_readers.py": 0.1}  # so much of the time for each of its readers


def run_fuzzer(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(FUZZ / words[0]), *words[1:]]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("fuzzer", FUZZERS)
def test_whole_corpus_is_read_or_refused_in_one_line(fuzzer: str) -> None:
    run = run_fuzzer(fuzzer, "0", "--seed", "0")

    assert run.returncode == 0, run.stderr
    assert run.stdout.endswith(" 0 failures\n")


@pytest.mark.parametrize(
    "seconds",
    [pytest.param(5, marks=pytest.mark.long), pytest.param(20, marks=pytest.mark.nightly)],
)
@pytest.mark.parametrize("fuzzer", FUZZERS)
def test_what_is_mutated_is_read_or_refused_in_one_line(fuzzer: str, seconds: int) -> None:
    run = run_fuzzer(fuzzer, str(FOR_EACH.get(fuzzer, 1.0) * seconds))

    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout.endswith(" 0 failures\n")
