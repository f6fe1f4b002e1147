"""Samples of the parameters of a diagnosis: as the intervals say, all effects together."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import skiplatch
from skiplatch.diagnosis.fit.weighted_samples import Cloud
from skiplatch.diagnosis.reported.samples import samples
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.simulator.effects import Effect

DRAWS = 4000
DOCUMENT: dict[str, Any] = {
    "format": "skiplatch-diagnosis/2",
    "verdict": "no_gap",
    "effects": [],
    "gap": {},
    "seed": 3,
}


def named(effect: Effect, cloud: Cloud | None = None, **changes: Any) -> Named:  # noqa: ANN401
    intervals = dict.fromkeys(effect.parameters, (0.0, 8.0))
    return Named(effect, "stage", intervals, (), 0.9, cloud=cloud, **changes)


def test_parameters_of_all_effects_are_drawn_together() -> None:
    points = np.random.default_rng(1).normal(size=(500, 1))
    weights = np.random.default_rng(2).uniform(size=500)
    weights /= weights.sum()
    one, other = (
        named(Effect(name, {parameter: 0.0}), Cloud(sense * points, weights, frozenset({0})))
        for name, parameter, sense in (
            ("trigger_delay", "delay_us", 1.0),
            ("isr_latency", "latency_us", -1.0),
        )
    )

    drawn = samples([one, other, one], DRAWS, seed=5)

    assert list(drawn) == [
        "trigger_delay.delay_us",
        "isr_latency.latency_us",
        "trigger_delay[2].delay_us",
    ]
    assert {values.shape for values in drawn.values()} == {(1, DRAWS)}
    assert drawn["trigger_delay.delay_us"] == pytest.approx(-drawn["isr_latency.latency_us"])
    mean = float(weights @ points[:, 0])
    assert drawn["trigger_delay.delay_us"].mean() == pytest.approx(mean, abs=0.01)


def test_what_was_not_sampled_is_drawn_evenly_from_its_interval() -> None:
    lag = Effect("trigger_delay", {"delay_us": 4.0})
    cloud = Cloud(np.full((3, 1), 4.0), np.full(3, 1.0 / 3.0), frozenset({0}))
    tied = replace(cloud, sampled=frozenset())

    for one in (named(lag, tied), named(lag, cloud, idle=frozenset({"delay_us"}))):
        (drawn,) = samples([one], DRAWS, seed=1).values()

        assert drawn.min() < 0.1
        assert drawn.max() > 7.9
        assert drawn.mean() == pytest.approx(4.0, abs=0.2)


def test_an_angle_that_may_be_anywhere_stays_within_its_turn() -> None:
    lobes = Effect("pretravel_lobing", {"azimuth_deg": 10.0})
    cloud = Cloud(np.array([[-50.0], [70.0]]), np.array([0.5, 0.5]), frozenset({0}))

    (drawn,) = samples(
        [replace(named(lobes, cloud), intervals={"azimuth_deg": (0.0, 120.0)})], DRAWS, seed=1
    ).values()

    assert set(np.unique(drawn)) == {70.0}


def test_the_seed_picks_the_samples() -> None:
    points = np.arange(100.0).reshape(100, 1)
    one = named(
        Effect("trigger_delay", {"delay_us": 4.0}),
        Cloud(points, np.full(100, 0.01), frozenset({0})),
    )

    first, again, other = (samples([one], 50, seed)["trigger_delay.delay_us"] for seed in (1, 1, 2))

    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_samples_are_no_part_of_the_document() -> None:
    cloud = Cloud(np.full((3, 1), 4.0), np.full(3, 1.0 / 3.0), frozenset({0}))
    found = named(Effect("trigger_delay", {"delay_us": 4.0}), cloud)
    plain = skiplatch.Diagnosis.of_document(DOCUMENT)

    kept = replace(plain, _named=[found])

    assert set(kept.samples(draws=7)) == {"trigger_delay.delay_us"}
    assert json.dumps(kept.document) == json.dumps(plain.document)
    assert replace(plain, _named=[]).samples() == {}
    with pytest.raises(ValueError, match="a diagnosis from a document has none"):
        plain.samples()
    with pytest.raises(ValueError, match=r"draws: expected a whole number from 1 to .* got 0"):
        kept.samples(draws=0)


def test_arviz_takes_them() -> None:
    arviz = pytest.importorskip("arviz", reason="arviz is not installed: pip install 'arviz<1'")
    cloud = Cloud(np.arange(9.0).reshape(9, 1), np.full(9, 1.0 / 9.0), frozenset({0}))
    found = named(Effect("trigger_delay", {"delay_us": 4.0}), cloud)
    drawn = samples([found], 1000, seed=1)

    data = arviz.from_dict(posterior=drawn)

    assert data.posterior["trigger_delay.delay_us"].shape == (1, 1000)
