"""A failure that was repaired: the gap while it lasted, and that it is over."""

from collections.abc import Sequence
from datetime import timedelta
from itertools import pairwise

import numpy as np
import pytest

from simulated_fleet import DEVIATION, START
from skiplatch.fleet.changes import Change, find_changes
from skiplatch.fleet.chart import FEWEST_BEFORE, shifts
from skiplatch.fleet.findings import change_text, find
from skiplatch.fleet.history import Entry, Gap, History
from skiplatch.report.fleet import NEXT_BETTER, as_html
from test_diagnosis_report import prose

GOOD_UM = (0.43, 0.41, 0.46, 0.42, 0.44, 0.40, 0.45, 0.43, 0.41, 0.42, 0.44, 0.43)
FAILED_UM = (10.0, 12.0)
PACE = timedelta(days=15)


def rig(gaps_um: Sequence[float]) -> History:
    """A rig with these gaps."""
    name = DEVIATION.name
    return {
        "failer": [
            Entry(
                campaign=f"{number:064x}",
                time=START + number * PACE,
                folder=f"{number:02}",
                kind="machine",
                touches=60,
                verdict="unknown",
                stage=None,
                gap_um=gap_um,
                gaps={name: Gap(name, "µm", gap_um, 0.44)},
                parameters=[],
            )
            for number, gap_um in enumerate(gaps_um)
        ]
    }


def changes_after(repaired: int, *, more: Sequence[float] = ()) -> list[Change]:
    return find_changes(rig([*GOOD_UM, *FAILED_UM, *GOOD_UM[:repaired], *more]))


@pytest.mark.parametrize("repaired", [0, 1, 2, 4, 10])
def test_a_failure_keeps_its_gap_whatever_follows(repaired: int) -> None:
    failure = changes_after(repaired)[0]

    assert failure.before == pytest.approx(0.43, rel=0.05)
    assert failure.after == pytest.approx(11.0, rel=0.05)
    assert failure.began == START + 12 * PACE


def test_a_single_campaign_after_a_repair_is_told_with_the_failure() -> None:
    (failure,) = changes_after(1)

    assert failure.back is not None
    assert failure.back.gap == pytest.approx(0.43)
    assert failure.back.campaigns == 1
    assert not failure.is_over
    back = f"back to 0.43 µm since {START + 14 * PACE:%Y-%m-%d}, by 1 campaign, too few to be sure"
    assert f"; {back}" in change_text(failure)


@pytest.mark.parametrize("repaired", [2, 4, 10])
def test_a_repair_is_sure_as_soon_as_two_campaigns_show_it(repaired: int) -> None:
    (failure,) = changes_after(repaired)

    assert failure.back is not None
    assert (failure.back.since, failure.news) == (START + 14 * PACE, START + 15 * PACE)
    assert (failure.is_worse, failure.is_over) == (True, True)
    assert failure.back.campaigns == repaired
    assert change_text(failure).endswith(f"since {START + 14 * PACE:%Y-%m-%d}")


def test_a_repair_of_an_old_failure_is_news() -> None:
    history = rig([*GOOD_UM, *FAILED_UM, *GOOD_UM[:2]])

    found = find(history, days=1.0, alarms_a_month=0.02)

    assert [change.is_over for change in found.recent] == [True]
    page = as_html(found, store="works", weeks=52)
    assert NEXT_BETTER in page
    assert "back to 0.42 µm since" in prose(page)
    alone = find({"failer": history["failer"][:15]}, days=1.0, alarms_a_month=0.02)
    assert alone.recent == []


def test_a_repair_that_did_not_hold_is_to_be_looked_at() -> None:
    bad_um = [25.0 * gap_um for gap_um in GOOD_UM]
    found = find(rig([*bad_um, *GOOD_UM[:2], *bad_um[:2]]), days=60.0, alarms_a_month=0.02)

    assert [(change.is_worse, change.is_over) for change in found.recent] == [(False, True)]
    assert NEXT_BETTER not in as_html(found, store="works", weeks=52)


def test_a_failure_that_lasts_is_ended_by_a_change_of_its_own() -> None:
    failure, repair = find_changes(rig([*GOOD_UM, *FAILED_UM, *FAILED_UM, *GOOD_UM]))

    assert (failure.back, repair.back) == (None, None)
    assert repair.before == failure.after
    assert not repair.is_worse


def test_a_failure_that_comes_again_is_found_again() -> None:
    first, again = changes_after(4, more=[11.0, 10.5])

    assert first.back is not None
    assert first.back.campaigns == 4
    assert again.is_worse
    assert again.before == first.back.gap
    assert again.began == START + 18 * PACE


def test_a_failure_that_grows_further_is_a_change_of_its_own() -> None:
    first, further = changes_after(0, more=[50.0, 52.0])

    assert (first.back, further.back) == (None, None)
    assert further.before == first.after == pytest.approx(11.0, rel=0.05)
    assert further.after == pytest.approx(51.0, rel=0.05)


def test_what_is_repaired_in_part_is_told_with_its_gap() -> None:
    (failure,) = changes_after(0, more=[3.0, 3.1])

    assert failure.back is not None
    assert failure.back.gap == pytest.approx(3.05, rel=0.05)


def test_an_alarm_by_chance_and_its_end_are_one() -> None:
    rng = np.random.default_rng(1)
    level = np.full(52, 2e-3)
    charts = [shifts(rng.normal(0.0, 1.0, 52), level) for _ in range(2000)]

    over = [one for found in charts for one in found if one.back_seen is not None]
    assert len(over) > 20
    assert sum(map(len, charts)) < len(charts) * level.sum()
    for found in charts:
        for one, following in pairwise(found):
            assert following.began != one.end or following.began - one.began >= FEWEST_BEFORE


def test_what_raised_an_alarm_raises_no_second_one() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        values = rng.normal(0.0, 1.0, 60) + 0.3 * np.maximum(np.arange(60) - 15.0, 0.0)
        seen = [found.seen for found in shifts(values, np.full(60, 1e-2))]

        assert seen == sorted(set(seen))
