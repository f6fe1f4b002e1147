"""The corpus of the campaign fuzzer, seeds and former crashes, holds its property."""

import subprocess
import sys
from pathlib import Path

FUZZER = Path(__file__).parents[1] / "fuzz" / "fuzz_campaign.py"


def test_whole_corpus_is_read_or_refused_in_one_line() -> None:
    run = subprocess.run(
        [sys.executable, FUZZER, "0", "--seed", "0"], capture_output=True, text=True, check=False
    )

    assert run.returncode == 0, run.stderr
    assert run.stdout.endswith(" 0 failures\n")
