"""The next experiment: what it recommends, and whether that settles what it says it settles."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy import integrate, stats

from effects_rig import CONTROLLER, MACHINE, SCAN_US, mixed_touches
from played_campaigns import BENCH
from skiplatch.campaign import Axis, Campaign, Status, Touches, read_campaign
from skiplatch.diagnosis import Diagnosis, Verdict
from skiplatch.diagnosis.experiment import (
    Experiment,
    experiment_json,
    experiment_text,
    next_experiment,
    settle,
    touches_table,
)
from skiplatch.diagnosis.experiment.choice import choose
from skiplatch.diagnosis.experiment.conditions import elsewhere, spread_out
from skiplatch.diagnosis.experiment.evidence import exponents, log_likelihoods
from skiplatch.diagnosis.experiment.surfaces import are_varied, asked_for
from skiplatch.diagnosis.experiment.trial import Trial
from skiplatch.diagnosis.experiment.words import STILL_OF_USE
from skiplatch.diagnosis.reported.diagnosis import Ranked
from skiplatch.motion import expected_contact
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import Outcomes, play

Model = tuple[Effect, ...]

TRIALS = 40
LEARNT = 300  # replicates
POSITION_ONLY = ("deviation_um",)
STAMPED = ("latch_us", "report_us", "deviation_um")

DELAY = (Effect("trigger_delay", {"delay_us": 150.0}),)
FILTER = (Effect("input_filter", {"delay_us": 150.0}),)
LAG = (Effect("following_error", {"lag_us": 150.0}),)
SCALE = (Effect("scale_error", {"scale_ppm": 7.5}),)
LONG_WAVE = (Effect("transmission_error", {"amplitude_um": 1.59, "period_mm": 590.0}),)
BOUNCE = (Effect("contact_bounce", {"probability": 0.3, "mean_us": 500.0}),)
RETRY = (Effect("link_retry", {"probability": 0.3, "period_us": 700.0}),)
PERIOD = (Effect("scan_period", {"period_us": 50.0}),)
OVERRUN = (Effect("scan_overrun", {"probability": 0.2, "overrun_us": 1000.0}),)

TIES: Mapping[str, tuple[tuple[Model, Model], Sequence[str]]] = {
    "delay, lag": ((DELAY, LAG), POSITION_ONLY),
    "scale, wave": ((SCALE, LONG_WAVE), POSITION_ONLY),
    "period, overrun": ((PERIOD, OVERRUN), STAMPED),
}


def recorded(model: Model, columns: Sequence[str], n: int = 200) -> Campaign:
    """A machine with an effect, of which some columns were kept."""
    touches = mixed_touches(n, seed=3)
    outcomes = play(MACHINE, CONTROLLER, touches, seed=5, switched_on=model)
    kept = {name: getattr(outcomes, name)[0] for name in columns}
    status = np.where(outcomes.ok[0], Status.OK, Status.MISSED).astype(np.int8)
    return Campaign(MACHINE, replace(touches, status=status, **kept), Path("rig"))


def diagnosed(verdict: Verdict, rivals: Sequence[Model], ranking: Sequence[Model]) -> Diagnosis:
    """What the experiment looks at in a diagnosis; the finding is the first rival."""
    finding = rivals[0] if rivals else ()
    named = [SimpleNamespace(effect=effect, alternatives=()) for effect in finding]
    parts = SimpleNamespace(
        verdict=verdict,
        effects=named,
        rivals=[Ranked(model, 100.0) for model in rivals],
        ranking=[Ranked(model, 90.0) for model in ranking],
    )
    return cast(Diagnosis, parts)


def settled(*models: Model, columns: Sequence[str]) -> Experiment:
    return settle(recorded(models[0], columns), models, seed=1, jobs=1)


@cache
def tie(name: str) -> Experiment:
    """What settles one of the ties; several tests look at the same."""
    models, columns = TIES[name]
    return settled(*models, columns=columns)


def seen(touches: Touches, outcomes: Outcomes, columns: Sequence[str]) -> list[np.ndarray]:
    """What was recorded, counted from the expected contact; each of shape (r, n)."""
    contact_us = expected_contact(MACHINE, touches).time_us
    of = {
        "latch_us": outcomes.latch_us - contact_us,
        "report_us": outcomes.report_us - outcomes.latch_us,
        "deviation_um": outcomes.deviation_um,
    }
    by_column = [of[name] for name in columns]
    return [*by_column, between_scans_us(outcomes)] if "latch_us" in columns else by_column


def between_scans_us(outcomes: Outcomes) -> np.ndarray:
    """Where a stamp lies in the scans that go on from the stamp before; shape (r, n)."""
    stamps = outcomes.latch_us
    noise = np.random.default_rng(1).normal(0.0, 1.0, stamps.shape)  # no density without width
    return np.asarray((stamps - np.roll(stamps, 1, axis=1) + noise + SCAN_US / 2.0) % SCAN_US)


def share_right(touches: Touches, models: Sequence[Model], columns: Sequence[str]) -> float:
    """How often kernel densities of other simulations name the model that was played."""

    def played(model: Model, seed: int, replicates: int) -> list[np.ndarray]:
        outcomes = play(
            MACHINE, CONTROLLER, touches, seed=seed, replicates=replicates, switched_on=model
        )
        assert outcomes.ok.all()
        return seen(touches, outcomes, columns)

    learnt = [played(model, 1001, LEARNT) for model in models]
    right = []
    for truth, model in enumerate(models):
        score = np.zeros((len(models), TRIALS))
        for channel, tried in enumerate(played(model, 2002 + truth, TRIALS)):
            for touch in range(len(touches)):
                for judge, known in enumerate(learnt):
                    density = stats.gaussian_kde(known[channel][:, touch], bw_method=0.1)
                    score[judge] += np.log(density(tried[:, touch]) + 1e-9)
        right.append(np.mean(score.argmax(axis=0) == truth))
    return float(np.mean(right))


def test_without_stamps_a_lag_and_a_delay_call_for_the_stamp() -> None:
    experiment = tie("delay, lag")

    assert experiment.record == "latch_us"
    assert experiment.resolves
    assert experiment.touches_needed is not None
    assert experiment.touches_needed <= 10
    assert "Record latch_us" in experiment.words
    assert "no touches would do" in experiment.words


def test_with_stamps_a_lag_and_a_delay_need_no_other_column() -> None:
    experiment = settled(DELAY, LAG, columns=STAMPED)

    assert experiment.record is None
    assert experiment.resolves


def test_scale_and_a_long_wave_call_for_positions_far_out_on_both_sides() -> None:
    experiment = tie("scale, wave")

    position_mm = experiment.touches.position_mm
    assert experiment.record is None
    assert experiment.resolves
    assert position_mm.min() < -250.0
    assert position_mm.max() > 250.0
    assert np.median(np.abs(position_mm)) > 200.0  # where the curves part
    assert len(np.unique(position_mm)) > 10


@pytest.mark.parametrize("columns", [POSITION_ONLY, STAMPED])
@pytest.mark.parametrize("off_us", [0.0, 0.3])
def test_two_delays_in_a_row_are_said_to_be_inseparable(
    columns: Sequence[str], off_us: float
) -> None:
    other = (Effect("input_filter", {"delay_us": 150.0 + off_us}),)

    experiment = settled(DELAY, other, columns=columns)

    assert experiment.separates == (("trigger_delay", "input_filter"),)
    assert not experiment.resolves
    assert experiment.record is None
    assert experiment.touches_needed is None
    assert experiment.expected_bits == experiment.bits_per_touch == 0.0
    assert "Expected:" not in experiment_text(experiment)
    assert "cannot be separated" in experiment.words
    assert experiment.words.endswith(STILL_OF_USE)
    assert "between the stages probe and input" in experiment.words


def test_what_can_be_separated_is_while_the_rest_stays_tied() -> None:
    experiment = settled(DELAY, FILTER, LAG, columns=POSITION_ONLY)

    assert experiment.separates == (("trigger_delay", "input_filter"), ("following_error",))
    assert experiment.record == "latch_us"
    assert not experiment.resolves
    assert "trigger_delay and input_filter stay tied" in experiment.words


def test_an_error_of_warmth_shows_on_a_machine_that_warms_up() -> None:
    cool = recorded(DELAY, STAMPED)
    cool = replace(cool, touches=replace(cool.touches, temp_c=np.full(200, 20.0)))
    warmth = (*DELAY, Effect("thermal_drift", {"drift_um_k": 2.0}))

    experiment = settle(cool, [DELAY, warmth], seed=1, jobs=1)

    assert experiment.resolves
    np.testing.assert_allclose(experiment.touches.temp_c, np.linspace(20.0, 25.0, 60))
    assert "warms up by 5 K" in experiment.words


@pytest.mark.parametrize("name", TIES)
def test_the_recommended_touches_settle_the_tie(name: str) -> None:
    models, columns = TIES[name]
    experiment = tie(name)

    assert experiment.resolves
    assert len(experiment.touches) == 60
    kept = (*columns, experiment.record) if experiment.record else columns
    assert share_right(experiment.touches, models, kept) >= 0.95


def test_the_touches_needed_are_enough_and_not_all() -> None:
    models, columns = TIES["scale, wave"]
    experiment = tie("scale, wave")
    needed = experiment.touches_needed

    assert needed is not None
    assert share_right(experiment.touches.select(slice(needed)), models, columns) >= 0.9
    assert needed <= 20


def test_a_finding_with_no_rival_is_held_against_the_next_best() -> None:
    diagnosis = diagnosed(Verdict.EXPLAINED, [DELAY], [DELAY, LAG, FILTER])

    experiment = next_experiment(recorded(DELAY, POSITION_ONLY), diagnosis, seed=1)

    assert experiment.separates == (("trigger_delay",), ("following_error",))


@pytest.mark.parametrize(
    ("verdict", "says"),
    [(Verdict.NO_GAP, "no gap to settle"), (Verdict.UNKNOWN, "No effect of the catalogue")],
)
def test_with_nothing_named_the_touches_are_spread_over_everything(
    verdict: Verdict, says: str
) -> None:
    campaign = recorded((), POSITION_ONLY)

    experiment = next_experiment(campaign, diagnosed(verdict, [], [LAG]), seed=1)

    touches = experiment.touches
    assert says in experiment.words
    assert experiment.separates == ()
    assert experiment.touches_needed is None
    assert touches.on_plc.sum() == 30
    assert len(np.unique(touches.feed_mm_min)) == 4
    features = (touches.feed_mm_min, touches.sign, touches.position_mm, touches.approach_mm)
    together = np.corrcoef(np.vstack(features)) - np.eye(len(features))
    assert np.abs(together).max() < 0.4


def test_touches_stay_where_the_rig_has_been() -> None:
    touches = mixed_touches(100, seed=1)

    drawn = spread_out(touches, 500, np.random.default_rng(1)).touches

    assert drawn.feed_mm_min.max() <= touches.feed_mm_min.max()
    assert drawn.approach_mm.max() <= touches.approach_mm.max() + 0.01
    assert drawn.position_mm.min() >= touches.position_mm.min() - 0.01
    assert drawn.position_mm.max() <= touches.position_mm.max() + 0.01
    assert (np.diff(drawn.time_s) > (drawn.approach_mm / drawn.feed_mm_min * 60.0)[:-1]).all()


ANYWHERE = (-np.inf, np.inf)


def test_a_campaign_of_one_kind_of_touch_is_touched_otherwise_where_it_was() -> None:
    same = mixed_touches(1, seed=1)

    drawn = spread_out(same, 100, np.random.default_rng(1)).touches

    assert drawn.feed_mm_min.min() < same.feed_mm_min[0] / 4.0
    assert drawn.approach_mm.min() < same.approach_mm[0] / 3.0
    for name in ("path", "axis", "sign", "alpha_deg", "beta_deg", "position_mm", "rotary_deg"):
        assert set(getattr(drawn, name)) == set(getattr(same, name))


def test_surfaces_that_a_campaign_does_not_have_are_drawn_apart() -> None:
    same = mixed_touches(1, seed=1)

    drawn = elsewhere(same, 100, np.random.default_rng(1), ANYWHERE).touches

    assert set(drawn.sign) == {-1.0, 1.0}
    assert np.ptp(drawn.position_mm) > 90.0
    assert len(np.unique(drawn.rotary_deg)) == 4
    assert asked_for(drawn, same) == ", ".join(
        (
            f"in the sense {Axis(same.axis[0]).name}{'−' if same.sign[0] > 0.0 else '+'}",
            f"at places from {drawn.position_mm.min():g} to {drawn.position_mm.max():g} mm",
            f"with the table at {_others(drawn.rotary_deg, same.rotary_deg)}",
        )
    )


def _others(angles: np.ndarray, known: np.ndarray) -> str:
    return ", ".join(f"{angle:g}°" for angle in np.unique(angles) if angle not in known)


def surfaces_of_a_router() -> Touches:
    """Forty touches of Z from above, and ten of one wall along X by a short approach."""
    z, x = np.repeat(True, 40), np.repeat(False, 10)
    is_z = np.concatenate([z, x])
    return Touches.from_columns(
        touch=np.arange(50),
        time_s=np.arange(50) * 10.0,
        axis=np.where(is_z, Axis.Z, Axis.X),
        sign=np.where(is_z, -1.0, 1.0),
        feed_mm_min=np.where(np.arange(50) % 2, 50.0, 200.0),
        approach_mm=np.where(is_z, 10.0, 2.0),
        position_mm=np.where(is_z, -12.0, 80.0),
        deviation_um=np.zeros(50),
    )


def test_only_surfaces_that_were_touched_are_asked_for_all_as_often() -> None:
    touches = surfaces_of_a_router()

    drawn = spread_out(touches, 100, np.random.default_rng(1)).touches

    places = zip(drawn.axis, drawn.sign, drawn.position_mm, strict=True)
    assert set(places) == {(Axis.Z, -1.0, -12.0), (Axis.X, 1.0, 80.0)}
    assert (drawn.axis == Axis.X).sum() == 50
    assert drawn.approach_mm[drawn.axis == Axis.X].max() <= 2.0
    assert not are_varied(touches)


def test_surfaces_that_never_latched_are_not_asked_for() -> None:
    touches = surfaces_of_a_router()
    is_x = touches.axis == Axis.X
    missed = replace(
        touches,
        status=np.where(is_x, Status.MISSED, Status.OK).astype(np.int8),
        deviation_um=np.where(is_x, np.nan, 0.0),
    )

    drawn = spread_out(missed, 100, np.random.default_rng(1)).touches

    assert set(drawn.axis) == {Axis.Z}


def test_surfaces_out_of_reach_are_not_asked_for_unless_the_reach_is_wrong() -> None:
    touches = surfaces_of_a_router()
    rng = np.random.default_rng(1)

    inside = spread_out(touches, 100, rng, (-50.0, 10.0)).touches
    wrong = spread_out(touches, 100, rng, (500.0, 600.0)).touches

    assert set(inside.axis) == {Axis.Z}
    assert set(wrong.axis) == {Axis.Z, Axis.X}
    assert (wrong.approach_mm > 0.0).all()


def test_what_only_the_other_sense_can_tell_is_said_and_not_asked_for() -> None:
    one_sense = recorded(LAG, STAMPED)
    x = one_sense.touches.select((one_sense.touches.axis == Axis.X) & one_sense.touches.on_skip)
    x = replace(x, sign=np.ones(len(x)), position_mm=np.full(len(x), 25.0))
    screw = (Effect("backlash", {"backlash_um": 0.0, "positive_um": 8.0}),)
    scale = (Effect("scale_error", {"scale_ppm": 320.0}),)  # as much at 25 mm

    experiment = settle(replace(one_sense, touches=x), [screw, scale], seed=1, jobs=1)

    assert set(experiment.touches.sign) == {1.0}
    assert set(experiment.touches.position_mm) == {25.0}
    assert not experiment.resolves
    assert "in the sense X−" in experiment.words


def test_no_column_is_asked_for_that_the_rig_does_not_have() -> None:
    experiment = settle(
        recorded(DELAY, POSITION_ONLY), [DELAY, LAG], seed=1, jobs=1, as_recorded=True
    )

    assert experiment.record is None
    assert "Record" not in experiment.words


def normal_samples(shift: float, touches: int, replicates: int, seed: int) -> np.ndarray:
    """Two models that differ by a shift in standard deviations; shape (2, r, n)."""
    rng = np.random.default_rng(seed)
    return rng.normal(np.array([0.0, shift])[:, None, None], 1.0, (2, replicates, touches))


def test_exponents_are_those_of_known_distributions() -> None:
    shifts = (0.0, 1.0, 2.0)
    means = [
        exponents({"x": normal_samples(shift, 200, 192, seed=1)})[0, 1].mean() for shift in shifts
    ]

    assert means[0] < 0.01
    assert means[1] == pytest.approx(1.0 / 8.0, rel=0.15)
    assert means[2] == pytest.approx(4.0 / 8.0, rel=0.15)


def test_bits_and_touches_needed_are_those_of_known_distributions() -> None:
    known, played = (normal_samples(1.0, 60, 400, seed) for seed in (1, 2))
    trial = Trial.of(log_likelihoods({"x": known}, {"x": played}), np.array([0, 1]))

    def left(x: float) -> float:
        return float(stats.norm.pdf(x) * np.log2(1.0 + np.exp(x - 0.5)))

    information = 1.0 - integrate.quad(left, -10.0, 10.0)[0]
    needed = (2.0 * stats.norm.ppf(0.97)) ** 2  # touches of a shift of one standard deviation
    assert trial.bits_per_touch == pytest.approx(information, abs=0.03)
    assert trial.count == 2
    assert trial.touches_needed == pytest.approx(needed, abs=6)


def test_no_touches_tell_models_of_one_group_apart() -> None:
    known, played = (normal_samples(0.0, 60, 192, seed) for seed in (1, 2))
    trial = Trial.of(log_likelihoods({"x": known}, {"x": played}), np.array([0, 0]))

    assert trial.count == 1
    assert trial.touches_needed is None
    assert trial.bits < 0.1


def test_all_touches_tell_no_less_than_one() -> None:
    """A draw that its own model thinks impossible spoils the bound of the sum."""
    logs = np.zeros((2, 2, 5, 20))  # [judge, truth, replicate, touch]
    logs[0, 0] = logs[1, 1] = 1.0
    logs[0, 0, 0, 0] = -30.0

    trial = Trial.of(logs, np.array([0, 1]))

    assert trial.bits >= trial.bits_per_touch > 0.5


def test_every_pair_of_models_gets_its_touches() -> None:
    exponent = np.array([[1.0, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.001]])

    picked = choose(exponent, 20)

    assert picked[0] == 0
    assert {0, 1} == set(picked)  # the third pair is one and the same
    assert (picked == 1).sum() > (picked == 0).sum()


def test_the_result_depends_on_the_seed_and_not_on_the_jobs() -> None:
    campaign = recorded(DELAY, POSITION_ONLY)

    def result(seed: int, jobs: int) -> dict[str, object]:
        return experiment_json(settle(campaign, [DELAY, LAG], seed=seed, jobs=jobs))

    found = result(1, 1)
    assert found == result(1, 2)
    assert found["touches"] != result(2, 1)["touches"]


def test_json_counts_the_touches_and_the_text_names_them() -> None:
    experiment = tie("delay, lag")

    document = experiment_json(experiment)

    assert document["why"] == experiment.words
    assert document["record"] == "latch_us"
    assert sum(touch["count"] for touch in document["touches"]) == 60
    assert document["touches"][0]["path"] in {"skip", "plc"}
    assert document["expected_bits"] == pytest.approx(1.0, abs=0.05)
    assert document["separates"] == [["trigger_delay"], ["following_error"]]
    assert "feed_mm_min" in experiment_text(experiment)


@pytest.mark.parametrize("name", ["X- at 0 -6.3 0 0 0", "2.71828"])
def test_text_names_a_session_as_it_is(name: str) -> None:
    experiment = tie("delay, lag")
    touches = replace(experiment.touches, session_names=(name,))

    said = experiment_text(replace(experiment, touches=touches))

    assert f"  {name}  " in said


def test_a_bench_without_motion_is_asked_for_none() -> None:
    """Edges and latches alone: feeds and ways stood in for what it does not have."""
    campaign = replace(read_campaign(BENCH), stood_in=frozenset({"feed_mm_min", "approach_mm"}))

    experiment = next_experiment(campaign, diagnosed(Verdict.NO_GAP, [], []), seed=1)

    header, _ = touches_table(experiment)
    assert not {"feed_mm_min", "approach_mm", "rest_s"} & set(header)
    for touch in experiment_json(experiment)["touches"]:
        assert touch["feed_mm_min"] is touch["approach_mm"] is touch["rest_s"] is None


def test_places_of_one_height_are_all_asked_for() -> None:
    z = surfaces_of_a_router().select(np.arange(40))
    names = ("after homing 2 Z- at 0 0", "Z- at 50 0")
    placed = replace(z, session=np.arange(40) % 2, session_names=names)

    drawn = spread_out(placed, 100, np.random.default_rng(1)).touches

    asked = [drawn.session_names[number] for number in drawn.session]
    assert {name: asked.count(name) for name in asked} == {"Z- at 0 0": 50, "Z- at 50 0": 50}
