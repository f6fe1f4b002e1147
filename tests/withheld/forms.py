"""What a form of an effect is, and what its maker draws from."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from skiplatch.campaign import Axis
from tests.withheld.chain import FloatArray, Hook, Numbers, Setup, State, Step

BENCH = "bench"
MACHINE = "machine"


@dataclass(frozen=True)
class Form:
    """One form of an effect, with its parameters drawn.

    Attributes:
        words: The parameters in words, with units.
        hooks: What it does behind the steps of the chain.
        delay_s: How much later each move starts, if the effect lies in the choice of the moments;
            shape (n,).
        own_size: How far the outcomes are from nominal, where comparing two plays cannot say.
    """

    words: str
    hooks: Mapping[Step, Hook] = field(default_factory=dict)
    delay_s: FloatArray | None = None
    own_size: float = 0.0


@dataclass(frozen=True, eq=False)
class Draw:
    """What a maker of forms draws from.

    Attributes:
        rng: For parameters only.
        setup: The rig and its touches.
        size: How strong, about in units of the nominal spread of what the effect shifts; 1 is
            faint and 30 cannot be overlooked.
    """

    rng: np.random.Generator
    setup: Setup
    size: float

    @property
    def noise_um(self) -> float:
        """Nominal spread of a skip touch's deviation, the median over the touches."""
        nominal = self.setup.nominal
        jitter_um = self.setup.feed_um_us * nominal.skip.jitter_us
        variance = (jitter_um**2 + nominal.axis.resolution_um**2) / 12
        return float(np.median(np.sqrt(variance + nominal.probe.repeatability_um**2)))

    @property
    def amount_um(self) -> float:
        """A length of the drawn size."""
        return self.size * self.noise_um

    @property
    def amount_us(self) -> float:
        """A time of the drawn size: what the fast touches make a deviation of that size of."""
        fast = float(np.quantile(self.setup.feed_um_us, 0.9))
        own = self.setup.nominal.skip.jitter_us + self.setup.nominal.skip.tick_us
        return self.size * (own if self.setup.on_bench else max(own, self.noise_um / fast))

    def often(self) -> float:
        """Of how many touches something happens that happens now and then."""
        return float(np.clip(0.02 * self.size ** self.between(0.2, 0.9), 0.02, 0.4))

    def sense(self) -> float:
        """A sense."""
        return 1.0 if self.rng.random() < 0.5 else -1.0

    def angle(self) -> float:
        """A phase in rad."""
        return self.between(0.0, 2 * np.pi)

    def between(self, low: float, high: float) -> float:
        """Draw evenly."""
        return float(self.rng.uniform(low, high))

    def pick(self, *values: float) -> float:
        """Draw one of the values."""
        return values[int(self.rng.integers(len(values)))]

    def spell(self) -> "Spell":
        """Draw when things go badly."""
        mean_gap_s = float(self.setup.touches.time_s[-1]) / len(self.setup.touches)
        period = mean_gap_s * self.between(15.0, 60.0)
        return Spell(period, self.between(0.25, 0.5), self.angle())


@dataclass(frozen=True)
class Spell:
    """Bad times that come back, unevenly."""

    period_s: float
    share: float
    phase: float

    def holds(self, s: State) -> FloatArray:
        """Give 1 in bad times and 0 in good ones; shape (n,)."""
        turns = s.touches.time_s / self.period_s + 0.3 * np.sin(s.touches.time_s / self.period_s)
        return ((turns + self.phase) % 1.0 < self.share).astype(float)

    def words(self) -> str:
        """Describe them."""
        return f"in spells of about {self.share * self.period_s:.0f} s every {self.period_s:.0f} s"


Maker = Callable[[Draw], Form]
Amount = Callable[[State], Numbers]


def adds(name: str, amount: Amount | float) -> Hook:
    """Add to an array of the state, by its name."""

    def hook(s: State) -> None:
        more = amount(s) if callable(amount) else amount
        setattr(s, name, getattr(s, name) + more)

    return hook


def scales(name: str, factor: Amount | float) -> Hook:
    """Multiply an array of the state, by its name."""

    def hook(s: State) -> None:
        times = factor(s) if callable(factor) else factor
        setattr(s, name, getattr(s, name) * times)

    return hook


def errs(error: Amount) -> Mapping[Step, Hook]:
    """Err along the approach, in µm."""
    return {Step.POSITION: adds("deviation_um", error)}


def axis_errs(error: Amount) -> Mapping[Step, Hook]:
    """Err in the axis's coordinate, in µm: along the approach that has the sign of the motion."""
    return errs(lambda s: s.sign * error(s))


def now_and_then(share: float, late: Amount) -> Amount:
    """Be late on some touches, each by itself."""
    return lambda s: (s.rng.random(s.n) < share) * late(s)


def in_spells(spell: Spell, share: float, late: Amount) -> Amount:
    """Be late on some touches of the bad times, and hardly ever in the good ones."""

    def amount(s: State) -> Numbers:
        bad = spell.holds(s)
        often: Numbers = min(share / spell.share, 0.9) * bad + 0.05 * share * (1 - bad)
        return (s.rng.random(s.n) < often) * late(s)

    return amount


def gamma(shape: float, mean: float) -> Amount:
    """Draw times from a gamma distribution."""
    return lambda s: s.rng.gamma(shape, mean / shape, s.n)


def uniform(low: float, high: float) -> Amount:
    """Draw times evenly."""
    return lambda s: s.rng.uniform(low, high, s.n)


def long_tailed(mean: float, sigma: float) -> Amount:
    """Draw times from a lognormal distribution."""
    return lambda s: mean * np.exp(s.rng.normal(-(sigma**2) / 2, sigma, s.n))


def per_axis(x: float, y: float, z: float) -> Amount:
    """Give a value for each axis."""

    def amount(s: State) -> FloatArray:
        return np.select([s.touches.axis == Axis.X, s.touches.axis == Axis.Y], [x, y], z)

    return amount


def per_axis_about(draw: Draw, mean: float, rest: float = 0.0) -> tuple[Amount, str]:
    """Give each axis a value of its own about the mean; Z may have another one."""
    x, y = mean * draw.between(0.6, 1.4), mean * draw.between(0.6, 1.4)
    return per_axis(x, y, rest), f"X {x:.3g}, Y {y:.3g}, Z {rest:.3g}"
