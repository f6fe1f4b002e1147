"""Touches that could be made: drawn about the conditions of a campaign."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Touches
from skiplatch.diagnosis.experiment.surfaces import (
    LEAST_APPROACH_MM,
    NARROW_POSITIONS_MM,
    by_places,
    longest_approach_mm,
    room_before_mm,
    touched,
)
from skiplatch.units import S_PER_MIN

FEATURES = ("path", "feed", "surface", "sense", "position", "rotary", "approach", "rest")
FEEDS = 4
NARROW_FEEDS = 4.0  # greatest over least; below, slower feeds are tried too
NARROW_APPROACHES = 2.0
LONGEST_TRAVEL_S = 1.0
NEAREST_MM = 0.5
SWEEP_MM = 50.0  # to either side, where the campaign kept to one position
QUARTER_TURNS_DEG = np.array([0.0, 90.0, 180.0, 270.0])
FEWEST_FOR_RESTS = 3
USUAL_RESTS_S = (2.0, 20.0)
SHORTEST_REST_S = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """Touches to be made one after the other.

    Attributes:
        touches: The conditions of n touches, timed.
        rest_s: From the contact of the touch before to the start of each; shape (n,).
    """

    touches: Touches
    rest_s: FloatArray

    def chosen(self, rows: NDArray[np.intp]) -> "Conditions":
        """Give some of the touches, timed anew in the order of `rows`; some may stand twice."""
        return timed(self.touches.select(rows), self.rest_s[rows])

    def brief(self) -> "Conditions":
        """Let slow touches begin near the surface: they take less time, here and on the rig."""
        near_mm = self.touches.feed_mm_min / S_PER_MIN * LONGEST_TRAVEL_S
        approach_mm = np.minimum(self.touches.approach_mm, np.maximum(near_mm, NEAREST_MM))
        return timed(replace(self.touches, approach_mm=approach_mm), self.rest_s)

    def warming(self, by_k: float) -> "Conditions":
        """Give the same touches while the machine warms up: at one temperature it is a datum."""
        rise_k = np.linspace(0.0, by_k, len(self.touches))
        return Conditions(replace(self.touches, temp_c=self.touches.temp_c + rise_k), self.rest_s)


def travel_s(touches: Touches) -> FloatArray:
    """Give how long each approach takes at the feed; shape (n,)."""
    return touches.approach_mm / touches.feed_mm_min * S_PER_MIN


def timed(touches: Touches, rest_s: FloatArray) -> Conditions:
    """Number the touches, and let each begin so long after the one before reached the surface."""
    reached_s = np.concatenate([[0.0], np.cumsum(travel_s(touches) + rest_s)[:-1]])
    times_s = np.round(reached_s + rest_s, 3)
    return Conditions(replace(touches, touch=np.arange(len(touches)), time_s=times_s), rest_s)


def rests_s(touches: Touches) -> FloatArray:
    """Give how long the axis is free before each of timed touches; shape (n,)."""
    reached_s = touches.time_s + travel_s(touches)
    return np.asarray(touches.time_s - np.concatenate([[0.0], reached_s[:-1]]))


def spread_out(
    recorded: Touches,
    count: int,
    rng: np.random.Generator,
    reach_mm: tuple[float, float] = (-np.inf, np.inf),
) -> Conditions:
    """Draw touches of the surfaces of a campaign, every feature independent of the others.

    Nothing leaves the range of what was recorded to where a rig might not follow, but for what
    any rig can do: a slower feed, a shorter approach. A feature of which nothing was recorded
    stays so. Starts of approaches lie within `reach_mm`, surfaces where any was touched there.
    """
    shares = _shares(count, rng)
    rows = _picked(touched(recorded, reach_mm), shares["surface"])
    return _made(recorded, shares, by_places(recorded).select(rows), reach_mm)


def elsewhere(
    recorded: Touches, count: int, rng: np.random.Generator, reach_mm: tuple[float, float]
) -> Conditions:
    """Draw the same of surfaces that there may be, too: of the opposite sense, at other places."""
    shares = _shares(count, rng)
    surfaces = recorded.select(_picked(np.arange(len(recorded)), shares["surface"]))
    flipped = (shares["sense"] < 0.5) & (surfaces.axis != Axis.Z)  # nothing is probed from below
    surfaces = replace(
        surfaces,
        sign=np.where(flipped, -1.0, 1.0) * surfaces.sign,
        alpha_deg=(surfaces.alpha_deg + np.where(flipped, 180.0, 0.0)) % 360.0,
        position_mm=_positions(recorded, shares["position"], reach_mm),
        rotary_deg=_picked(_angles(recorded), shares["rotary"]),
        session=np.zeros(count, dtype=np.int64),
        session_names=("",),
    )
    return _made(recorded, shares, surfaces, reach_mm)


def _shares(count: int, rng: np.random.Generator) -> dict[str, FloatArray]:
    """Give a share from 0 to 1 for each feature of each touch, by a Latin hypercube.

    Each feature alone is spread evenly.
    """
    drawn = scipy.stats.qmc.LatinHypercube(len(FEATURES), rng=rng).random(count).T
    return dict(zip(FEATURES, drawn, strict=True))


def _made(
    recorded: Touches,
    shares: dict[str, FloatArray],
    surfaces: Touches,
    reach_mm: tuple[float, float],
) -> Conditions:
    """Give touches of n surfaces; how they are made is drawn by the shares."""
    count = len(surfaces)
    longest_mm = longest_approach_mm(recorded, surfaces)
    approach_mm = np.minimum(_approaches(recorded, shares["approach"]), longest_mm)
    touches = Touches.from_columns(
        touch=np.arange(count),
        time_s=np.zeros(count),
        path=_picked(np.unique(recorded.path), shares["path"]),
        axis=surfaces.axis,
        sign=surfaces.sign,
        alpha_deg=surfaces.alpha_deg,
        beta_deg=surfaces.beta_deg,
        feed_mm_min=_picked(_feeds(recorded), shares["feed"]),
        approach_mm=_within(approach_mm, surfaces.position_mm, surfaces.sign, reach_mm),
        position_mm=surfaces.position_mm,
        rotary_deg=surfaces.rotary_deg,
        temp_c=np.full(count, _median(recorded.temp_c)),
        session=surfaces.session,
        session_names=surfaces.session_names,
    )
    return timed(touches, _rests(recorded, shares["rest"]))


def _picked(levels: NDArray[Any], shares: FloatArray) -> NDArray[Any]:
    """Turn shares from 0 to 1 into levels, each as often as the others; shape of `shares`."""
    picked: NDArray[Any] = levels[(shares * len(levels)).astype(np.intp)]
    return picked


def _feeds(recorded: Touches) -> FloatArray:
    low, high = recorded.feed_mm_min.min(), recorded.feed_mm_min.max()
    if high < NARROW_FEEDS * low:
        low = high / (2.0 * NARROW_FEEDS)
    return np.array([float(f"{feed:.3g}") for feed in np.geomspace(low, high, FEEDS)])


def _approaches(recorded: Touches, shares: FloatArray) -> FloatArray:
    low, high = recorded.approach_mm.min(), recorded.approach_mm.max()
    if high < NARROW_APPROACHES * low:
        low = high / (2.0 * NARROW_APPROACHES)
    return np.asarray(np.maximum(np.round(low * (high / low) ** shares, 2), LEAST_APPROACH_MM))


def _within(
    approach_mm: FloatArray,
    position_mm: FloatArray,
    sign: FloatArray,
    reach_mm: tuple[float, float],
) -> FloatArray:
    """Shorten approaches that would begin out of reach; `touched` says when reach is no limit."""
    room_mm = np.round(room_before_mm(position_mm, sign, reach_mm), 3)
    return np.where(room_mm >= LEAST_APPROACH_MM, np.minimum(approach_mm, room_mm), approach_mm)


def _positions(recorded: Touches, shares: FloatArray, reach_mm: tuple[float, float]) -> FloatArray:
    known = recorded.position_mm[~np.isnan(recorded.position_mm)]
    if not known.size:
        return np.full(len(shares), np.nan)
    low, high = known.min(), known.max()
    if high - low < NARROW_POSITIONS_MM:
        low, high = low - SWEEP_MM, high + SWEEP_MM
    least, most = reach_mm[0] + LEAST_APPROACH_MM, reach_mm[1] - LEAST_APPROACH_MM
    low, high = np.clip([low, high], least, max(least, most))
    return np.asarray(np.round(low + (high - low) * shares, 2))


def _angles(recorded: Touches) -> FloatArray:
    known = np.unique(recorded.rotary_deg[~np.isnan(recorded.rotary_deg)])
    if not known.size:
        return np.array([np.nan])
    return known if known.size > 1 else (known + QUARTER_TURNS_DEG) % 360.0


def _median(values: FloatArray) -> float:
    known = values[~np.isnan(values)]
    return float(np.median(known)) if known.size else float("nan")


def _rests(recorded: Touches, shares: FloatArray) -> FloatArray:
    """Draw rests as they were between the recorded touches, evenly in their logarithm."""
    low, high = USUAL_RESTS_S
    if len(recorded) >= FEWEST_FOR_RESTS:
        low, high = np.quantile(rests_s(recorded.in_order_of_time())[1:], [0.1, 0.9])
    low = max(low, SHORTEST_REST_S)
    return np.asarray(np.round(low * (max(high, low) / low) ** shares, 1))
