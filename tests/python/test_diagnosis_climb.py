"""Climbs to the likeliest parameters, and tasks that travel while others work."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.climb import climb
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.likelihood.likelihood import Likelihood, likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search import scored as gaining
from skiplatch.diagnosis.search import scorer as scoring
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
TRUE = np.array([3.0, 0.7])


class Normal:
    """Touches of a straight line with a normal scatter of 1."""

    def __init__(self) -> None:
        """Draw 200 touches."""
        rng = np.random.default_rng(1)
        self._x = rng.uniform(0.0, 10.0, 200)
        self._y = TRUE[0] + TRUE[1] * self._x + rng.normal(size=200)

    @property
    def best(self) -> FloatArray:
        """The least squares."""
        return np.polynomial.polynomial.polyfit(self._x, self._y, 1)

    def __call__(self, values: FloatArray, widening: float) -> float:
        """Give minus the log-likelihood, without what is the same for all parameters."""
        return float(np.sum((self._y - values[0] - values[1] * self._x) ** 2) / 2.0 + widening)


def test_a_climb_reaches_the_top() -> None:
    target = Normal()

    found = climb(target, np.array([2.0, 1.02]), 0.0)

    assert target(found, 0.0) < target(target.best, 0.0) + 0.1


def test_what_is_zero_stays_so() -> None:
    assert climb(Normal(), np.array([2.0, 0.0]), 0.0)[1] == 0.0


class Late(Executor):
    """Packs a task only when its result is asked for, as late as a process pool may."""

    def __init__(self) -> None:
        """Begin with nothing under way."""
        self.is_under_way = False

    def map(self, fn: Callable, *iterables: Iterable, **_: object) -> Iterator:  # type: ignore[type-arg]
        """Run tasks one by one."""
        self.is_under_way = True
        yield from map(fn, *iterables)
        self.is_under_way = False


def test_a_scene_is_not_worked_on_while_tasks_with_it_are_under_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A pool that packs a scene while what is asked of it is kept there ends in a traceback."""
    scene, pool, seen = Scene.of(read_campaign(SAMPLES / "machine_no_gap")), Late(), []

    def watched(part: Scene, change: Change, **rest: object) -> Likelihood:
        seen.append(pool.is_under_way)
        return likelihood(part, change, **rest)  # type: ignore[arg-type]

    for module in (gaining, scoring):
        monkeypatch.setattr(module, "likelihood", watched)
    judge = Judge(scene, split(len(scene), 1), executor=pool)
    late = Fit((CANDIDATES["isr_latency"],), (np.array([1.0, 0.0, 0.0]),), frozenset())
    judge.jointly([judge.score(late)] * 3)

    assert len(seen) > 5
    assert not any(seen)
