"""A second effect is kept only where it gains more than the first one's surrogate lacks."""

import pytest

from played_campaigns import BENCH, played, thinned
from skiplatch.diagnosis.fit.as_effects import as_effects
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.confirm import AsRig
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split
from skiplatch.diagnosis.search.surplus import without_surplus
from skiplatch.simulator.effects import Effect

JITTER = Effect("scan_jitter", {"jitter_us": 250.0, "tail_us": 500.0})
LATE = Effect("isr_latency", {"latency_us": 4.0, "jitter_us": 0.0})


def as_rig(scene: Scene) -> AsRig:
    """Give the rig that a fit says it is, its beliefs as they stand."""

    def rig(fit: Fit | None) -> Rig:
        return Rig(scene.nominal, as_effects(fit) if fit else ())

    return rig


@pytest.mark.long
@pytest.mark.parametrize("second", [None, LATE])
def test_only_a_second_effect_that_is_there_is_kept(second: Effect | None) -> None:
    scene = Scene.of(thinned(played(BENCH, *([JITTER, second] if second else [JITTER]), seed=3)))
    judge = Judge(scene, split(len(scene), 1))
    pair = judge.pairs(judge.singles()[0])[0]

    kept = without_surplus(judge, Finding(pair), as_rig(scene), seed=1)

    assert kept.model is not None
    assert "scan_jitter" in kept.model.ids
    assert len(kept.model.ids) == (2 if second else 1)


@pytest.mark.long
def test_a_first_effect_that_is_hard_to_hit_does_not_cost_the_second_one() -> None:
    off = Effect("scan_period", {"period_us": -401.149})
    lost = Effect("lost_trigger", {"probability": 0.05})
    scene = Scene.of(thinned(played(BENCH, off, lost, seed=3)))
    judge = Judge(scene, split(len(scene), 1))
    pair = judge.pairs(judge.singles()[0])[0]

    kept = without_surplus(judge, Finding(pair), as_rig(scene), seed=1)

    assert kept.model is not None
    assert kept.model.ids == ("scan_period", "lost_trigger")
