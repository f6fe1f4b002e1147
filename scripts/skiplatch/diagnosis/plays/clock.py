"""What runs on one clock: the scans, and what else has a phase on it."""

from dataclasses import replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Touches
from skiplatch.diagnosis.scene.grid import mean_turn
from skiplatch.simulator.effects import Effect
from skiplatch.units import DEG_PER_TURN

KEPT = 0.5
"""Mean of the stamps as turns of the scan, from which on they keep to its grid."""
FEWEST_STAMPS = 16
PERIODS = {"servo_hold": "period_us", "link_slotting": "slot_us"}
"""Effects with a phase on a clock, and the name of their period."""


def scans_at_us(recorded: Touches, period_us: float) -> float:
    """Give when one of the recorded scans began, by their stamps; NaN where these keep no grid."""
    stamps = recorded.latch_us[recorded.on_plc]
    turn = mean_turn(stamps, period_us)
    if abs(turn) < KEPT or np.isfinite(stamps).sum() < FEWEST_STAMPS:
        return np.nan
    return float(np.angle(turn)) / (2.0 * np.pi) * period_us


def later_by_us(stamps: FloatArray, scan_at_us: float, period_us: float) -> FloatArray:
    """Give by how much scans begin later than one at a given time; shape (r,).

    Args:
        stamps: Of the scans of r replicates, shape (r, n); NaN if unknown.
        scan_at_us: When one of the others began.
        period_us: Of the scans.
    """
    turn = np.exp(2j * np.pi * scan_at_us / period_us)
    off = np.angle(mean_turn(stamps, period_us) * np.conj(turn))
    return np.asarray(off / (2.0 * np.pi) * period_us)


def has_phase(effect: Effect) -> bool:
    """Tell whether an effect has a phase of its own on the clock; an unset one is drawn."""
    return effect.id in PERIODS and bool(effect.parameters.get("phase_deg", 0.0))


def moved(effect: Effect, by_us: float) -> Effect:
    """Let what an effect does on the clock come later."""
    if not has_phase(effect):
        return effect
    period_us = effect.parameters[PERIODS[effect.id]]
    phase_deg = effect.parameters["phase_deg"]
    moved_deg = (phase_deg + by_us / period_us * DEG_PER_TURN) % DEG_PER_TURN
    return replace(effect, parameters={**effect.parameters, "phase_deg": moved_deg or DEG_PER_TURN})
