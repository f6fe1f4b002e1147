"""Effects that skiplatch's own simulator plays: what counts as found, and one from end to end."""

import pytest

from skiplatch.simulator.effects import Effect, effects
from tests.withheld import planted
from tests.withheld.planted import Found, Planted, plant, try_one


def found(truth: float, value: float, half: float, *, is_angle: bool = False) -> Found:
    return Found("size", truth, value, value - half, value + half, is_angle)


@pytest.mark.parametrize(
    ("parameter", "is_settled", "is_held", "error"),
    [
        (found(10.0, 10.2, 0.3), True, True, 0.02),
        (found(10.0, 10.5, 0.3), True, False, 0.05),
        (found(-10.0, -9.0, 3.0), False, True, 0.1),
        (found(2.0, 0.0, 0.1), False, False, 1.0),
        (found(359.0, 3.0, 5.0, is_angle=True), True, True, 0.0698),
        (found(90.0, 100.0, 20.0, is_angle=True), False, True, 0.1745),
    ],
)
def test_what_is_settled_held_and_how_far_it_is_off(
    parameter: Found, is_settled: bool, is_held: bool, error: float
) -> None:
    assert parameter.is_settled == is_settled
    assert parameter.is_held == is_held
    assert parameter.error == pytest.approx(error, rel=1e-3)


def test_only_what_is_settled_counts_and_what_is_not_right_is_listed() -> None:
    effect = Effect("backlash", {})
    parameters = [found(10.0, 10.2, 0.3), found(10.0, 10.4, 0.3), found(10.0, 30.0, 20.0)]
    tried = [
        Planted(effect, "bench", "explained", [("backlash",)], parameters),
        Planted(effect, "stamped", "explained", [("scale_error", "backlash")], []),
        Planted(effect, "position", "no_gap", [], []),
    ]

    text = planted.as_text(tried)

    assert "name or group: 2 of 3, 66.7 %" in text
    assert "median error: 3 %" in text
    assert "hold the truth: 1 of 2, 50.0 %" in text
    assert [line.split()[:3] for line in text.splitlines()[-2:]] == [
        ["backlash", "bench", "backlash"],
        ["backlash", "position", "no_gap"],
    ]


@pytest.mark.long
def test_a_planted_effect_is_found_with_its_parameters() -> None:
    number = list(effects()).index("lost_trigger")
    _, effect, campaign = plant(3, number)

    tried = try_one(3, number)

    (share,) = tried.parameters
    assert tried.effect == effect
    assert tried.groups == [("lost_trigger",)]
    assert share.truth == effect.parameters["probability"]
    assert share.value == pytest.approx(campaign.touches.missed.mean(), rel=0.3)
    assert share.low < share.value < share.high


@pytest.mark.parametrize("seed", [3, 4, 5])
@pytest.mark.parametrize("effect_id", ["trigger_delay", "transmission_error", "rotary_pivot"])
def test_no_other_numbers_do_what_the_planted_ones_do(seed: int, effect_id: str) -> None:
    _, effect, campaign = plant(seed, list(effects()).index(effect_id))
    p = effect.parameters

    assert p.get("delay_us", 0.0) >= -campaign.nominal.probe.delay_us
    assert all(p.get(f"amplitude{k}_um", 0.0) <= p.get("amplitude_um", 0.0) for k in (2, 3))
    assert {p.get("mirrored", 0.0), p.get("at_surface", 0.0)} <= {0.0, 1.0}
