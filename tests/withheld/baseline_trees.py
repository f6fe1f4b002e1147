"""Baseline: an amortised classifier, extra trees that learned from simulated campaigns."""

import hashlib
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import joblib  # type: ignore[import-untyped]
import numpy as np
from sklearn.ensemble import ExtraTreesClassifier  # type: ignore[import-untyped]

from skiplatch.campaign import Campaign, Touches
from skiplatch.simulator.effects import effects
from skiplatch.simulator.library import LIBRARY
from tests.withheld.conditions import Recording, draw_setup
from tests.withheld.covariates import features
from tests.withheld.simulated import as_recorded, draw_effect, play_once

CAMPAIGNS = 3_000
TREES = 300
TOUCHES = (200, 1000)
NOTHING = ""
NOTHING_EVERY = 7  # campaigns without an effect
SEED = 20
CACHE = Path(__file__).parents[2] / "build" / "gap"
UNSEEN = {
    Recording.BENCH: (),
    Recording.STAMPED: ("edge_us",),
    Recording.POSITION: ("edge_us", "latch_us", "report_us"),
}


@dataclass(frozen=True, eq=False)
class Trees:
    """A classifier of campaigns with at most one effect.

    It is large, so what travels to a worker is where it lies.
    """

    kept_in: Path
    title: str = "extra trees"

    @classmethod
    def trained(cls, campaigns: int = CAMPAIGNS, folder: Path = CACHE) -> "Trees":
        """Train, or take what was trained with the same simulator and the same figures."""
        path = folder / f"trees-{_key(campaigns)}.joblib"
        if not path.exists():
            classifier = _fit(campaigns)
            folder.mkdir(parents=True, exist_ok=True)
            joblib.dump(classifier, path)
        return cls(path)

    @property
    def classifier(self) -> ExtraTreesClassifier:
        """The classifier, read once in each process."""
        return _read(self.kept_in)

    def name(self, campaign: Campaign) -> str | None:
        """Name the effect, or None."""
        return str(self.classifier.predict(features(campaign)[None, :])[0]) or None


@cache
def _read(path: Path) -> ExtraTreesClassifier:
    return joblib.load(path)


def _key(campaigns: int) -> str:
    """Digest all that the training depends on."""
    here = Path(__file__).parent
    sources = ("baseline_trees", "covariates", "simulated", "streams", "conditions")
    digest = hashlib.sha256(LIBRARY.read_bytes())
    for name in sources:
        digest.update((here / f"{name}.py").read_bytes())
    digest.update(str(campaigns).encode())
    return digest.hexdigest()[:16]


def _fit(campaigns: int) -> ExtraTreesClassifier:
    ids = list(effects())
    learned = []
    for i in range(campaigns):
        rng = np.random.default_rng([SEED, i])
        effect_id = NOTHING if i % NOTHING_EVERY == 0 else ids[i % len(ids)]
        campaign = _campaign(rng, effect_id)
        if campaign is not None:
            learned.append((features(campaign), effect_id))
    classifier = ExtraTreesClassifier(TREES, min_samples_leaf=2, random_state=SEED, n_jobs=-1)
    figures, names = zip(*learned, strict=True)
    return classifier.fit(np.array(figures), names)


def _campaign(rng: np.random.Generator, effect_id: str) -> Campaign | None:
    """Simulate a campaign on a rig of the generator's kinds, or None if it shows nothing."""
    recording = list(Recording)[int(rng.integers(len(Recording)))]
    setup = draw_setup(rng, recording, TOUCHES)
    switched_on = []
    if effect_id != NOTHING:
        effect = draw_effect(rng, effect_id, setup.nominal, setup.touches)
        if effect is None:
            return None
        switched_on = [effect]
    seed = int(rng.integers(2**31))
    played = play_once(setup.nominal, setup.touches, switched_on, seed)
    touches = as_recorded(setup.touches, played)
    recorded = _without(touches, UNSEEN[recording])
    return Campaign(setup.nominal, recorded, Path("simulated"))


def _without(touches: Touches, columns: tuple[str, ...]) -> Touches:
    return replace(touches, **{name: np.full(len(touches), np.nan) for name in columns})
