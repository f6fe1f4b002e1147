"""What is believed of the rig is uncertain: fitted along with every hypothesis, none included.

A belief moves within its standard uncertainty, by the likelihood of the touches and its own normal
distribution. What it can take up is no effect: an effect counts by what it gains beyond that.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy import optimize

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import SECTIONS, Kind, Nominal
from skiplatch.diagnosis.candidates.scan_starts import scan_periods
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.likelihood.likelihood import Likelihood, likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import parameter_of

Key = tuple[str, str]

NOISE_U = 0.35
"""Relative standard uncertainty of a noise without one: as from five touches (GUM, table E.1)."""
SCAN_PERIOD: Key = ("plc", "scan_us")
LOBES: Key = ("probe", "lobe_um")
LOBES_U = 0.05
"""Relative standard uncertainty of the lobes where none is given: no calibration is better."""
NOISE: Mapping[Kind, tuple[Key, ...]] = {
    Kind.MACHINE: (("probe", "repeatability_um"), ("skip", "jitter_us"), ("report", "jitter_us")),
    Kind.BENCH: (("bench", "reference_jitter_us"), ("skip", "jitter_us"), ("report", "jitter_us")),
}
BOXES: Mapping[Key, Key] = {
    ("skip", "jitter_us"): ("skip", "latency_us"),
    ("report", "jitter_us"): ("report", "latency_us"),
}
"""Delays that a jitter comes on top of, from 0 up."""
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


@dataclass(frozen=True, slots=True)
class Belief:
    """A number of the nominal chain that is not known exactly.

    Attributes:
        key: Its section and name in nominal.toml; of an effect believed in, its id and a parameter.
        value: What is believed.
        u: Its standard uncertainty; of noise a relative one.
        is_noise: It moves by a factor, 1 + u for each uncertainty, and so stays positive.
        box: Of a delay, the jitter on top of it and its believed size. Who has measured both knows
            the mean of them better than either: the jitter moves about its middle, and the delay
            with it.
    """

    key: Key
    value: float
    u: float
    is_noise: bool
    box: tuple[Key, float] | None = None

    @property
    def name(self) -> str:
        """As in messages and in JSON."""
        return ".".join(self.key)

    @property
    def moves(self) -> Key:
        """The number whose size it moves: of a delay beside its jitter, that jitter's."""
        return self.box[0] if self.box else self.key

    @property
    def u_absolute(self) -> float:
        """Standard uncertainty in the unit of the value."""
        if self.box:
            return self.u * self.box[1] / 2.0
        return self.u * self.value if self.is_noise else self.u

    def uncertainties(self, value: float) -> float:
        """Give by how many standard uncertainties a value is away."""
        if self.box:
            return float(np.log1p(2.0 * (self.value - value) / self.box[1]) / np.log1p(self.u))
        if self.is_noise:
            return float(np.log(value / self.value) / np.log1p(self.u))
        return (value - self.value) / self.u

    def moved(self, uncertainties: float) -> float:
        """Give the value so many standard uncertainties away."""
        if self.box:
            return self.value - (self._factor(uncertainties) - 1.0) * self.box[1] / 2.0
        if self.is_noise:
            return self.value * self._factor(uncertainties)
        return self.value + self.u * uncertainties

    def applied(self, nominal: Nominal, uncertainties: float) -> Nominal:
        """Give a chain with the belief so many standard uncertainties away."""
        if not self.box:
            return believing(nominal, {self.key: self.moved(uncertainties)})
        begins, width = value_of(nominal, self.key), value_of(nominal, self.box[0])
        wider = width * (self._factor(uncertainties) - 1.0)
        begins = max(0.0, begins - wider / 2.0)
        return believing(nominal, {self.box[0]: width + wider, self.key: begins})

    def _factor(self, uncertainties: float) -> float:
        return float((1.0 + self.u) ** uncertainties)


def uncertain(nominal: Nominal) -> list[Belief]:
    """Name the beliefs that are fitted: those with an uncertainty, all noise, and the lobes."""
    given = nominal.uncertainty
    noise = [
        key for key in NOISE[nominal.kind] if key not in given and value_of(nominal, key) > 0.0
    ]
    found = [Belief(key, value_of(nominal, key), NOISE_U, is_noise=True) for key in noise]
    lobe_um = value_of(nominal, LOBES)
    if LOBES not in given and lobe_um > 0.0:
        found.append(Belief(LOBES, lobe_um, LOBES_U * lobe_um, is_noise=False))
    for key, u in given.items():
        value = value_of(nominal, key)
        is_noise = key in NOISE[nominal.kind] and value > 0.0
        if u > 0.0:
            found.append(Belief(key, value, u / value if is_noise else u, is_noise=is_noise))
    found += [
        Belief((effect.id, name), effect.values[name], u, is_noise=False)
        for effect in nominal.believed_effects
        for name, u in effect.uncertainty.items()
        if u > 0.0
    ]
    boxes = [(BOXES[b.key], b) for b in found if b.key in BOXES]
    middles = [
        Belief(delay, value_of(nominal, delay), b.u, is_noise=True, box=(b.key, b.value))
        for delay, b in boxes
    ]
    return [*found, *middles]


def value_of(nominal: Nominal, key: Key) -> float:
    """Give what is believed now."""
    section, name = key
    if section in SECTIONS:
        return nominal.number(section, name)
    return next(e.values[name] for e in nominal.believed_effects if e.id == section)


def believing(nominal: Nominal, values: Mapping[Key, float]) -> Nominal:
    """Give the nominal chain with other values."""
    for (section, name), value in values.items():
        if section in SECTIONS:
            changed = replace(getattr(nominal, section), **{name: value})
            nominal = replace(nominal, **{section: changed})
        else:
            effects = tuple(
                replace(one, values={**one.values, name: _admitted(section, name, value)})
                if one.id == section
                else one
                for one in nominal.believed_effects
            )
            nominal = replace(nominal, believed_effects=effects)
    return nominal


def _admitted(effect_id: str, name: str, value: float) -> float:
    """Bring a parameter into its range."""
    parameter = parameter_of(effect_id, name)
    return min(max(value, parameter.low), parameter.high)


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
    scene: Scene, change: Change, beliefs: Sequence[Belief], tried: Nominal | None = None
) -> Fitted:
    """Fit beliefs to a scene under a change of the physics, one after the other, twice over.

    Args:
        scene: The touches, with the chain that the beliefs are of or with one fitted before.
        change: What differs from the nominal chain besides.
        beliefs: As they stand in nominal.toml.
        tried: Where they fit beside another change: what a search may start from as well.
    """
    places, moves = np.zeros(len(beliefs)), _Moves(scene, change, beliefs, tried)
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


class _Moves:
    """Where beliefs are moved to, in standard uncertainties: arrays of shape (beliefs,)."""

    def __init__(
        self, scene: Scene, change: Change, beliefs: Sequence[Belief], tried: Nominal | None
    ) -> None:
        self._scene, self._change, self._beliefs, self._tried = scene, change, beliefs, tried

    def nominal_at(self, places: FloatArray) -> Nominal:
        nominal = self._scene.nominal
        for belief, uncertainties in zip(self._beliefs, places.tolist(), strict=True):
            nominal = belief.applied(nominal, uncertainties)
        return nominal

    def at(self, places: FloatArray, names: frozenset[str] | None = None) -> Likelihood:
        return likelihood(self._scene.with_nominal(self.nominal_at(places)), self._change, names)

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
        return np.where(own, best if cost(best) < cost(0.0) - WORTH_MOVING else 0.0, places)


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
    found = optimize.minimize_scalar(
        cost, bounds=bounds, method="bounded", options={"xatol": CLOSE * reach}
    )
    return float(found.x)
