"""A second effect is kept only where it gains more than the first one's surrogate lacks."""

import pytest

from played_campaigns import BENCH, played
from skiplatch.diagnosis.decide import Finding
from skiplatch.diagnosis.diagnose import as_effects
from skiplatch.diagnosis.judge import Judge, split
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.surplus import without_surplus
from skiplatch.simulator import Effect

JITTER = Effect("scan_jitter", {"jitter_us": 250.0, "tail_us": 500.0})
LATE = Effect("isr_latency", {"latency_us": 4.0, "jitter_us": 0.0})


@pytest.mark.parametrize("second", [None, LATE])
def test_only_a_second_effect_that_is_there_is_kept(second: Effect | None) -> None:
    scene = Scene.of(played(BENCH, *([JITTER, second] if second else [JITTER]), seed=3))
    judge = Judge(scene, split(len(scene), 1))
    pair = judge.pairs(judge.singles()[0])[0]

    kept = without_surplus(judge, Finding(pair), as_effects, seed=1)

    assert kept.model is not None
    assert "scan_jitter" in kept.model.ids
    assert len(kept.model.ids) == (2 if second else 1)


def test_a_first_effect_that_is_hard_to_hit_does_not_cost_the_second_one() -> None:
    off = Effect("scan_period", {"period_us": -401.149})
    scene = Scene.of(played(BENCH, off, Effect("lost_trigger", {"probability": 0.05}), seed=3))
    judge = Judge(scene, split(len(scene), 1))
    pair = judge.pairs(judge.singles()[0])[0]

    kept = without_surplus(judge, Finding(pair), as_effects, seed=1)

    assert kept.model is not None
    assert kept.model.ids == ("scan_period", "lost_trigger")
