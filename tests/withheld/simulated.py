"""Campaigns played by skiplatch's own simulator, for the baselines to compare with and learn from.

The parameters are drawn over the whole range of the simulator's table, whatever effects that has,
and kept if the effect then shows and is not absurd.
"""

from collections.abc import Mapping

import numpy as np

from skiplatch.campaign import Nominal, Status, Touches
from skiplatch.simulator.effects import Effect, Parameter, effects
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from tests.withheld.chain import FloatArray
from tests.withheld.streams import Expected, begin_us, residuals

SMALLEST, LARGEST = 0.3, 100.0
"""Sizes that are kept, in units of the spread that the engineer expects."""
DECADES = 5.0  # below the end of its range that a parameter may lie
TRIES = 30
SHOWN_LOST = 0.005


def play_once(
    nominal: Nominal, touches: Touches, switched_on: list[Effect], seed: int, replicates: int = 1
) -> Outcomes:
    """Play touches with effects; outcomes of the shape (replicates, n)."""
    controller = Controller.for_campaign(nominal, touches)
    return play(
        nominal, controller, touches, seed=seed, replicates=replicates, switched_on=switched_on
    )


def draw_effect(
    rng: np.random.Generator, effect_id: str, nominal: Nominal, touches: Touches
) -> Effect | None:
    """Draw an effect that shows on these touches, or None if it does not show at all."""
    seed = int(rng.integers(2**31))
    expected = Expected.of(nominal, touches)
    without = _residuals(expected, play_once(nominal, touches, [], seed))
    for _ in range(TRIES):
        effect = Effect(effect_id, _parameters(rng, effect_id))
        played = play_once(nominal, touches, [effect], seed)
        if SMALLEST <= _size(expected, without, _residuals(expected, played)) <= LARGEST:
            return effect
    return None


def _parameters(rng: np.random.Generator, effect_id: str) -> dict[str, float]:
    return {p.name: _value(rng, p) for p in effects()[effect_id].parameters}


def _value(rng: np.random.Generator, parameter: Parameter) -> float:
    """Draw an angle evenly, a share mostly small, and anything else by its magnitude."""
    low, high = parameter.low, parameter.high
    if parameter.unit == "deg":
        return float(rng.uniform(low, high))
    if parameter.unit == "1":
        return float(low + (high - low) * rng.random() ** 2)
    magnitude = high * 10.0 ** -rng.uniform(0.0, DECADES)
    sign = -1.0 if low < 0.0 and rng.random() < 0.5 else 1.0
    return float(np.clip(sign * magnitude, low, high))


def _residuals(expected: Expected, outcomes: Outcomes) -> Mapping[str, FloatArray]:
    return residuals(expected, outcomes, expected.contact_us)


def _size(
    expected: Expected, without: Mapping[str, FloatArray], with_it: Mapping[str, FloatArray]
) -> float:
    """Root mean square change in the stream that changes most, in units of its spread."""
    lost = np.isnan(with_it["deviation"]).mean()
    sizes = [100.0 * SMALLEST * float(lost)] if lost > SHOWN_LOST else [0.0]
    for stream in ("latch", "deviation", "report"):
        change = (with_it[stream] - without[stream]) / expected.spreads[stream]
        known = change[~np.isnan(change)]
        sizes.append(float(np.sqrt(np.mean(known**2))) if known.size else 0.0)
    return max(sizes)


def as_recorded(touches: Touches, outcomes: Outcomes) -> Touches:
    """Write the outcomes of the first play into the touches."""
    columns = touches.columns()
    for name in ("edge_us", "latch_us", "report_us", "deviation_um"):
        columns[name] = getattr(outcomes, name)[0]
    lost = np.isnan(outcomes.deviation_um[0])
    columns["status"] = np.where(lost, Status.MISSED, Status.OK)
    return Touches.from_columns(**columns)


def recorded_residuals(nominal: Nominal, touches: Touches) -> Mapping[str, FloatArray]:
    """Residuals of a recorded campaign by stream, shape (n,), in units of the expected spread."""
    expected = Expected.of(nominal, touches)
    found = residuals(expected, touches, begin_us(expected, touches))
    return {stream: found[stream] / expected.spreads[stream] for stream in found}
