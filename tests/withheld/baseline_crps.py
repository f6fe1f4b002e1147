"""Baseline: the effect whose simulation lowers the CRPS most."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from scoringrules import crps_ensemble  # type: ignore[import-untyped]

from skiplatch.campaign import Campaign, Touches
from skiplatch.simulator.effects import Effect, Parameter, effects
from tests.withheld.chain import FloatArray
from tests.withheld.heldout import pooled
from tests.withheld.simulated import play_once
from tests.withheld.streams import Expected, Outcomes, begin_us, cells, residuals

STREAMS = ("latch", "deviation", "report")
REPLICATES = 20
MOST_TOUCHES = 200
MOST_POOLED = 100  # plays that a touch of the PLC is scored against
VALUES = {1: 7, 2: 4, 3: 3}
"""Values of each parameter on the grid, by their number."""
MOST_GRIDDED = 3  # parameters; the others stay at 0
FINER = (0.4, 0.63, 1.0, 1.6, 2.5)
DECADES = 4.0
CLEAR = 4.0
"""Standard errors by which the score has to fall: of about 300 tries one reaches 3 by chance."""
SEED = 7


class LowestCrps:
    """Simulates every effect at a grid of parameters, then finer about the best of all."""

    title = "lowest CRPS"

    def name(self, campaign: Campaign) -> str | None:
        """Name the effect, or None."""
        scorer = _Scorer(campaign)
        unchanged = scorer.scores([])
        tried = [(scorer.scores([e]), e) for effect_id in effects() for e in _grid(effect_id)]
        best = min(tried, key=lambda one: one[0].mean())
        finer = [(scorer.scores([e]), e) for e in _finer(best[1])]
        scores, effect = min([best, *finer], key=lambda one: one[0].mean())
        fall = unchanged - scores
        error = float(fall.std(ddof=1)) / np.sqrt(len(fall))
        return effect.id if fall.mean() > CLEAR * error else None


class _Scorer:
    """Scores simulations of one campaign, or of some of its touches."""

    def __init__(self, campaign: Campaign) -> None:
        rows = np.random.default_rng(SEED).permutation(len(campaign.touches))[:MOST_TOUCHES]
        self.nominal = campaign.nominal
        self.touches: Touches = campaign.touches.select(np.sort(rows))
        self.expected = Expected.of(self.nominal, self.touches)
        self.cells = cells(self.touches)
        found = self._in_spreads(self.touches, begin_us(self.expected, self.touches))
        self.found = {stream: values for stream, values in found.items() if _any(values)}

    def scores(self, switched_on: list[Effect]) -> FloatArray:
        """CRPS of every touch, shape (n,), summed over what was recorded, in spreads."""
        outcomes = play_once(self.nominal, self.touches, switched_on, SEED, REPLICATES)
        begin = self.expected.contact_us if self.expected.machine else outcomes.edge_us
        played = self._in_spreads(outcomes, begin)
        rng = np.random.default_rng(SEED)
        total = np.zeros(len(self.touches))
        for stream, seen in self.found.items():
            for rows in self.cells:
                plays = np.nan_to_num(played[stream][:, rows].T)  # a lost touch has no residual
                if self.expected.plc[rows].all():
                    plays = pooled(plays, rng, MOST_POOLED)
                scores = crps_ensemble(seen[rows], plays, estimator="pwm", backend="numpy")
                total[rows] += np.nan_to_num(scores)
        return total

    def _in_spreads(self, outcomes: Outcomes, begin: FloatArray) -> dict[str, FloatArray]:
        """Residuals by stream, shape (…, n), in units of the expected spread."""
        all_of_them = residuals(self.expected, outcomes, begin)
        return {stream: all_of_them[stream] / self.expected.spreads[stream] for stream in STREAMS}


def _any(values: FloatArray) -> bool:
    return bool((~np.isnan(values)).any())


def _grid(effect_id: str) -> Iterator[Effect]:
    parameters = effects()[effect_id].parameters
    gridded = parameters[:MOST_GRIDDED]
    axes = [_values(p, VALUES[len(gridded)]) for p in gridded]
    for values in product(*axes):
        named = zip((p.name for p in gridded), values, strict=True)
        yield Effect(effect_id, dict(named))


def _values(parameter: Parameter, count: int) -> Sequence[float]:
    """Spread values over a range: evenly for an angle or a share, else by magnitude."""
    low, high = parameter.low, parameter.high
    if parameter.unit in {"deg", "1"}:
        return [float(v) for v in np.linspace(low, high, count + 1)[:-1] + (high - low) / count / 2]
    sizes = high * 10.0 ** -np.linspace(0.5, DECADES, count)
    signs = (-1.0, 1.0) if low < 0.0 else (1.0,)
    return [float(np.clip(sign * size, low, high)) for size in sizes for sign in signs]


def _finer(effect: Effect) -> Iterator[Effect]:
    """Vary one parameter after the other about its value."""
    described = {p.name: p for p in effects()[effect.id].parameters}
    for name, value in effect.parameters.items():
        ends = described[name].low, described[name].high
        for factor in FINER:
            yield Effect(
                effect.id, {**effect.parameters, name: float(np.clip(factor * value, *ends))}
            )
