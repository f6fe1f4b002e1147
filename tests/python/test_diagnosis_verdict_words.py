"""What a rule of a verdict says where it does not hold: which size, of what, in which unit."""

from dataclasses import replace

import pytest

from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.rules import EXPLAINS, HAS_GAP, NAMES, SEES
from skiplatch.diagnosis.verdict.verdict import failures
from verdict_evidence import GROWING, gap, gaps, left

RULES = {rule.name: rule for rule in (*EXPLAINS, *NAMES, *SEES, *HAS_GAP)}
TOLD_FIRST = left(9.0, "feed")
TOLD_NEXT = replace(left(30.0, "time"), observable="missed", path="plc")
PARAMETERS = ["backlash.backlash_um", "drift.rate_um_per_h"]
FAR_OFF = Evidence(outlying=40, touches=200)
LEAVING = Evidence(after=[left(4.4, "rest"), TOLD_FIRST, TOLD_NEXT])
TIGHT = gaps(
    gap(0.9, tightness=0.1),
    gap(0.9, is_clear=False, tightness=0.1),
    gap(0.9, tightness=0.2),
    gap(0.9),
)
IS_LEFT = "left: position on skip, goes with feed"
ARE_FAR_OFF = "40 of 200 touches are far off all plays: that is no accident"


@pytest.mark.parametrize(
    ("name", "evidence", "words"),
    [
        (
            "shrinks",
            Evidence(gaps=gaps(gap(0.501), gap(0.9), gap(0.1))),
            "the gap shrinks for certain only: observable_0 by 50%, observable_2 by 10%",
        ),
        (
            "shrinks",
            Evidence(gaps=gaps(gap(-0.6), gap(0.9))),
            "the gap shrinks for certain only: observable_0 not at all",
        ),
        (
            "shrinks",
            Evidence(gaps=gaps(gap(0.9, is_clear=False))),
            "no gap is clear enough to tell that all of it is gone",
        ),
        ("leaves_nothing", LEAVING, IS_LEFT),
        ("few_outliers", FAR_OFF, ARE_FAR_OFF),
        (
            "few_outliers",
            Evidence(outlying=6, outlying_in=["edge"], outlying_with="feed", touches=200),
            "6 of 200 touches are far off all plays in edge and go with feed: that is no accident",
        ),
        (
            "few_outliers",
            Evidence(outlying=40, outlying_in=["edge", "report"], touches=200),
            "40 of 200 touches are far off all plays in edge and report: that is no accident",
        ),
        (
            "undoes_nothing",
            Evidence(undoing=["servo_hold", "following_error"]),
            "each undoes what another one does: servo_hold, following_error",
        ),
        ("has_form", Evidence(is_loose=True), "its form is as far off as can be"),
        (
            "held_out",
            Evidence(is_held_out=False),
            "too few touches were held out to show that it shrinks",
        ),
        (
            "within_limits",
            Evidence(at_limit=PARAMETERS),
            "at a limit of its range: backlash.backlash_um, drift.rate_um_per_h",
        ),
        (
            "known",
            Evidence(open=PARAMETERS),
            "may be anything in its range: backlash.backlash_um, drift.rate_um_per_h",
        ),
        (
            "is_confirmed",
            Evidence(is_confirmed=False),
            "plain simulation does no better with it",
        ),
        (
            "is_as_wide",
            Evidence(gaps=TIGHT, everywhere=TIGHT),
            "what was recorded scatters far less than it plays: observable_0, observable_2",
        ),
        ("shrinks_somewhere", Evidence(gaps=gaps(gap(0.1))), "no gap shrinks for certain"),
        ("shrinks_somewhere", Evidence(), "no gap is clear"),
        (
            "grows_nowhere",
            Evidence(gaps=gaps(GROWING, gap(0.9), GROWING)),
            "the gap grows: observable_0, observable_2",
        ),
        (
            "chance_is_chance",
            Evidence(chance=[left(3.9, "rest"), TOLD_FIRST, TOLD_NEXT]),
            "what it leaves to chance in position goes with feed",
        ),
        (
            "takes_most",
            Evidence(after=[left(9.0, relative=3.4567)]),
            "it leaves 3.46 µm of position, much of what was there",
        ),
        (
            "seen_enough",
            Evidence(hidden=6.54),
            "a gap of 6.5 times the noise could have hidden",
        ),
        (
            "seen_enough",
            Evidence(hidden=float("inf")),
            "too few touches were made to tell any noise",
        ),
        ("believed_leaves_nothing", LEAVING, IS_LEFT),
        ("believed_few_outliers", FAR_OFF, ARE_FAR_OFF),
    ],
)
def test_a_rule_says_what_it_misses(name: str, evidence: Evidence, words: str) -> None:
    (failure,) = failures([RULES[name]], evidence)

    assert failure.words == words


def test_effects_with_a_parameter_at_a_limit_are_told_by_their_ids() -> None:
    evidence = Evidence(at_limit=["backlash.backlash_um", "link_retry.period_us"])

    assert evidence.effects_at_limit == {"backlash", "link_retry"}
