"""Plain simulation decides: what the surrogates propose is played, and scored on other touches."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np
from scoringrules import crps_ensemble  # type: ignore[import-untyped]

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import InputPath
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.likelihood import NEVER_LOST
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import as_recorded
from skiplatch.diagnosis.scene.observed import observed, step
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.groups import TEMPER
from skiplatch.diagnosis.search.parts import Split
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.search.separation import Separation, inseparable
from skiplatch.simulator.playing import Outcomes
from skiplatch.statistics import Interval

REACH = 15.0
"""Nats behind the best up to which a model is held against it."""
MOST_MODELS = 6
PLAYED_TOUCHES = 40_000
FEWEST_REPLICATES, MOST_REPLICATES = 20, 100
BATCHES = 10
"""Of replicates, each of which makes a score of its own."""
GAIN_ERRORS = 1.96
CLEARLY = 3.0
"""Standard errors by which a rival has to do better to take the finding's place."""
MATERIAL = 0.01
"""Gain in score that matters: that of a shift by a fifth of the noise."""
OWN_PLAYS = 50
"""At most, of a model that gains nothing; one in 51 would gain less than all of them by chance."""

AsRig = Callable[[Fit | None], Rig]


@dataclass(frozen=True, slots=True, eq=False)
class Confirmation:
    """What plain simulation says of models, the proposed one first.

    Attributes:
        gains: By how much each scores better than the unchanged simulation, a touch.
        chosen: Number of the model that stands.
        holds: Whether that one improves on the unchanged simulation, or need not on so few touches.
    """

    gains: Sequence[Interval]
    chosen: int
    holds: bool


def settle(
    scene: Scene,
    parts: Split,
    finding: Finding,
    as_rig: AsRig,
    *,
    seed: int,
    jobs: int = 1,
    executor: Executor | None = None,
) -> tuple[Finding, Confirmation | None]:
    """Let plain simulation choose the finding's model, and find what is not told from it.

    Args:
        scene: The touches.
        parts: Of them; the checking part decides.
        finding: As the surrogates propose it.
        as_rig: Gives the rig that a fit says it is, or for None the believed one.
        seed: Of the plays.
        jobs: Threads to play on.
        executor: Fits side by side.
    """
    models = contenders(finding)
    if not models:
        return finding, None
    rigs = [as_rig(model.fit) for model in models]
    found = confirm(scene, parts.checking, as_rig(None), rigs, seed=seed, jobs=jobs)
    best = models[found.chosen]
    rivals = [model for model in models if model is not best]
    told = inseparable(
        scene, parts.naming, best, rivals, rigs[found.chosen], seed=seed, executor=executor
    )
    return _widened(finding, best, told), found


def contenders(finding: Finding) -> list[Scored]:
    """Give the models within reach of the finding's, that one first."""
    best = finding.model
    if best is None:
        return []
    near = [s for s in finding.ranking if s is not best and s.score > best.score - REACH]
    return [best, *near][:MOST_MODELS]


def confirm(
    scene: Scene, rows: BoolArray, believed: Rig, rigs: Sequence[Rig], *, seed: int, jobs: int = 1
) -> Confirmation:
    """Play rigs, the proposed one first, and score them on touches they were not fitted to."""
    unchanged = _play(scene, believed, seed, jobs)
    plays = [_play(scene, rig, seed, jobs) for rig in rigs]
    keeps_grid = all(rig.keeps_scan_grid for rig in rigs)
    scorer = _Scorer(scene, rows, unchanged, keeps_grid=keeps_grid)
    scores = [scorer.scores(played) for played in plays]
    gains = [_interval(scorer.unchanged - score, GAIN_ERRORS) for score in scores]
    better = [_interval(scores[0] - score, CLEARLY) for score in scores]
    stronger = [
        i for i, gain in enumerate(better) if i > 0 and gain.low > 0.0 and gain.value > MATERIAL
    ]
    chosen = max(stronger, key=lambda i: better[i].value, default=0)
    holds = gains[chosen].value > 0.0 or _is_usual(
        scorer, unchanged, plays[chosen], gains[chosen].high
    )
    return Confirmation(gains, chosen, holds)


def _is_usual(scorer: "_Scorer", unchanged: Outcomes, played: Outcomes, gain: float) -> bool:
    """Tell whether the model's own plays may gain as little: what is rare may not have happened."""
    for k in range(min(OWN_PLAYS, len(played.ok))):
        own = scorer.of_play(unchanged, played, k)
        if float(np.mean(own.unchanged - own.scores(played))) <= gain:
            return True
    return False


def _interval(values: FloatArray, errors: float) -> Interval:
    """Give the mean of differences, shape (b, m), and so many standard errors about it.

    Touches scatter, and so do batches: all touches of a replicate share the phase of its scans, so
    that chance in the plays does not average out over touches.
    """
    touches, batches = values.mean(axis=0), values.mean(axis=1)
    value = float(values.mean())
    if len(touches) < 2:
        return Interval(value, -np.inf, np.inf)
    variance = np.var(touches, ddof=1) / len(touches) + np.var(batches, ddof=1) / len(batches)
    half = errors * float(np.sqrt(variance))
    return Interval(value, value - half, value + half)


def _play(scene: Scene, rig: Rig, seed: int, jobs: int) -> Outcomes:
    replicates = np.clip(PLAYED_TOUCHES // len(scene), FEWEST_REPLICATES, MOST_REPLICATES)
    whole = int(replicates) // BATCHES * BATCHES
    return rig.play(scene.touches, seed=seed, replicates=whole, jobs=jobs)


class _Scorer:
    """Scores plays by the recorded touches: less is better."""

    def __init__(
        self, scene: Scene, rows: BoolArray, unchanged: Outcomes, *, keeps_grid: bool
    ) -> None:
        """Score what was recorded of some touches, shape (n,).

        Args:
            scene: All touches.
            rows: Which of them.
            unchanged: Plays of the believed rig.
            keeps_grid: The scans of all rigs come evenly, so that stamps tell how late one is.
        """
        self._scene = scene
        self._keeps_grid = keeps_grid
        self._rows = rows
        self._recorded = observed(scene, scene.touches)
        nominal = observed(scene, unchanged)
        self._centre = {name: _mean(values) for name, values in nominal.items()}
        self._noise = {
            name: _mean((values - self._centre[name]) ** 2) ** 0.5 + step(scene, name)
            for name, values in nominal.items()
        }
        self.unchanged = self.scores(unchanged)

    def of_play(self, unchanged: Outcomes, played: Outcomes, k: int) -> "_Scorer":
        """Score one of the plays in place of what was recorded."""
        touches = as_recorded(self._scene.touches, played, k)
        scene = replace(self._scene, touches=touches)
        return _Scorer(scene, self._rows, unchanged, keeps_grid=self._keeps_grid)

    def scores(self, outcomes: Outcomes) -> FloatArray:
        """Score the m chosen touches, each over all that was recorded of it; shape (b, m)."""
        total = np.tile(self._missed(outcomes), (BATCHES, 1))
        for name, played in observed(self._scene, outcomes).items():
            recorded = self._recorded[name]
            rows = self._rows & ~np.isnan(recorded) & ~np.isnan(played).all(axis=0)
            if rows.any() and (name != "grid" or self._keeps_grid):
                calm = self._calm(name, np.where(np.isnan(played), _mean(played), played))
                batches = calm[:, rows].reshape(-1, BATCHES, rows.sum())
                seen = np.broadcast_to(self._calm(name, recorded)[rows], batches.shape[1:])
                total[:, rows] += crps_ensemble(
                    seen, batches, m_axis=0, estimator="pwm", backend="numpy"
                )
        return np.asarray(total[:, self._rows])

    def _calm(self, name: str, values: FloatArray) -> FloatArray:
        """Take values in units of the noise, and by their logarithm once they are far off.

        Any scale leaves a score proper; this one keeps wide cells from drowning narrow ones, and
        one touch far off from drowning the others.
        """
        return np.arcsinh((values - self._centre[name]) / self._noise[name])

    def _missed(self, outcomes: Outcomes) -> FloatArray:
        """Minus the logarithm of the share of touches on a path that fared like each; (n,)."""
        touches = self._scene.touches
        score = np.zeros(len(touches))
        for path in InputPath:
            on_path = touches.path == path
            if on_path.any():
                share = float(np.mean(~outcomes.ok[:, on_path]))
                share = min(max(share, NEVER_LOST), 1.0 - NEVER_LOST)
                score[on_path] = -np.log1p(-share)
                score[on_path & touches.missed] = -np.log(share)
        return score


def _mean(values: FloatArray) -> FloatArray:
    """Mean over the replicates that have one, else 0; shape (n,)."""
    known = ~np.isnan(values)
    return np.asarray(np.where(known, values, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1))


def _widened(finding: Finding, best: Scored, told: Sequence[Separation]) -> Finding:
    """Give the finding its model, and with it all that is not told from that."""
    groups = [_group(finding, best, told, position) for position in range(len(best.ids))]
    return replace(
        finding,
        model=best,
        alternatives=tuple(names for names, _ in groups),
        confidences=tuple(confidence for _, confidence in groups),
    )


def _group(
    finding: Finding, best: Scored, told: Sequence[Separation], position: int
) -> tuple[tuple[str, ...], float]:
    """Name what would do as well as one effect, and how sure the group is.

    What the finding says of the effect already is kept; the rest adds its weight.
    """
    own = best.ids[position]
    was = finding.model.ids if finding.model else ()
    before: tuple[str, ...] = ()
    sure = 0.0
    if own in was:
        before = finding.alternatives[was.index(own)]
        sure = finding.confidences[was.index(own)]
    tied = {name for s in told if not s.is_told for name in _instead(best, s.rival, position)}
    group = (*before, *sorted(tied - {own, *before}))
    counted = {own, *before} if own in was else set()
    scores = np.array([model.score for model in finding.ranking])
    weights = np.exp(TEMPER * (scores - scores.max()))
    names = [_instead(best, model, position) or {own} for model in finding.ranking]
    is_new = [bool(name & ({own, *group} - counted)) for name in names]
    return group, min(1.0, sure + float(weights[is_new].sum() / weights.sum()))


def _instead(best: Scored, rival: Scored, position: int) -> set[str]:
    """Name what a rival has in place of one effect, if it has all the others."""
    others = {name for i, name in enumerate(best.ids) if i != position}
    if len(rival.ids) != len(best.ids) or not others <= set(rival.ids):
        return set()
    return set(rival.ids) - others - {best.ids[position]}
