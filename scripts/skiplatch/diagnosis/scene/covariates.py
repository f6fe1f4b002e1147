"""What a touch could depend on: what was recorded of it, and what the sequence of touches makes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray, is_varied
from skiplatch.campaign.column_kinds import NOT_RECORDED
from skiplatch.diagnosis.scene.nominal_chain import LOBES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.units import DEG_PER_TURN

CYCLES = (2, 3, 4, 5, 6, 7, 8, 10, 12)
"""Touches after which a cycle in the sequence that is looked for comes back."""
LAGS = (1, 2, 3, 4, 5, 6, 7, 8)
"""Touches back at which the score of another one may tell something."""
LEFT = "what is left"
WITHIN = f"{LEFT} within"
DIRECTIONS = ("axis", "sense", "azimuth", "elevation", "direction", "turn since")
"""Begin of the names of covariates that say where a probe points."""
MADE_OF: Mapping[str, tuple[str, ...]] = {
    "time_s": ("time", "rest ", "touches in the "),
    "feed_mm_min": ("feed",),
    "approach_mm": ("approach",),
    "alpha_deg": ("azimuth", "elevation", "direction", "turn since"),
}
"""The same of those that a column makes."""
PAIRED = (
    *("feed", "approach", "position", "sense", "temperature", "time", "rest before"),
    *("azimuth (cosine)", "azimuth (sine)", "rotary angle (cosine)", "rotary angle (sine)"),
)
"""Conditions that may act together."""
RECENT_S = (10.0, 60.0)
"""Times over which touches are counted that were made just before."""


def conditions(scene: Scene) -> Mapping[str, FloatArray]:
    """Give what was recorded of each touch, by the name that a report has for it; shape (n,)."""
    touches = scene.touches
    alpha, rotary = np.deg2rad(touches.alpha_deg), np.deg2rad(touches.rotary_deg)
    beta = np.deg2rad(touches.beta_deg)
    found = {
        "feed": touches.feed_mm_min,
        "approach": touches.approach_mm,
        "position": touches.position_mm,
        "sense": touches.sign,
        "axis": np.where(touches.axis == NOT_RECORDED, np.nan, touches.axis),
        "path": touches.path,
        "azimuth": touches.alpha_deg % DEG_PER_TURN,
        "azimuth (cosine)": np.cos(alpha) * np.cos(beta),
        "azimuth (sine)": np.sin(alpha) * np.cos(beta),
        "azimuth within a lobe": touches.alpha_deg % (DEG_PER_TURN / LOBES),
        "elevation": touches.beta_deg,
        "rotary angle": touches.rotary_deg % DEG_PER_TURN,
        "rotary angle (cosine)": np.cos(rotary),
        "rotary angle (sine)": np.sin(rotary),
        "temperature": touches.temp_c,
        "time": touches.time_s,
        **{f"temp_{place}_c": values for place, values in touches.thermometers.items()},
    }
    return {name: np.asarray(values, dtype=float) for name, values in found.items()}


def sequence(scene: Scene) -> Mapping[str, FloatArray]:
    """Give what the touches before make of each, in order of time; shape (n,).

    NaN where the touch before was made but is not in the record.
    """
    touches, order = scene.touches, Order.of(scene)
    position = touches.position_mm
    found = {
        "serial number": order.serial.astype(float),
        "rest before": order.since(touches.time_s),
        "way since the touch before": np.abs(order.since(position)),
        "signed way since the touch before": order.since(position),
        "turn since the touch before": np.cos(np.deg2rad(order.since(touches.alpha_deg))),
        "direction of the touch before": order.back(touches.alpha_deg, 1) % DEG_PER_TURN,
        "sense of the touch before": order.back(touches.sign, 1),
        "feed of the touch before": order.back(touches.feed_mm_min, 1),
        "axis of the touch before": order.back(touches.axis.astype(float), 1),
        "path of the touch before": order.back(touches.path.astype(float), 1),
        "elevation of the touch before": order.back(touches.beta_deg, 1),
        "change of temperature": order.since(touches.temp_c),
        "touches since a change of axis": order.run(touches.axis),
        "touches since a change of path": order.run(touches.path),
        "touches since a change of sense": order.run(np.nan_to_num(touches.sign)),
        "rest since a touch of the same axis": _rest_since_same(touches.time_s, touches.axis),
        "rest since a touch of the same path": _rest_since_same(touches.time_s, touches.path),
    }
    for cycle in CYCLES:
        found[f"serial number in a cycle of {cycle}"] = order.serial % cycle
    for span_s in RECENT_S:
        begins = np.searchsorted(touches.time_s, touches.time_s - span_s)
        found[f"touches in the {span_s:g} s before"] = np.arange(len(scene)) - begins
    return {name: np.asarray(values, dtype=float) for name, values in found.items()}


def recorded_only(scene: Scene, columns: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Leave out what was not recorded, but stands in for it or was filled in.

    Lobes in unknown directions go with all that says in which direction a touch was made.
    """
    unknown = [name for column in scene.stood_in for name in MADE_OF.get(column, ())]
    prefixes = (*unknown, *(() if scene.is_directed else DIRECTIONS))
    return {name: values for name, values in columns.items() if not name.startswith(prefixes)}


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """The sequence in which touches were made, by their serial numbers; shape (n,)."""

    serial: NDArray[np.int64]

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """Take the numbers, or where they do not ascend with time the order itself."""
        serial = scene.touches.touch
        ascends = bool(np.all(np.diff(serial) > 0))
        return cls(serial - serial[0] if ascends else np.arange(len(scene)))

    def back(self, values: FloatArray, by: int) -> FloatArray:
        """Give the value so many touches before each, or after it; NaN where it is not known."""
        wanted = self.serial - by
        at = np.minimum(np.searchsorted(self.serial, wanted), len(self.serial) - 1)
        return np.where(self.serial[at] == wanted, values[at], np.nan)

    def since(self, values: FloatArray) -> FloatArray:
        """Give the difference from the touch before."""
        return np.asarray(values - self.back(values, 1))

    def run(self, values: np.ndarray) -> FloatArray:
        """Count the touches since a value changed."""
        changed = np.diff(values, prepend=values[:1]) != 0
        changed[:1] = True
        last = np.maximum.accumulate(np.where(changed, np.arange(len(values)), 0))
        return np.asarray(self.serial - self.serial[last], dtype=float)


def in_words(name: str) -> str:
    """Say what a covariate is: all scores of touches around one are the same to who measures."""
    return "the touches around it" if name.startswith(LEFT) else name


def before(order: Order, scores: FloatArray) -> Mapping[str, FloatArray]:
    """Give the scores, shape (n,), of touches before each; NaN where there is none.

    None of touches after it: who learns from both of two touches what the one tells of the other
    has seen already what he is asked.
    """
    return {f"{LEFT} {lag} touches before": order.back(scores, lag) for lag in LAGS}


def varying(columns: Mapping[str, FloatArray], rows: BoolArray) -> dict[str, FloatArray]:
    """Leave out what was not recorded or did not vary on some touches: nothing goes with that."""
    there = {name: values[rows] for name, values in columns.items()}
    return {name: values for name, values in there.items() if is_varied(values)}


def _rest_since_same(time_s: FloatArray, codes: np.ndarray) -> FloatArray:
    """Give the time since the last touch with the same code; NaN for the first of each."""
    rest = np.full(len(time_s), np.nan)
    for code in np.unique(codes):
        rows = np.flatnonzero(codes == code)
        rest[rows[1:]] = np.diff(time_s[rows])
    return rest
