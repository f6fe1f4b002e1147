"""The Monte Carlo of a compensated probe (JCGM 101): map, delay and touches are drawn."""

from dataclasses import dataclass

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.compensation import firmware
from skiplatch.compensation.budget import UM_MIN_PER_MM_MS, Inputs, interpolation_um
from skiplatch.compensation.compensate import Compensation, Limits, Target, plan_of
from skiplatch.compensation.delay import Delay
from skiplatch.errors import InputError
from skiplatch.statistics import CONFIDENCE, Interval

DRAWS = 2000
MOST_FAILED = 0.1
"""Share of draws without a table from which on the others would tell too rosy a story."""


@dataclass(frozen=True, slots=True, eq=False)
class MonteCarlo:
    """The same model, drawn.

    Attributes:
        draws: Tables that were made.
        failed: Draws of which no table could be made.
        touch_um: Sample of one touch's radius less the mean radius; shape (draws,).
        touch_deviation_um: Its standard deviation.
        vr_before_um: V_r of the mean radii before: what so many repeats scatter by.
        vr_after_um: V_r of the mean of as many repeats with the table.
        vr_single_run_um: Largest V_r of a single one of these runs.
        example_um: Mean radii with the table in one draw, with the sign of the map; shape (n,).
        tau_ms: The delay from as many runs as were measured; None where it was given.
    """

    draws: int
    failed: int
    touch_um: FloatArray
    touch_deviation_um: float
    vr_before_um: Interval
    vr_after_um: Interval
    vr_single_run_um: Interval
    example_um: FloatArray
    tau_ms: Interval | None


def draw_tables(done: Compensation, inputs: Inputs, random: np.random.Generator) -> MonteCarlo:
    """Draw the map and the delay anew, make the table of each draw, and measure with it.

    Raises:
        InputError: The delay is so uncertain that most draws allow no table.
    """
    shape = done.probe_map.radius_um.shape
    touches: list[float] = []
    before, after, single = [], [], []
    failed = 0
    example_um = done.predicted_um
    bend_um = interpolation_um(done.probe_map, inputs.repeatability_um or 0.0)
    for _ in range(DRAWS):
        noise_um = _noise(shape, inputs, random)
        map_um = done.probe_map.mean_um + noise_um.mean(axis=1)
        before.append(firmware.range_um(map_um))
        feeds = _table(done, map_um, done.delay.tau_ms + _tau_error(done.delay, random))
        if feeds is None:
            failed += 1
            continue
        runs_um = _measured_again(done, feeds, inputs, random)
        example_um = runs_um.mean(axis=1)
        after.append(firmware.range_um(example_um))
        single.append(max(firmware.range_um(run) for run in runs_um.T))
        one = int(random.integers(runs_um.size))
        between_um = float(random.normal(0.0, bend_um))
        touches.append(float(runs_um.flat[one] - runs_um.mean()) + between_um)
    if failed > MOST_FAILED * DRAWS:
        raise _too_uncertain(done, failed)
    touch_um = np.array(touches)
    return MonteCarlo(
        draws=len(touches),
        failed=failed,
        touch_um=touch_um,
        touch_deviation_um=float(touch_um.std(ddof=1)),
        vr_before_um=_interval(before),
        vr_after_um=_interval(after),
        vr_single_run_um=_interval(single),
        example_um=example_um,
        tau_ms=_tau_draws(done.delay, random),
    )


def _too_uncertain(done: Compensation, failed: int) -> InputError:
    delay = done.delay
    message = (
        f"tau of {delay.tau_ms:g} ms with a standard uncertainty of {delay.uncertainty_ms:g} ms: "
        f"in {failed} of {DRAWS} draws no table can be made"
    )
    return InputError(done.probe_map.readings.path, None, None, message)


def _noise(shape: tuple[int, ...], inputs: Inputs, random: np.random.Generator) -> FloatArray:
    """Random error of touches: the probe's, and the rounding of the position."""
    probe_um = random.normal(0.0, inputs.repeatability_um or 0.0, shape)
    half = 0.5 * inputs.resolution_um
    return np.asarray(probe_um + random.uniform(-half, half, shape))


def _tau_error(delay: Delay, random: np.random.Generator) -> float:
    """Error of the estimate: of a mean of few runs it has heavier tails than a normal one."""
    if delay.freedom is None:
        return float(random.normal(0.0, delay.uncertainty_ms))
    return delay.uncertainty_ms * float(random.standard_t(delay.freedom))


def _table(done: Compensation, map_um: FloatArray, tau_ms: float) -> FloatArray | None:
    """Make the table that another measurement would have led to; None if it cannot be made."""
    target = Target(firmware.Target.GIVEN, done.probe_map.sign * done.target_um)
    plan = plan_of(tau_ms, target, done.probe_map, Limits())
    try:
        return firmware.speed_table(map_um, done.before_mm_min, plan).speed_mm_min
    except firmware.PretravelError:
        return None


def _measured_again(
    done: Compensation, feeds: FloatArray, inputs: Inputs, random: np.random.Generator
) -> FloatArray:
    """Give the radii of new runs with a table, shape (n, m), on the probe that was measured."""
    tau_ms = done.delay.tau_ms
    shape = done.probe_map.radius_um.shape
    expected_um = firmware.predict_um(done.probe_map.mean_um, done.before_mm_min, feeds, tau_ms)
    off = random.uniform(-inputs.feed_error, inputs.feed_error, shape)
    late_um = off * (feeds * tau_ms * UM_MIN_PER_MM_MS)[:, None]
    return expected_um[:, None] + late_um + _noise(shape, inputs, random)


def _interval(draws: list[float]) -> Interval:
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(draws, [tail, 1.0 - tail])
    return Interval(float(np.mean(draws)), float(low), float(high))


def _tau_draws(delay: Delay, random: np.random.Generator) -> Interval | None:
    """Draw the runs anew about the line, and estimate the delay of each set."""
    if delay.fit is None or delay.speeds is None:
        return None
    speeds = delay.speeds
    slope = speeds.side * delay.tau_ms * UM_MIN_PER_MM_MS
    line_um = delay.fit.offset_um + slope * speeds.feed_mm_min
    drawn: list[float] = []
    for _ in range(DRAWS):
        radius_um = line_um + random.normal(0.0, delay.fit.scatter_um, len(line_um))
        try:
            fit = firmware.estimate_tau(speeds.feed_mm_min, radius_um, speeds.side)
        except firmware.PretravelError:
            continue  # the scatter hides the slope
        drawn.append(fit.tau_ms)
    return _interval(drawn)
