"""How far a stranger is from all that the catalogue can do, in figures.

A stranger that some effect fits would be named, and rightly: naming the form by which it was drawn
would be asking for a word. So it has to be apart from every effect: what the nearest one leaves is
a good part of it, and shows in the noise of the touches that are recorded.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from tests.withheld.chain import FloatArray, Setup
from tests.withheld.grammar_nearest import datum, groups
from tests.withheld.grammar_places import Seen

LEAST_NATS = 30.0
"""As much as an effect needs to count as one that shows."""
LEAST_SHARE = 0.2
"""Of its mean square: below it the nearest effect takes more than half of its size away."""
LEAST_SCATTER_SHARE = 0.1
RECORDED = 2 / 3
"""Of the touches; the others are held back."""
NONE_OF_ALL = "none"


@dataclass(frozen=True)
class Apart:
    """How far a stranger is from the catalogue.

    Attributes:
        nearest: The effect that comes nearest.
        share: Of the stranger that this one leaves; 1 is all of it.
        nats: By which what is left shows in the noise.
    """

    nearest: str
    share: float
    nats: float
    least_share: float

    @property
    def is_far(self) -> bool:
        """No effect of the catalogue stands for it."""
        return self.nats >= LEAST_NATS and self.share >= self.least_share


def size_of_shift(setup: Setup, seen: Seen, shift: FloatArray) -> float:
    """Root mean square of a shift, shape (n,), in spreads, without what the datum takes up."""
    return float(np.sqrt(np.mean(_left(setup, seen, shift, None) ** 2)))


def shift_apart(setup: Setup, seen: Seen, shift: FloatArray) -> Apart:
    """Hold a shift in the unit of its place, shape (n,), against every effect."""
    whole = np.sum(_left(setup, seen, shift, None) ** 2)
    left = {
        name: float(np.sum(_left(setup, seen, shift, columns) ** 2))
        for name, columns in groups(setup, seen.observable).items()
    }
    left[NONE_OF_ALL] = float(whole)
    nearest = min(left, key=lambda name: left[name])
    share = left[nearest] / max(float(whole), 1e-12)
    return Apart(nearest, share, 0.5 * RECORDED * left[nearest], LEAST_SHARE)


def _left(setup: Setup, seen: Seen, shift: FloatArray, columns: FloatArray | None) -> FloatArray:
    """What a fit leaves of a shift in the touches where it is seen, in spreads."""
    constant = datum(setup) if seen.observable == "length" else np.ones((len(shift), 1))
    design = constant if columns is None else np.hstack([constant, columns])
    scaled = design[seen.rows] / seen.noise[seen.rows][:, None]
    scaled = scaled / np.maximum(np.linalg.norm(scaled, axis=0), 1e-12)
    wanted = (seen.factor * shift / seen.noise)[seen.rows]
    found = np.linalg.lstsq(scaled, wanted, rcond=1e-9)[0]
    return np.asarray(wanted - scaled @ found)


def scatter_apart(setup: Setup, seen: Seen, sigma: FloatArray) -> Apart:
    """Hold a scatter of σ in the unit of its place, shape (n,), against scatter of one kind.

    Scatter of lengths is the same for every touch (`encoder_quantisation`), scatter of times goes
    with the speed (`servo_hold`, jitter of all kinds).
    """
    more = ((seen.factor * sigma / seen.noise) ** 2)[seen.rows]
    kinds = [np.ones(len(sigma))]
    if seen.observable == "length":
        kinds.append(setup.feed_um_us)
    columns = np.stack([(kind / seen.noise)[seen.rows] ** 2 for kind in kinds], axis=1)
    weight = 1.0 / (1.0 + more)
    found = nnls(columns * weight[:, None], more * weight)[0]
    whole = _divergence(1.0 + more)
    left = _divergence((1.0 + more) / (1.0 + columns @ found))
    share = left / max(whole, 1e-12)
    return Apart("scatter of one kind", share, RECORDED * left, LEAST_SCATTER_SHARE)


def _divergence(ratio: FloatArray) -> float:
    """Kullback–Leibler divergence of Gaussians whose variances have these ratios, summed."""
    return float(np.sum(0.5 * (ratio - 1.0 - np.log(ratio))))


def share_apart(seen: Seen, often: FloatArray) -> Apart:
    """Hold shares of touches that something befalls, shape (n,), against an even share."""
    often = often[seen.rows]
    even = float(np.mean(often))
    return Apart("the same at every touch", 1.0, RECORDED * _information(often, even), 0.0)


def _information(often: FloatArray, even: float) -> float:
    """Kullback–Leibler divergence of shares from an even one, summed."""
    often, even = np.clip(often, 1e-9, 1 - 1e-9), float(np.clip(even, 1e-9, 1 - 1e-9))
    gain = often * np.log(often / even) + (1 - often) * np.log((1 - often) / (1 - even))
    return float(np.sum(gain))
