"""Effects that begin or end: played, weighed, found, and told from a surface that was moved."""

from collections.abc import Collection
from dataclasses import fields, replace
from typing import Any, cast

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played, played_again, thinned
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Campaign, Nominal, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.diagnose import diagnose
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import WORTH_OF_AN_END, Fit, fit
from skiplatch.diagnosis.fit.onset import (
    FEWEST,
    gained_by_an_end,
    outlives_datum,
    parts_of,
    passing,
    polished,
    proposed,
)
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import finds_any
from skiplatch.diagnosis.search.scored import Scored, worth
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import Outcomes
from skiplatch.span import ALWAYS, Span

LATE = Effect("isr_latency", {"latency_us": 40.0})


def middle_touch(campaign: Campaign) -> int:
    return int(np.median(campaign.touches.touch))


def of(candidate_id: str, parameters: list[float], span: Span = ALWAYS) -> Fit:
    one = replace(CANDIDATES[candidate_id], span=span)
    return Fit((one,), (np.array(parameters),), frozenset())


def nats(scene: Scene, change: Change) -> float:
    return likelihood(scene, change).total


@pytest.mark.parametrize(
    ("span", "held"),
    [
        (ALWAYS, [True, True, True]),
        (Span(since=5), [False, True, True]),
        (Span(until=5), [True, True, False]),
        (Span(since=5, until=5), [False, True, False]),
    ],
)
def test_a_span_holds_its_first_and_its_last_touch(span: Span, held: list[bool]) -> None:
    assert span.holds(np.array([4, 5, 6])).tolist() == held


def test_an_effect_that_begins_is_played_where_it_is_there_and_nowhere_else() -> None:
    campaign = read_campaign(BENCH)
    since = middle_touch(campaign)

    def play(*effects: Effect) -> Outcomes:
        return Rig(campaign.nominal, effects).play(campaign.touches, seed=3, replicates=2)

    without, throughout, begun = play(), play(LATE), play(replace(LATE, span=Span(since=since)))

    there = campaign.touches.touch >= since
    assert 0 < there.sum() < len(there)
    for field in fields(Outcomes):
        values = [getattr(one, field.name) for one in (without, throughout, begun)]
        np.testing.assert_array_equal(values[2], np.where(there, values[1], values[0]))
    assert np.nanmax(np.abs(begun.latch_us - without.latch_us)) > 30.0


def test_two_effects_that_pass_overlap_where_both_are_there() -> None:
    campaign = read_campaign(BENCH)
    numbers = np.sort(campaign.touches.touch)
    first, last = int(numbers[len(numbers) // 3]), int(numbers[2 * len(numbers) // 3])
    twice = [replace(LATE, span=Span(since=first)), replace(LATE, span=Span(until=last))]

    def stamps(*effects: Effect) -> FloatArray:
        rig = Rig(campaign.nominal, effects)
        return np.asarray(rig.play(campaign.touches, seed=3, replicates=1).latch_us[0])

    both = campaign.touches.touch <= last, campaign.touches.touch >= first
    there = both[0] & both[1]
    np.testing.assert_array_equal(stamps(*twice)[there], stamps(LATE, LATE)[there])
    np.testing.assert_array_equal(stamps(*twice)[~there], stamps(LATE)[~there])


def test_the_likelihood_of_parts_is_that_of_each_under_its_own_change() -> None:
    scene = Scene.of(read_campaign(BENCH))
    since = int(np.median(scene.touches.touch))
    own = of("isr_latency", [40.0, 0.0, 0.0])
    begun = of("isr_latency", [40.0, 0.0, 0.0], Span(since=since))

    throughout, never = likelihood(scene, own.change(scene)), likelihood(scene, Change())
    found = likelihood(scene, begun.change(scene))

    later = scene.touches.touch >= since
    expected = np.where(later, throughout.streams["latch_skip"], never.streams["latch_skip"])
    np.testing.assert_allclose(found.streams["latch_skip"], expected, atol=0.2)
    np.testing.assert_allclose(found.streams["report"], never.streams["report"], atol=1e-5)


@pytest.mark.parametrize("begins", [True, False])
def test_the_touch_is_found_at_which_an_effect_begins_or_ends(begins: bool) -> None:
    touch = middle_touch(read_campaign(BENCH))
    span = Span(since=touch) if begins else Span(until=touch)
    scene = Scene.of(played(BENCH, replace(LATE, span=span)))

    (first, *_) = proposed(scene, [of("isr_latency", [20.0, 0.0, 0.0])])
    found = polished(scene, passing(scene, first))

    (effect,) = as_effects(found)
    assert (effect.span.since if begins else effect.span.until) == pytest.approx(touch, abs=3)
    assert effect.parameters["latency_us"] == pytest.approx(40.0, abs=1.0)


def test_both_touches_are_found_between_which_an_effect_acts() -> None:
    first, last = np.quantile(read_campaign(BENCH).touches.touch, [0.3, 0.55]).astype(int).tolist()
    scene = Scene.of(played(BENCH, replace(LATE, span=Span(since=first, until=last))))

    (likely, *_) = proposed(scene, [of("isr_latency", [20.0, 0.0, 0.0])])
    found = polished(scene, passing(scene, likely))

    (effect,) = as_effects(found)
    assert effect.span.since == pytest.approx(first, abs=3)
    assert effect.span.until == pytest.approx(last, abs=3)
    assert effect.parameters["latency_us"] == pytest.approx(40.0, abs=1.0)


def test_an_end_costs_more_than_a_parameter() -> None:
    throughout = of("isr_latency", [40.0, 0.0, 0.0])
    begun = of("isr_latency", [40.0, 0.0, 0.0], Span(since=5))

    assert begun.size > throughout.size + 1
    assert begun.key != throughout.key


def test_few_touches_have_no_ends() -> None:
    scene = Scene.of(read_campaign(BENCH))
    few = scene.select(np.arange(16))

    assert proposed(few, [of("isr_latency", [20.0, 0.0, 0.0])]) == []

    assert parts_of(scene.select(np.arange(20))) == []
    first, between, last = (part.touches.touch for part in parts_of(scene))
    assert first.max() < between.min() <= between.max() < last.min()


def test_a_surface_that_was_moved_is_no_effect_that_begins() -> None:
    """What only shifts all readings of an axis since a touch, a datum of its own takes up."""
    campaign = read_campaign(MACHINE)
    touches, since = campaign.touches, middle_touch(campaign)
    later = touches.touch >= since
    shifted = replace(touches, deviation_um=touches.deviation_um + 30.0 * later)
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.AXIS))
    moved = Scene.of(replace(campaign, nominal=nominal, touches=shifted))
    # Play in both senses alike is what comes nearest to a surface that was moved.
    play = replace(CANDIDATES["backlash"], span=Span(since=since))
    found = fit(moved, [play], [[30.0, 30.0, 0.0, 0.0, 0.0]])

    assert nats(moved, found.change(moved)) - nats(moved, Change()) > 100.0
    assert outlives_datum(moved, found) < 15.0


def test_a_play_that_ends_may_be_shared_by_both_senses() -> None:
    """The datum that stays takes up no share of what is gone later."""
    campaign = read_campaign(MACHINE)
    campaign = replace(campaign, nominal=replace(campaign.nominal, datum=Datum(DatumFreedom.AXIS)))
    span = Span(until=middle_touch(campaign))
    shared = Effect("backlash", {"backlash_um": 2.0, "positive_um": 2.0}, span)
    scene = Scene.of(played_again(campaign, shared))
    assert CANDIDATES["backlash"].taken_up(scene) == {1, 3, 4}  # nothing touches along Z

    # As a part of the campaign shows it, beside a datum of its own: all of it in one sense.
    first, *_ = proposed(scene, [of("backlash", [4.0, 0.0, 0.0, 0.0, 0.0])])
    (effect,) = as_effects(polished(scene, passing(scene, first)))

    assert effect.span.until == pytest.approx(span.until, abs=4)
    assert effect.parameters["backlash_um"] == pytest.approx(2.0, abs=0.5)
    assert effect.parameters["positive_um"] == pytest.approx(2.0, abs=0.5)


@pytest.mark.parametrize(
    "acting",
    [
        Effect("scale_error", {"scale_ppm": 40.0}),
        Effect("trigger_delay", {"delay_us": 150.0}),
        Effect("contact_bounce", {"probability": 0.5, "mean_us": 100.0}),
    ],
)
def test_an_effect_as_it_is_tells_whether_it_ends(acting: Effect) -> None:
    """No look is needed, nor another fit: that of all touches does better without some of them."""
    campaign = read_campaign(MACHINE)
    ends = replace(acting, span=Span(until=middle_touch(campaign)))

    def gained(effect: Effect) -> float:
        scene = Scene.of(played_again(campaign, effect))
        candidate = CANDIDATES[effect.id]
        starts = candidate.starts(scene, Change())
        return gained_by_an_end(scene, [fit(scene, [candidate], starts)])

    assert gained(acting) < worth(WORTH_OF_AN_END) < gained(ends)


def test_no_effect_begins_among_too_few_touches() -> None:
    scene = Scene.of(read_campaign(MACHINE)).select(np.arange(2 * FEWEST))

    assert gained_by_an_end(scene, [of("trigger_delay", [100.0, 0.0, 0.0])]) == 0.0


@pytest.mark.parametrize(
    "begins",
    [pytest.param(True, marks=pytest.mark.long), pytest.param(False, marks=pytest.mark.nightly)],
)
def test_an_effect_that_begins_or_ends_is_named_with_the_touch(begins: bool) -> None:
    touch = middle_touch(read_campaign(BENCH))
    span = Span(since=touch) if begins else Span(until=touch)

    diagnosis = diagnose(thinned(played(BENCH, replace(LATE, span=span))), seed=1)

    assert diagnosis.verdict in (Verdict.EXPLAINED, Verdict.PARTLY_EXPLAINED)
    (named,) = diagnosis.effects
    assert "isr_latency" in (named.effect.id, *named.alternatives)
    found = named.effect.span.since if begins else named.effect.span.until
    assert found == pytest.approx(touch, abs=0.05 * len(read_campaign(BENCH).touches))
    assert named.when.startswith("since touch" if begins else "until touch")


class Ranking:
    """A judge of one effect that lasts and gains nothing, and one that begins and gains much."""

    def __init__(self) -> None:
        fits = of("backlash", [0.1, 0.0]), of("backlash", [2.0, 0.0], Span(since=50))
        self.lasting, self.begun = (
            Scored(one, 50.0 * size, 50.0 * size) for size, one in enumerate(fits)
        )

    def believe_beside(self, model: None) -> None: ...

    def singles(self, ids: Collection[str] | None = None) -> list[Scored]:
        return [self.lasting] if ids is None else []

    def told_otherwise(self) -> list[Nominal]:
        return []

    told_along_grid = told_otherwise

    def may_begin(self, _: list[Scored]) -> bool:
        return False

    def is_significant(self, scored: Scored) -> bool:
        return scored.score > 10.0

    def passing(self, _: list[Scored]) -> list[Scored]:
        return [self.begun]

    is_enough = is_significant


@pytest.mark.parametrize("left", [frozenset(), frozenset({"position"})])
def test_an_effect_that_fits_not_all_touches_may_begin_where_something_is_left(
    left: frozenset[str],
) -> None:
    asked: list[Scored | None] = []

    def noticed(model: Scored | None) -> frozenset[str]:
        asked.append(model)
        return left

    assert finds_any(cast(Any, Ranking()), noticed, []) == bool(left)
    assert asked == [None]


def test_an_effect_that_is_likely_and_enough_leaves_the_others_untried() -> None:
    class Likely(Ranking):
        def singles(self, ids: Collection[str] | None = None) -> list[Scored]:
            assert ids == ["backlash"]
            return [self.begun]

    def noticed(_: Scored | None) -> frozenset[str]:
        pytest.fail("nothing else is to be asked")

    assert finds_any(cast(Any, Likely()), noticed, ["backlash"])
