"""Effects in forms other than the plainest, and what is no effect of the catalogue at all."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis import Verdict, diagnose
from skiplatch.simulator import Controller, Effect, play

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
MACHINE = read_campaign(SAMPLES / "machine_no_gap")


def simulated(*switched_on: Effect) -> Campaign:
    """Play the touches of a recorded campaign with other effects and other random numbers."""
    nominal, touches = MACHINE.nominal, MACHINE.touches
    controller = Controller.for_campaign(nominal, touches)
    played = play(nominal, controller, touches, seed=5, switched_on=switched_on)
    outcomes = {
        name: getattr(played, name)[0] for name in ("latch_us", "report_us", "deviation_um")
    }
    return replace(MACHINE, touches=replace(touches, **outcomes))


@pytest.mark.parametrize(
    ("effect_id", "parameters"),
    [
        ("backlash", {"backlash_um": 2.5, "positive_um": 2.5, "y_more": 0.5}),
        ("rotary_pivot", {"x_um": 5.0, "y_um": -3.0, "unset": 1.0, "mirrored": 1.0}),
        ("encoder_quantisation", {"resolution_um": 7.3, "is_coordinate": 1.0}),
        ("isr_latency", {"latency_us": 20.0, "tail_us": 15.0}),
    ],
)
def test_another_form_has_the_same_name(effect_id: str, parameters: Mapping[str, float]) -> None:
    diagnosis = diagnose(simulated(Effect(effect_id, parameters)), seed=1, jobs=2)

    assert [named.effect.id for named in diagnosis.effects] == [effect_id]


def test_an_error_with_the_approach_gets_no_name() -> None:
    plain = simulated()
    off = plain.touches.deviation_um + 1.5 * plain.touches.approach_mm
    touches = replace(plain.touches, deviation_um=np.round(off, 1))
    diagnosis = diagnose(replace(plain, touches=touches), seed=1, jobs=2)

    assert diagnosis.verdict == Verdict.UNKNOWN
    assert not diagnosis.effects


def test_an_effect_of_a_form_far_off_explains_in_part() -> None:
    plain = simulated()
    touches = plain.touches
    share = 1.0 + 0.4 * np.random.default_rng(3).standard_normal(len(touches))
    off = touches.deviation_um + 0.05 * touches.position_mm * touches.sign * share
    odd = replace(plain, touches=replace(touches, deviation_um=np.round(off, 1)))
    diagnosis = diagnose(odd, seed=1, jobs=2)

    assert diagnosis.verdict == Verdict.PARTLY_EXPLAINED
    assert [named.effect.id for named in diagnosis.effects] == ["scale_error"]
