"""What becomes of ties: how they are counted, and one resolved from end to end."""

import numpy as np
import pytest

from skiplatch.campaign import Touches
from tests.withheld import ties
from tests.withheld.cases import Drawn, draw_campaign
from tests.withheld.conditions import Recording
from tests.withheld.orders import Case, Order
from tests.withheld.resume import resume
from tests.withheld.ties import Fate, Tie

TWO_GROUPS = (frozenset({"trigger_delay", "input_filter"}), frozenset({"following_error"}))


def tie(truth: str, *left: str, groups: tuple[frozenset[str], ...] = TWO_GROUPS) -> Tie:
    return Tie(truth, "", groups, "latch_us", frozenset(left))


@pytest.mark.parametrize(
    ("found", "fate"),
    [
        (tie("following_error", "following_error"), Fate.RESOLVED),
        (tie("trigger_delay", "trigger_delay", "input_filter"), Fate.RESOLVED),
        (tie("trigger_delay", "trigger_delay", "following_error"), Fate.OPEN),
        (tie("trigger_delay", "input_filter"), Fate.WRONG),
        (tie("backlash", "following_error"), Fate.ABSENT),
        (tie("trigger_delay", "trigger_delay", groups=TWO_GROUPS[:1]), Fate.SAME),
    ],
)
def test_a_tie_is_resolved_if_no_more_is_left_than_was_expected(found: Tie, fate: Fate) -> None:
    assert found.fate is fate


def test_the_share_counts_what_the_experiment_could_resolve() -> None:
    found = [
        tie("following_error", "following_error"),
        tie("trigger_delay", "input_filter"),
        tie("trigger_delay", "trigger_delay", "input_filter"),
        tie("trigger_delay", "trigger_delay", groups=TWO_GROUPS[:1]),
        tie("backlash", "following_error"),
    ]

    text = ties.as_text(found, campaigns=9)

    assert "9 campaigns, 5 ties" in text
    assert "resolved as far as expected: 2 of 3, 66.7 %" in text
    assert "the truth alone is left: 1 of 3" in text


def lagging() -> Drawn:
    """A machine that kept its deviations alone and whose axis lags."""
    order = Order(Case.SINGLE, Recording.POSITION, ["following_error"])
    return draw_campaign(np.random.default_rng(8), order, (150, 160))


def test_further_touches_have_the_same_effect_and_the_column_asked_for() -> None:
    drawn = lagging()
    again = drawn.setup.touches

    made = resume(np.random.default_rng(3), drawn, again, ["latch_us"])

    def lag_um(touches: Touches) -> float:
        fast = touches.on_skip & (touches.feed_mm_min == touches.feed_mm_min.max())
        return float(np.median(touches.deviation_um[fast]))

    before = Touches.from_columns(
        **{name: getattr(again, name) for name in ("touch", "time_s", "path", "feed_mm_min")},
        deviation_um=drawn.outcomes.deviation_um,
    )
    assert not np.isnan(made.latch_us).any()
    assert np.isnan(made.report_us).all()
    assert lag_um(made) == pytest.approx(lag_um(before), rel=0.2)


@pytest.mark.long
def test_the_recommended_touches_tell_a_lag_from_a_delay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ties, "draw", lambda *_: lagging())

    found = ties.try_one(seed=1, number=0)

    assert found is not None
    assert found.record == "latch_us"
    assert found.fate is Fate.RESOLVED
    assert found.is_alone
