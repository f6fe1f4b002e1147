"""A rig, its touches, and what an effect makes of them, for the tests of the effects.

The nominal chain draws the same random numbers whichever effects are switched on. So the same
touches with and without an effect differ by nothing but the effect, touch by touch.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import stats

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import InputPath, Kind, Nominal, Touches
from skiplatch.campaign.nominal import (
    AxisNominal,
    BenchNominal,
    InputNominal,
    PlcNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
)
from skiplatch.simulator.effects import Effect, effects
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller

RARE = 1e-4
"""False-alarm rate of each statistical check; seeds are fixed."""

TICK_US = 0.01
RESOLUTION_UM = 0.001
SCAN_US = 1000.0
FILTER_US = 20.0
DELAY_US = 200.0
ACCEL_MM_S2 = 2000.0
PRETRAVEL_UM = 9.0

# Two stamps are rounded down, two positions to nearest, and every time to a nanosecond.
STAMP_TOLERANCE_US = TICK_US + 0.003
POSITION_TOLERANCE_UM = RESOLUTION_UM + 0.0003

MACHINE = Nominal(
    kind=Kind.MACHINE,
    probe=ProbeNominal(PRETRAVEL_UM, 2.0, 20.0, 0.3, DELAY_US),
    input=InputNominal(FILTER_US),
    skip=SkipNominal(latency_us=4.0, jitter_us=2.0, tick_us=TICK_US),
    plc=PlcNominal(SCAN_US),
    axis=AxisNominal(RESOLUTION_UM, ACCEL_MM_S2),
    report=ReportNominal(300.0, 50.0),
    bench=BenchNominal(0.0),
)
BENCH = replace(
    MACHINE,
    kind=Kind.BENCH,
    probe=ProbeNominal(0.0, 0.0, 0.0, 0.0, 0.0),
    bench=BenchNominal(0.05),
)

# Room to go on until the latest of the latches below, and never a reason to brake before.
CONTROLLER = Controller(overtravel_mm=20.0)

# Parameters at which an effect is plain to see and loses no touch that it need not lose.
EXAMPLES = {
    "feed_error": {"feed_percent": 5.0},
    "unfinished_acceleration": {"accel_ratio": 0.1},
    "pretravel_lobing": {"amplitude_um": 3.0, "azimuth_deg": 50.0},
    "trigger_delay": {"delay_us": 150.0},
    "link_slotting": {"slot_us": 400.0},
    "link_retry": {"probability": 0.3, "period_us": 700.0},
    "input_filter": {"delay_us": 35.0},
    "contact_bounce": {"probability": 0.4, "mean_us": 250.0},
    "lost_trigger": {"probability": 0.3},
    "isr_latency": {"latency_us": 42.0, "jitter_us": 10.0},
    "isr_blocking": {"probability": 0.3, "length_us": 120.0},
    "timer_quantisation": {"tick_us": 8.0},
    "timer_drift": {"drift_ppm": 40.0},
    "scan_period": {"period_us": 137.0},
    "scan_jitter": {"jitter_us": 300.0},
    "scan_overrun": {"probability": 0.2, "overrun_us": 3500.0},
    "input_image_delay": {"scans": 2.0},
    "scan_phase_lock": {"phase": 0.3, "spread": 0.05},
    "servo_hold": {"period_us": 400.0},
    "following_error": {"lag_us": 300.0},
    "backlash": {"backlash_um": 3.5},
    "transmission_error": {
        "amplitude_um": 4.0,
        "period_mm": 5.0,
        "phase_deg": 70.0,
        "amplitude2_um": 1.5,
        "phase2_deg": 200.0,
        "amplitude3_um": 0.7,
        "phase3_deg": 40.0,
    },
    "scale_error": {"scale_ppm": 60.0},
    "encoder_quantisation": {"resolution_um": 1.5},
    "thermal_drift": {"drift_um_k": 2.0, "lag_s": 900.0},
    "rotary_pivot": {"x_um": 12.0, "y_um": -7.0},
    "report_delay": {"delay_us": 400.0, "queue_us": 200.0},
}


def example(effect_id: str) -> Effect:
    """The effect at a plain size; one without an example at a tenth of its ranges."""
    tenths = {p.name: max(p.low, 0.1 * p.high) for p in effects()[effect_id].parameters}
    return Effect(effect_id, EXAMPLES.get(effect_id, tenths))


def mixed_touches(n: int, *, seed: int, path: InputPath | None = None) -> Touches:
    """Touches in all conditions, ten seconds apart; on one path, or on either by chance."""
    rng = np.random.default_rng(seed)
    paths = rng.integers(0, 2, n) if path is None else np.full(n, path)
    return Touches.from_columns(
        touch=np.arange(n),
        time_s=10.0 * np.arange(n) + rng.uniform(1.0, 4.0, n),
        path=paths,
        axis=np.zeros(n),
        sign=rng.choice([-1.0, 1.0], n),
        alpha_deg=rng.uniform(0.0, 360.0, n),
        beta_deg=rng.uniform(0.0, 60.0, n),
        feed_mm_min=rng.choice([60.0, 300.0, 1000.0, 3000.0], n),
        approach_mm=rng.uniform(2.0, 6.0, n),
        position_mm=rng.uniform(-300.0, 300.0, n),
        rotary_deg=rng.choice([0.0, 30.0, 90.0, 215.0], n),
        temp_c=20.0 + 4.0 * np.sin(np.arange(n) / 60.0) + rng.normal(0.0, 0.2, n),
    )


def run(
    touches: Touches, *switched_on: Effect, nominal: Nominal = MACHINE, seed: int = 11
) -> Outcomes:
    """Play once."""
    return play(nominal, CONTROLLER, touches, seed=seed, switched_on=switched_on)


@dataclass(frozen=True, eq=False)
class Trace:
    """One path with and without effects; arrays of shape (n,)."""

    touches: Touches
    nominal: Outcomes
    changed: Outcomes

    @property
    def speed_um_us(self) -> FloatArray:
        """Feed, as every approach here is longer than the ramp."""
        return np.asarray(self.touches.feed_mm_min / 60e3)

    @property
    def pin_us(self) -> FloatArray:
        """When the pin changes in the nominal chain."""
        return np.asarray(self.nominal.true_edge_us[0] + FILTER_US)

    @property
    def edge_shift_us(self) -> FloatArray:
        return np.asarray(self.changed.true_edge_us[0] - self.nominal.true_edge_us[0])

    @property
    def latch_shift_us(self) -> FloatArray:
        return np.asarray(self.changed.latch_us[0] - self.nominal.latch_us[0])

    @property
    def deviation_shift_um(self) -> FloatArray:
        return np.asarray(self.changed.deviation_um[0] - self.nominal.deviation_um[0])

    @property
    def report_shift_us(self) -> FloatArray:
        return np.asarray(self.changed.report_us[0] - self.nominal.report_us[0])

    @property
    def scan_phase_us(self) -> float:
        """Where the nominal scans lie."""
        return float(self.nominal.latch_us[0, 0] % SCAN_US)


def trace(
    path: InputPath, effect_id: str, n: int = 400, seed: int = 11, **parameters: float
) -> Trace:
    """Play touches on a machine without the effect and with it."""
    touches = mixed_touches(n, seed=seed, path=path)
    effect = Effect(effect_id, parameters)
    return Trace(touches, run(touches, seed=seed), run(touches, effect, seed=seed))


def first_scan_us(pin_us: FloatArray, phase_us: float, period_us: float = SCAN_US) -> FloatArray:
    """The first of the scans at or after each pin."""
    return np.asarray(phase_us + np.ceil((pin_us - phase_us) / period_us) * period_us)


def assert_close(values: FloatArray, expected: FloatArray | float, tolerance: float) -> None:
    np.testing.assert_allclose(values, np.broadcast_to(expected, values.shape), 0.0, tolerance)


def assert_share(chosen: BoolArray, probability: float) -> None:
    """As many as that probability lets expect, at the rate RARE of false alarms."""
    assert stats.binomtest(int(chosen.sum()), len(chosen), probability).pvalue > RARE


def assert_follows(sample: FloatArray, law: Any) -> None:  # noqa: ANN401, scipy's have no one type
    """Kolmogorov and Smirnov find nothing, at the rate RARE of false alarms."""
    assert stats.kstest(sample, law.cdf).pvalue > RARE
