"""The corpora of the fuzzers in Python, seeds and former crashes, hold their properties."""

import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parents[1] / "fuzz"


@pytest.mark.parametrize("fuzzer", [path.name for path in sorted(FUZZ.glob("fuzz_*.py"))])
def test_whole_corpus_is_read_or_refused_in_one_line(fuzzer: str) -> None:
    run = subprocess.run(
        [sys.executable, FUZZ / fuzzer, "0", "--seed", "0"],
        capture_output=True,
        text=True,
        check=False,
    )

    assert run.returncode == 0, run.stderr
    assert run.stdout.endswith(" 0 failures\n")
