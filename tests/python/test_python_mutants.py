"""Mutants of the verdict's rules: what counts as one, and that the tests notice them."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.mutation.python_mutants import mutants_of

RULES = "scripts/skiplatch/diagnosis/verdict/rules.py"
SOURCE = '''\
"""No 1 < 2 here."""
@dataclass(frozen=True)
class A:
    """Nor 3."""
    size: Literal[4] = 0.5
    def f(self, a: int = 6) -> B | None:
        g(-a)
        return any(x + 1 for x in a if x.is_y and not x <= 7) or " µm"
'''


def test_mutants_are_of_code_alone() -> None:
    found = [mutant.change for mutant in mutants_of(SOURCE)]

    told = "any((x + 1 for x in a if x.is_y and (not x <= 7))) or ' µm'"
    condition = "x.is_y and (not x <= 7)"
    assert found == [
        "5:24: 0.5 => 0.55",
        "5:24: 0.5 => 0.45",
        "6:26: 6 => 7",
        "6:26: 6 => 5",
        "7:9: g(-a) => pass",
        "7:11: -a => a",
        f"8:9: return {told} => return None",
        f"8:16: {told} => {told.replace(' or ', ' and ')}",
        "8:16: any => all",
        "8:20: x + 1 => x - 1",
        "8:24: 1 => 2",
        "8:24: 1 => 0",
        f"8:40: {condition} => x.is_y or not x <= 7",
        f"8:40: {condition} => not ({condition})",
        "8:51: not x <= 7 => x <= 7",
        "8:55: x <= 7 => x < 7",
        "8:55: x <= 7 => x > 7",
        "8:60: 7 => 8",
        "8:60: 7 => 6",
        "8:66: ' µm' => ''",
    ]


def test_a_mutant_changes_one_place() -> None:
    found = [mutant.text for mutant in mutants_of("a = b < c < d")]

    assert found == ["a = b <= c < d", "a = b >= c < d", "a = b < c <= d", "a = b < c >= d"]


def scored(*options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tests.mutation.python_score", "--sources", RULES, *options]
    return subprocess.run(command, check=False, capture_output=True, text=True)


@pytest.mark.long
def test_the_tests_notice_what_is_drawn() -> None:
    """And where more is asked for than there can be, the exit status says so."""
    done = scored("--count", "3", "--least", "1.1")

    assert (done.returncode, done.stderr) == (1, "")
    assert "3 of 3 mutants killed, 100.0%; 110% are asked for" in done.stdout


def test_a_test_that_never_sees_the_module_scores_nothing(tmp_path: Path) -> None:
    blind = tmp_path / "test_blind.py"
    blind.write_text("def test_nothing():\n    assert True\n", encoding="utf-8")

    done = scored("--count", "3", "--tests", str(blind))

    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "the tests were not run: status 70\n"


@pytest.mark.long
def test_a_test_that_looks_at_nothing_lets_mutants_live(tmp_path: Path) -> None:
    idle = tmp_path / "test_idle.py"
    idle.write_text(
        "import skiplatch.diagnosis.verdict.rules\ndef test_it(): pass\n", encoding="utf-8"
    )

    done = scored("--count", "3", "--seed", "2", "--tests", str(idle))

    assert done.returncode == 1
    assert "0 of 3 mutants killed, 0.0%; 90% are asked for" in done.stdout
    assert done.stdout.count("rules.py:") == 4


def test_tests_that_fail_anyhow_score_nothing(tmp_path: Path) -> None:
    broken = tmp_path / "test_broken.py"
    text = "import skiplatch.diagnosis.verdict.rules\ndef test_it(): assert False\n"
    broken.write_text(text, encoding="utf-8")

    done = scored("--count", "3", "--tests", str(broken))

    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.endswith("test_broken.py: fails without a mutant\n")
