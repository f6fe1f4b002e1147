"""The withheld check from end to end: a small fixed set, generated, diagnosed, unsealed, scored."""

from contextlib import chdir
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from one_thread import one_thread
from skiplatch import cli
from tests.withheld import check, goals, runs
from tests.withheld.scoring import FAILED, Scored

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("gap_check")]
# One of each case and a second single one: what is easy to see, so that a sound diagnosis needs no
# luck. Both singles and the pair are plain; the rest has nothing to name.
ORDER = runs.Order(20, 6, "single,two,none,stranger,dull", touches=(200, 220))
LEAST_RIGHT = 4
"""Naming nothing ever gets three right, and naming the same ever gets one."""


def run_here(folder: Path, *arguments: str) -> str:
    """Run a command in a folder without a process of its own, which takes a second to start."""
    with chdir(folder):
        result = CliRunner().invoke(cli.group, arguments)
    return str(result.exception) if result.exit_code else ""


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> list[Scored]:
    """Run the check once, with the diagnoses one after the other."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runs, "run_skiplatch", run_here)
        patch.setattr(runs, "opened", one_thread)
        return check.check(tmp_path_factory.mktemp("gap") / "set", ORDER, [], jobs=1)


def test_a_command_runs_in_a_process_of_its_own(tmp_path: Path) -> None:
    """Ties try one that succeeds."""
    assert "none: no such folder" in runs.run_skiplatch(tmp_path, "compare", "none")


def of(results: list[Scored], case: str) -> list[Scored]:
    return [scored for scored in results if scored.label.case == case]


def test_set_has_every_case(results: list[Scored]) -> None:
    cases = sorted(scored.label.case for scored in results)

    assert cases == ["dull", "none", "single", "single", "stranger", "two"]


def test_no_diagnosis_breaks_down(results: list[Scored]) -> None:
    assert FAILED not in {scored.found.verdict for scored in results}


def test_plain_effects_are_named(results: list[Scored]) -> None:
    singles = of(results, "single")

    assert all(scored.nats > 100 for scored in singles)
    assert all(scored.names_in_group for scored in singles)


def test_nothing_is_named_where_there_is_nothing(results: list[Scored]) -> None:
    assert not [scored.found for scored in of(results, "none") if scored.found.names]


def test_score_is_beyond_a_diagnosis_that_always_says_the_same(results: list[Scored]) -> None:
    assert sum(scored.is_right for scored in results) >= LEAST_RIGHT


def test_prediction_with_the_named_effects_comes_near_the_oracle(results: list[Scored]) -> None:
    shrinks = [s.shrink for s in of(results, "single") if not np.isnan(s.shrink)]

    assert shrinks
    assert max(shrinks) > 0.8
    assert max(shrinks) < 1.1


def test_report_has_every_row_and_every_campaign(results: list[Scored]) -> None:
    text = check.show(results)
    document = check.as_json(results, ORDER)

    for row in goals.rows(results):
        assert row.title.strip() in text
    assert len(document["campaigns"]) == ORDER.count
    assert sum(cell["count"] for cell in document["confusion"]) == ORDER.count - 1  # not the pair
