"""What is believed of the rig is uncertain: fitted along with every hypothesis, none included.

A belief moves within its standard uncertainty, by the likelihood of the touches and its own normal
distribution. What it can take up is no effect: an effect counts by what it gains beyond that.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from skiplatch.campaign import Kind, Nominal
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.likelihood import likelihood
from skiplatch.diagnosis.scene import Scene

Key = tuple[str, str]

NOISE_U = 0.3
"""Relative standard uncertainty of a noise where none is given: that of a standard deviation from
six or seven touches (GUM, table E.1)."""
LOBES: Key = ("probe", "lobe_um")
LOBES_U = 0.05
"""Relative standard uncertainty of the lobes where none is given: no calibration is better."""
NOISE: Mapping[Kind, tuple[Key, ...]] = {
    Kind.MACHINE: (("probe", "repeatability_um"), ("skip", "jitter_us"), ("report", "jitter_us")),
    Kind.BENCH: (("bench", "reference_jitter_us"), ("skip", "jitter_us"), ("report", "jitter_us")),
}
FARTHEST = 2.5
"""Standard uncertainties to which a belief may move; a rig beyond has a gap. Of noise, a factor of
about two either way."""
CLOSE = 0.02
"""Standard uncertainties to which it is fitted."""
ROUNDS = 2
WORTH_MOVING = 4.0
"""Nats that a belief has to gain to move: of several one in two hundred does so by chance."""


@dataclass(frozen=True, slots=True)
class Belief:
    """A number of the nominal chain that is not known exactly.

    Attributes:
        key: Its section and name in nominal.toml.
        value: What is believed.
        u: Its standard uncertainty; of noise a relative one.
        is_noise: It moves by a factor instead of a difference, and so stays positive.
    """

    key: Key
    value: float
    u: float
    is_noise: bool

    @property
    def name(self) -> str:
        """As in messages and in JSON."""
        return ".".join(self.key)

    @property
    def u_absolute(self) -> float:
        """Standard uncertainty in the unit of the value."""
        return self.u * self.value if self.is_noise else self.u

    def uncertainties(self, value: float) -> float:
        """Give by how many standard uncertainties a value is away."""
        if self.is_noise:
            return float(np.log(value / self.value)) / self.u
        return (value - self.value) / self.u

    def moved(self, uncertainties: float) -> float:
        """Give the value so many standard uncertainties away."""
        if self.is_noise:
            return self.value * float(np.exp(self.u * uncertainties))
        return self.value + self.u * uncertainties


def uncertain(nominal: Nominal) -> list[Belief]:
    """Name the beliefs that are fitted: those with an uncertainty, all noise, and the lobes."""
    given = getattr(nominal, "uncertainty", {})
    noise = [key for key in NOISE[nominal.kind] if key not in given and _value(nominal, key) > 0.0]
    found = [Belief(key, _value(nominal, key), NOISE_U, is_noise=True) for key in noise]
    lobe_um = _value(nominal, LOBES)
    if LOBES not in given and lobe_um > 0.0:
        found.append(Belief(LOBES, lobe_um, LOBES_U * lobe_um, is_noise=False))
    for key, u in given.items():
        value = _value(nominal, key)
        is_noise = key in NOISE[nominal.kind] and value > 0.0
        if u > 0.0:
            found.append(Belief(key, value, u / value if is_noise else u, is_noise=is_noise))
    return found


def _value(nominal: Nominal, key: Key) -> float:
    return float(getattr(getattr(nominal, key[0]), key[1]))


def believing(nominal: Nominal, values: Mapping[Key, float]) -> Nominal:
    """Give the nominal chain with other values."""
    for (section, name), value in values.items():
        changed = replace(getattr(nominal, section), **{name: value})
        nominal = replace(nominal, **{section: changed})
    return nominal


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


def fit_beliefs(scene: Scene, change: Change, beliefs: Sequence[Belief]) -> Fitted:
    """Fit beliefs to a scene under a change of the physics, one after the other, twice over.

    Args:
        scene: The touches, with the chain that the beliefs are of or with one fitted before.
        change: What differs from the nominal chain besides.
        beliefs: As they stand in nominal.toml.
    """
    places = {b.key: 0.0 for b in beliefs}

    def nominal_at(moved: Mapping[Key, float]) -> Nominal:
        return believing(scene.nominal, {b.key: b.moved(moved[b.key]) for b in beliefs})

    def nats_at(moved: Mapping[Key, float]) -> float:
        total = likelihood(scene.with_nominal(nominal_at(moved)), change).total
        return total - 0.5 * sum(x**2 for x in moved.values())

    for _ in range(ROUNDS if len(beliefs) > 1 else 1):
        for belief in beliefs:

            def cost(x: float, key: Key = belief.key) -> float:
                return -nats_at({**places, key: x})

            found = optimize.minimize_scalar(
                cost, bounds=(-FARTHEST, FARTHEST), method="bounded", options={"xatol": CLOSE}
            )
            is_moved = found.fun < cost(0.0) - WORTH_MOVING
            places[belief.key] = float(found.x) if is_moved else 0.0
    return Fitted(nominal_at(places), [(b, places[b.key]) for b in beliefs], nats_at(places))
