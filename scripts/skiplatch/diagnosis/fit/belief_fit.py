"""Beliefs fitted along with a hypothesis: where the touches move them."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Nominal
from skiplatch.diagnosis.candidates.scan_starts import scan_periods
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.beliefs import SCAN_PERIOD, Belief, uncertain, value_of
from skiplatch.diagnosis.likelihood.likelihood import Likelihood, likelihood
from skiplatch.diagnosis.scene.scene import Scene

FARTHEST = 2.5
"""Standard uncertainties to which a belief may move; a rig beyond has a gap. Of noise, a factor of
about two either way."""
FIRST_REACH, LAST_REACH = FARTHEST, 1e-6
"""Standard uncertainties about which it is looked for, coarse to fine: an edge known to 0.2 µs
tells an acceleration to a thousandth of what a data sheet does, and stamps over an hour a period to
a millionth."""
CLOSE = 0.01
"""Share of the reach to which it is found."""
FINER = 0.04
"""Of the reach before."""
WORTH_A_CLOSER_LOOK = 0.1
"""Nats that the last one has to have gained."""
ROUNDS = 2
WORTH_MOVING = 4.0
"""Nats that a belief has to gain to move: of several one in two hundred does so by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """Beliefs where touches move them.

    Attributes:
        nominal: With the fitted values.
        moved: By so many standard uncertainties, by belief.
        nats: Log-likelihood of the touches, less what the move is unlikely by.
    """

    nominal: Nominal
    moved: Sequence[tuple[Belief, float]]
    nats: float


def fit_beliefs(
    scene: Scene,
    change: Change,
    beliefs: Sequence[Belief],
    tried: Nominal | None = None,
    names: Collection[str] | None = None,
    worth_moving: float = WORTH_MOVING,
) -> Fitted:
    """Fit beliefs to a scene under a change of the physics, one after the other, twice over.

    Args:
        scene: The touches, with the chain that the beliefs are of or with one fitted before.
        change: What differs from the nominal chain besides.
        beliefs: As they stand in nominal.toml.
        tried: Where they fit beside another change: what a search may start from as well.
        names: Of the streams that they are fitted to; all without it.
        worth_moving: Nats that a belief has to gain to move.
    """
    places = np.zeros(len(beliefs))
    moves = _Moves(scene, change, beliefs, tried, names, worth_moving)
    noise_last = sorted(  # it hides the rest, and most of all where it moves the mean
        range(len(beliefs)), key=lambda i: (beliefs[i].is_noise, beliefs[i].box is None)
    )
    for _ in range(ROUNDS if len(beliefs) > 1 else 1):
        for i in noise_last:
            places = moves.best(places, i)
        if not places.any():
            break
    nats = moves.at(places).total - 0.5 * float(places @ places)
    return Fitted(moves.nominal_at(places), [*zip(beliefs, places.tolist(), strict=True)], nats)


def beside_grid(scene: Scene, change: Change) -> float:
    """Give the nats beside the period that the stamps of the scans tell under a change."""
    belief = next(b for b in uncertain(scene.nominal) if b.key == SCAN_PERIOD)
    moves = _Moves(scene, change, [belief], None, None, WORTH_MOVING)
    places = [0.0, *(p for p in _guesses(scene, change, belief, None) if abs(p) < FARTHEST)]
    return max(moves.at(np.array([place])).total - 0.5 * place**2 for place in places)


class _Moves:
    """Where beliefs are moved to, in standard uncertainties: arrays of shape (beliefs,)."""

    def __init__(
        self,
        scene: Scene,
        change: Change,
        beliefs: Sequence[Belief],
        tried: Nominal | None,
        names: Collection[str] | None,
        worth_moving: float,
    ) -> None:
        self._scene, self._change, self._beliefs, self._tried = scene, change, beliefs, tried
        self._names, self._worth_moving = names, worth_moving

    def nominal_at(self, places: FloatArray) -> Nominal:
        nominal = self._scene.nominal
        for belief, uncertainties in zip(self._beliefs, places.tolist(), strict=True):
            nominal = belief.applied(nominal, uncertainties)
        return nominal

    def at(self, places: FloatArray, names: Collection[str] | None = None) -> Likelihood:
        moved = self._scene.with_nominal(self.nominal_at(places))
        return likelihood(moved, self._change, self._names if names is None else names)

    def best(self, places: FloatArray, i: int) -> FloatArray:
        """Move one belief to where it fits best, on top of what is moved or in place of the same.

        A jitter moves in two ways, from its start and about its middle.
        """
        own = np.arange(len(places)) == i
        same = np.array([b.moves == self._beliefs[i].moves for b in self._beliefs])
        on_top, instead = places, np.where(same & ~own, 0.0, places)
        if np.array_equal(on_top, instead):
            return self._moved(places, own, 0.0)
        others = float(places[same & ~own].sum())
        ways = self._moved(on_top, own, others), self._moved(instead, own, 0.0)
        return min(ways, key=lambda way: 0.5 * float(way @ way) - self.at(way).total)

    def _moved(self, places: FloatArray, own: BoolArray, others: float) -> FloatArray:
        """Move one belief, a mask, where others have moved the same so far already."""
        names = self.at(places).differing(self.at(np.where(own, places + 1.0, places)))

        cost = cache(lambda x: 0.5 * x**2 - self.at(np.where(own, x, places), names).total)
        ends = max(-FARTHEST, -FARTHEST - others), min(FARTHEST, FARTHEST - others)
        belief = self._beliefs[int(own.argmax())]
        best = _least(cost, _guesses(self._scene, self._change, belief, self._tried), ends)
        is_worth_it = cost(best) < cost(0.0) - self._worth_moving
        return np.where(own, best if is_worth_it else 0.0, places)


def _guesses(scene: Scene, change: Change, belief: Belief, tried: Nominal | None) -> list[float]:
    """Propose, in standard uncertainties, what a search would not come upon: a peak too sharp."""
    guesses = []
    if belief.key == SCAN_PERIOD:
        off_us = [start[0] for start in scan_periods(scene, change)]
        guesses = [(scene.nominal.plc.scan_us + off - belief.value) / belief.u for off in off_us]
    if tried is not None and not belief.box:
        guesses.append(belief.uncertainties(value_of(tried, belief.key)))
    return guesses


def _least(
    cost: Callable[[float], float], guesses: Sequence[float], ends: tuple[float, float]
) -> float:
    """Find the place of least cost, in standard uncertainties, as closely as that is worth it."""
    within = [0.0, *(guess for guess in guesses if ends[0] < guess < ends[1])]
    best = min([*within, _near(cost, 0.0, FIRST_REACH, ends)], key=cost)
    reach = FINER * FIRST_REACH
    while best and reach >= LAST_REACH:
        closer = _near(cost, best, reach, ends)
        gained = cost(best) - cost(closer)
        best = closer if gained > 0.0 else best
        if gained < WORTH_A_CLOSER_LOOK:
            break
        reach *= FINER
    return best


def _near(
    cost: Callable[[float], float], place: float, reach: float, ends: tuple[float, float]
) -> float:
    bounds = max(place - reach, ends[0]), min(place + reach, ends[1])
    found = scipy.optimize.minimize_scalar(
        cost, bounds=bounds, method="bounded", options={"xatol": CLOSE * reach}
    )
    return float(found.x)
