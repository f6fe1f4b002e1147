"""What is fuzzed holds its properties: the seeds, former crashes, and what is made of them."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parents[1] / "fuzz"
FUZZERS = [path.name for path in sorted(FUZZ.glob("fuzz_*.py"))]
TARGETS = [path.stem for path in sorted(FUZZ.glob("fuzz_*.c"))]
SECONDS = {"fuzz_readers.py": 0.5}  # for each of its readers
MINUTE = 60
NIGHTLY = pytest.param(True, marks=pytest.mark.nightly)


def run_fuzzer(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(FUZZ / words[0]), *words[1:]]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.long
@pytest.mark.parametrize("fuzzer", FUZZERS)
def test_whole_corpus_is_read_or_refused_in_one_line(fuzzer: str) -> None:
    run = run_fuzzer(fuzzer, "0", "--seed", "0")

    assert run.returncode == 0, run.stderr
    assert run.stdout.endswith(" 0 failures\n")


@pytest.mark.parametrize("is_minute", [pytest.param(False, marks=pytest.mark.long), NIGHTLY])
@pytest.mark.parametrize("fuzzer", FUZZERS)
def test_what_is_mutated_is_read_or_refused_in_one_line(fuzzer: str, *, is_minute: bool) -> None:
    run = run_fuzzer(fuzzer, str(MINUTE if is_minute else SECONDS.get(fuzzer, 5.0)))

    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout.endswith(" 0 failures\n")


@pytest.mark.nightly
@pytest.mark.skipif(shutil.which("clang") is None, reason="no clang here")
@pytest.mark.parametrize("target", TARGETS)
def test_a_minute_of_libfuzzer_finds_nothing(target: str) -> None:
    command = ["VARIANT=fuzz", "INNER=yes", f"fuzz/{target}", f"SECONDS={MINUTE}"]
    run = subprocess.run(
        [shutil.which("make") or "make", *command],
        cwd=FUZZ.parents[1],
        capture_output=True,
        text=True,
        check=False,
    )

    assert run.returncode == 0, run.stdout + run.stderr
    assert "stat::number_of_executed_units" in run.stderr
