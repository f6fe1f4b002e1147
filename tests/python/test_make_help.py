"""`make help` lists all that the README says it does."""

import os
import subprocess
from pathlib import Path

ENVIRONMENT = {name: text for name, text in os.environ.items() if not name.startswith("MAKE")}


def make(*arguments: str) -> str:
    command = ("make", *arguments)
    return subprocess.run(
        command, env=ENVIRONMENT, capture_output=True, text=True, check=True
    ).stdout


def test_every_suite_is_listed() -> None:
    rule = "told:; @echo $(TEST_SUITES)"
    suites = {
        "target-BOARD" if suite.startswith("target-") else suite
        for suite in make("--eval", rule, "told").split()
    }
    listed = make("help").splitlines()[-1].split()

    assert listed[0] == "SUITE"
    assert {"unit", "target-BOARD"} <= suites <= set(listed)


def test_every_target_of_the_readme_is_listed() -> None:
    listed = {line.split()[0] for line in make("help").splitlines()}
    rows = [line for line in Path("README.md").read_text().splitlines() if line.startswith("| `")]
    told = {row.split("`")[1].split()[1] for row in rows if row.startswith("| `make ")}

    assert told
    assert told <= listed
