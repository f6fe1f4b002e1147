"""What the engineer believes of a rig where that is not all true, and its nominal.toml.

The rig is played as it is; what is believed differs from it by factors of its noise, or by about
the standard uncertainty that stands beside a value.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from skiplatch.campaign import Nominal
from tests.withheld.conditions import Recording, log_uniform

Key = tuple[str, str]


@dataclass(frozen=True, eq=False)
class Beliefs:
    """What stands in nominal.toml.

    Attributes:
        nominal: All of it.
        off: True value of what is believed wrongly, by section and key.
    """

    nominal: Nominal
    off: Mapping[Key, float] = field(default_factory=dict)

    def off_as_json(self) -> dict[str, dict[str, float]]:
        """Give what is believed wrongly in plain types."""
        return {
            ".".join(key): {
                "believed": self.nominal.number(*key),
                "true": true,
                "u": self.nominal.uncertainty.get(key, 0.0),
            }
            for key, true in self.off.items()
        }


def _set(nominal: Nominal, key: Key, value: float) -> Nominal:
    section = replace(getattr(nominal, key[0]), **{key[1]: float(value)})
    changed: Nominal = replace(nominal, **{key[0]: section})
    return changed


def _believing(nominal: Nominal, believed: Mapping[Key, float]) -> Nominal:
    for key, value in believed.items():
        nominal = _set(nominal, key, value)
    return nominal


# ---- noise that is not as large as believed ------------------------------------------------------

FACTORS = (0.6, 1.6)
LEAST_FACTOR = 1.1
REPEATABILITY: Key = ("probe", "repeatability_um")
JITTERS: Mapping[str, Key] = {"skip": ("skip", "jitter_us"), "report": ("report", "jitter_us")}


def wrong_noise(rng: np.random.Generator, nominal: Nominal, recording: Recording) -> Beliefs:
    """Believe the repeatability or a jitter to be another; its middle is known all the same."""
    sections = ["skip"] if recording is Recording.POSITION else list(JITTERS)
    sections += [] if recording is Recording.BENCH else ["probe", "probe"]
    chosen = sections[int(rng.integers(len(sections)))]
    factor = _factor(rng)
    if chosen == "probe":
        believed = {REPEATABILITY: nominal.number(*REPEATABILITY) * factor}
    else:
        jitter = JITTERS[chosen]
        latency, span = (chosen, "latency_us"), nominal.number(*jitter)
        middle = nominal.number(*latency) + span / 2
        believed = {jitter: factor * span, latency: middle - factor * span / 2}
    off = {key: nominal.number(*key) for key in believed}
    return Beliefs(_believing(nominal, believed), off=off)


def _factor(rng: np.random.Generator) -> float:
    while True:
        factor = log_uniform(rng, *FACTORS)
        if abs(np.log(factor)) > np.log(LEAST_FACTOR):
            return factor


# ---- values that are uncertain -------------------------------------------------------------------

DELAY: Key = ("probe", "delay_us")
FILTER: Key = ("input", "filter_us")
LATENCY: Key = ("skip", "latency_us")
PRETRAVEL: Key = ("probe", "pretravel_um")
LOBE: Key = ("probe", "lobe_um")
ACCELERATION: Key = ("axis", "accel_mm_s2")
REPORT: Key = ("report", "latency_us")
SCAN: Key = ("plc", "scan_us")

RELATIVE: Mapping[Key, tuple[float, float]] = {
    DELAY: (0.01, 0.05),
    FILTER: (0.05, 0.2),
    LATENCY: (0.05, 0.25),
    PRETRAVEL: (0.03, 0.15),
    LOBE: (0.05, 0.15),
    ACCELERATION: (0.02, 0.1),
    REPORT: (0.01, 0.05),
    SCAN: (2e-5, 1e-4),
}
"""Uncertainties as shares of the values, from … to."""

DELAYS = frozenset({DELAY, FILTER, LATENCY})
SAME: Mapping[str, frozenset[Key]] = {
    "trigger_delay": DELAYS,
    "input_filter": DELAYS,
    "isr_latency": DELAYS,
    "isr_blocking": DELAYS,
    "contact_bounce": DELAYS,
    "link_slotting": DELAYS,
    "link_retry": DELAYS,
    "servo_hold": DELAYS,
    "following_error": DELAYS,
    "feed_error": DELAYS | {ACCELERATION},
    "unfinished_acceleration": DELAYS | {ACCELERATION},
    "pretravel_lobing": frozenset({LOBE}),
    "scan_period": frozenset({SCAN}),
    "scan_jitter": frozenset({SCAN}),
    "scan_overrun": frozenset({SCAN}),
    "scan_phase_lock": frozenset({SCAN}),
    "input_image_delay": frozenset({SCAN}),
    "report_delay": frozenset({REPORT}),
}
"""Beliefs that are the effect's own quantity: an effect within their uncertainty is none."""
OFF_BY = (0.8, 1.2)
"""Uncertainties by which a value is off."""


def uncertain(
    rng: np.random.Generator, nominal: Nominal, recording: Recording, effects: Sequence[str]
) -> Beliefs:
    """Let two or three beliefs that are not the effects' own be off by about what they may be."""
    taken = frozenset[Key]().union(*(SAME.get(effect, frozenset()) for effect in effects))
    usable = [key for key in RELATIVE if key not in taken and nominal.number(*key) > 0.0]
    if recording is Recording.POSITION:
        usable = [key for key in usable if key not in {REPORT, SCAN}]
    picked = rng.permutation(len(usable))[: int(rng.integers(2, 4))]
    uncertainty, believed = {}, {}
    for key in (usable[i] for i in sorted(picked)):
        true = nominal.number(*key)
        u = float(f"{true * rng.uniform(*RELATIVE[key]):.3g}")
        off = rng.choice([-1.0, 1.0]) * rng.uniform(*OFF_BY) * u
        uncertainty[key], believed[key] = u, round(max(true + float(off), 0.0), 6)
    true_values = {key: nominal.number(*key) for key in believed}
    nominal = _believing(nominal, believed)
    return Beliefs(replace(nominal, uncertainty=uncertainty), off=true_values)
