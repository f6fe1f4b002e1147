"""Mutants of the firmware: what counts as one, and that the unit tests notice them."""

import subprocess
import sys

from tests.mutation.mutants import mutants_of

SOURCE = """\
#define LIMIT 3 /* a < b */
static int f(const int *a)
{
    g("1 < 2"); /* 4 > 5 */
    return a[0] < LIMIT && !a[1] ? a->b : 7u;
}
"""


def test_mutants_are_of_code_alone() -> None:
    found = [mutant.describe(SOURCE) for mutant in mutants_of(SOURCE)]

    assert found == [
        "2:24: * => +",
        "5:14: 0 => 0x1",
        "5:17: < => <=",
        "5:17: < => >=",
        "5:25: && => ||",
        "5:28: ! => nothing",
        "5:31: 1 => 0x2",
        "5:43: 7 => 0x8",
        '4:1: g("1 < 2"); => ;',
    ]


def test_a_mutant_changes_one_place() -> None:
    first = next(mutants_of("a + b + c"))

    assert first.apply("a + b + c") == "a - b + c"


def test_the_unit_tests_notice_what_is_drawn() -> None:
    """And where more is asked for than there can be, the exit status says so."""
    command = "tests.mutation.score firmware/report/latch_stream.c --count 3 --least 1.1"
    done = subprocess.run(
        [sys.executable, "-m", *command.split()], check=False, capture_output=True, text=True
    )

    assert (done.returncode, done.stderr) == (1, "")
    assert "mutants killed, 100.0%; 110% are asked for" in done.stdout
