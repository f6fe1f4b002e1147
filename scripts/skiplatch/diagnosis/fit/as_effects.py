"""Fitted effects as the simulator takes them."""

import numpy as np

from skiplatch.diagnosis.candidates.first_axis import within_ratio
from skiplatch.diagnosis.candidates.simulated import Simulated, admitted_values
from skiplatch.diagnosis.candidates.surrogates import SWITCHES, highest, turn_of
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.simulator.effects import Effect, effects

DIGITS = 15
"""A tick that is a hair longer keeps no grid over days: 1e12 µs are known to a hundredth."""


def as_effects(fit: Fit) -> list[Effect]:
    """Give fitted effects as the simulator takes them."""
    found = []
    for candidate, values in zip(fit.candidates, fit.parameters, strict=True):
        parameters = dict(zip(candidate.names, map(float, values), strict=True))
        admitted = (
            admitted_values(effects()[candidate.id], values)
            if isinstance(candidate, Simulated)
            else _admitted(candidate.id, within_ratio(candidate.id, parameters))
        )
        found.append(Effect(candidate.id, admitted, candidate.span))
    return found


def _admitted(effect_id: str, parameters: dict[str, float]) -> dict[str, float]:
    """Bring parameters into their ranges; a negative amplitude is half a period of phase."""
    for amplitude, phase, half_turn in (
        ("amplitude_um", "azimuth_deg", 60.0),
        ("amplitude_um", "phase_deg", 180.0),
        ("amplitude2_um", "phase2_deg", 180.0),
        ("amplitude3_um", "phase3_deg", 180.0),
    ):
        if parameters.get(amplitude, 0.0) < 0.0 and phase in parameters:
            parameters[amplitude] *= -1.0
            parameters[phase] += half_turn
    admitted = {}
    for parameter in effects()[effect_id].parameters:
        value = parameters[parameter.name]
        if turn := turn_of(parameter):
            value = (value % turn or turn) if value else 0.0  # 0 may be anywhere, a turn is not
        elif parameter.name in SWITCHES:
            value = float(np.rint(value))
        elif parameter.low >= 0.0:
            value = abs(value)
        high = highest(effect_id, parameter)
        admitted[parameter.name] = float(np.clip(rounded(value), parameter.low, high))
    return admitted


def rounded(value: float) -> float:
    """Round to the digits that are known."""
    return float(f"{value:.{DIGITS}g}")
