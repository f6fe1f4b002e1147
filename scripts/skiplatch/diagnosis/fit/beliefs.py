"""What is believed of the rig is uncertain: fitted along with every hypothesis, none included.

A belief moves within its standard uncertainty, by the likelihood of the touches and its own normal
distribution. What it can take up is no effect: an effect counts by what it gains beyond that.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import SECTIONS, Kind, Nominal
from skiplatch.simulator.effects import parameter_of

Key = tuple[str, str]

NOISE_U = 0.35
"""Relative standard uncertainty of a noise without one: as from five touches (GUM, table E.1)."""
SCAN_PERIOD: Key = ("plc", "scan_us")
LOBES: Key = ("probe", "lobe_um")
REPEATABILITY: Key = ("probe", "repeatability_um")
LOBES_U = 0.05
"""Relative standard uncertainty of the lobes where none is given: no calibration is better."""
NOISE: Mapping[Kind, tuple[Key, ...]] = {
    Kind.MACHINE: (REPEATABILITY, ("skip", "jitter_us"), ("report", "jitter_us")),
    Kind.BENCH: (("bench", "reference_jitter_us"), ("skip", "jitter_us"), ("report", "jitter_us")),
}
BOXES: Mapping[Key, Key] = {
    ("skip", "jitter_us"): ("skip", "latency_us"),
    ("report", "jitter_us"): ("report", "latency_us"),
}
"""Delays that a jitter comes on top of, from 0 up."""


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
