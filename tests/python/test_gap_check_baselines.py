"""The baselines of the withheld check, on campaigns whose effect is plain."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from skiplatch.campaign import Campaign, write_campaign
from skiplatch.simulator.effects import Effect, effects
from skiplatch.workers import Workers
from tests.withheld import baseline_crps
from tests.withheld.baseline_crps import LowestCrps
from tests.withheld.baseline_regression import Regression
from tests.withheld.baseline_trees import Trees
from tests.withheld.baselines import guess_all
from tests.withheld.conditions import Recording, draw_setup
from tests.withheld.covariates import features
from tests.withheld.simulated import as_recorded, draw_effect, play_once, recorded_residuals

PLAIN = {
    "backlash": {"backlash_um": 8.0},
    "isr_latency": {"latency_us": 200.0, "jitter_us": 0.0},
    "report_delay": {"delay_us": 400.0, "queue_us": 0.0},
    "scale_error": {"scale_ppm": 120.0},
}


def campaign(*switched_on: Effect, seed: int = 4) -> Campaign:
    """Play a machine with time stamps."""
    setup = draw_setup(np.random.default_rng(seed), Recording.STAMPED, (300, 300))
    played = play_once(setup.nominal, setup.touches, list(switched_on), seed)
    return Campaign(setup.nominal, as_recorded(setup.touches, played), Path("simulated"))


class Kind:
    """A baseline that names the kind of campaign."""

    title = "kind"

    def name(self, campaign: Campaign) -> str | None:
        return str(campaign.nominal.kind)


def without_stamps(recorded: Campaign) -> Campaign:
    empty = np.full(len(recorded.touches), np.nan)
    return replace(recorded, touches=replace(recorded.touches, latch_us=empty, report_us=empty))


@pytest.mark.parametrize("effect_id", PLAIN)
def test_regression_names_what_is_plain(effect_id: str) -> None:
    assert Regression().name(campaign(Effect(effect_id, PLAIN[effect_id]))) == effect_id


def test_regression_seldom_names_anything_where_nothing_is() -> None:
    named = [Regression().name(campaign(seed=seed)) for seed in range(40)]

    assert sum(name is not None for name in named) <= 1  # 2 of 40 at 0.1 %: once in 1,300


def test_regression_names_lost_touches() -> None:
    assert Regression().name(campaign(Effect("lost_trigger", {"probability": 0.1}))) == (
        "lost_trigger"
    )


@pytest.fixture
def few_effects(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the CRPS choose among a few effects, to be quick."""
    few = {effect_id: effects()[effect_id] for effect_id in PLAIN}
    monkeypatch.setattr(baseline_crps, "effects", lambda: few)


@pytest.mark.long
@pytest.mark.usefixtures("few_effects")
@pytest.mark.parametrize("effect_id", ["backlash", "isr_latency", "report_delay"])
def test_lowest_crps_names_what_is_plain(effect_id: str) -> None:
    assert LowestCrps().name(campaign(Effect(effect_id, PLAIN[effect_id]))) == effect_id


@pytest.mark.long
@pytest.mark.usefixtures("few_effects")
def test_lowest_crps_names_nothing_where_nothing_is() -> None:
    assert [LowestCrps().name(campaign(seed=seed)) for seed in (4, 5, 6)] == [None] * 3


def test_drawn_effects_show_and_are_not_absurd() -> None:
    recorded = campaign()
    rng = np.random.default_rng(0)
    for effect_id in PLAIN:
        effect = draw_effect(rng, effect_id, recorded.nominal, recorded.touches)

        assert effect is not None
        with_it = recorded_residuals(recorded.nominal, campaign(effect).touches)
        without = recorded_residuals(recorded.nominal, recorded.touches)
        change = max(
            float(np.sqrt(np.nanmean((with_it[s] - without[s]) ** 2)))
            for s in ("latch", "deviation", "report")
        )
        assert 0.2 < change < 150.0


def test_features_of_what_was_not_recorded_are_empty() -> None:
    recorded = campaign()

    whole, positions = features(recorded), features(without_stamps(recorded))

    assert whole.shape == positions.shape
    assert np.isnan(positions).mean() > np.isnan(whole).mean() + 0.3
    assert not np.isinf(whole).any()


@pytest.mark.long
def test_a_cluster_guesses_what_processes_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    folders = [Path(effect_id) for effect_id in PLAIN]
    for folder in folders:
        recorded = campaign(Effect(folder.name, PLAIN[folder.name]))
        write_campaign(folder, recorded.nominal, recorded.touches)

    here = guess_all(folders, [Regression(), Kind()], Workers(jobs=2))
    there = guess_all(folders, [Regression(), Kind()], Workers(cluster="local:1"))

    assert here == [{"regression": folder.name, "kind": "machine"} for folder in folders]
    assert there == here


@pytest.mark.long
def test_trees_learn_and_are_kept(tmp_path: Path) -> None:
    trained = Trees.trained(140, tmp_path)
    (kept,) = tmp_path.iterdir()
    again = Trees.trained(140, tmp_path)
    unlike = campaign(Effect("report_delay", PLAIN["report_delay"]))

    assert again.name(unlike) == trained.name(unlike)
    assert list(tmp_path.iterdir()) == [kept]
    assert set(trained.classifier.classes_) <= {"", *effects()}
    assert len(trained.classifier.classes_) > 20
