"""Uncertainty of a compensated probe: a GUM budget, and a Monte Carlo of the same model beside it.

Model: a touch in direction i at the table's feed triggers at r_i = w_i + v_i·τ, and the table is
v_i = v0_i + (W − r̂_i)/τ̂ from a measured map r̂ and a measured delay τ̂. The budget propagates
standard uncertainties to first order (JCGM 100); the Monte Carlo draws map, delay and touches and
computes each table anew through the firmware (JCGM 101). Only it can tell what becomes of V_r: a
range is no linear function of its parts.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.compensation import firmware
from skiplatch.compensation.compensate import Compensation, Limits, Target, plan_of
from skiplatch.compensation.delay import Delay
from skiplatch.compensation.probe_map import ProbeMap
from skiplatch.errors import InputError
from skiplatch.statistics import CONFIDENCE, Interval
from skiplatch.units import S_PER_MIN

DRAWS = 2000
MOST_FAILED = 0.1
"""Share of draws without a table from which on the others would tell too rosy a story."""
COVERAGE = 2.0  # k
UM_MIN_PER_MM_MS = 1.0 / S_PER_MIN  # µm = mm/min · ms / 60
UNIFORM = math.sqrt(3.0)  # half width over standard deviation
LINEAR_RMS = math.sqrt(120.0)  # of ½·w″·x·(h − x) over a step h, beside its w″·h²


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """What the user knows and the data cannot tell.

    Attributes:
        repeatability_um: Standard deviation of one touch; None to take it from the repeats.
        resolution_um: Step of the latched position.
        feed_error: Largest relative error of the machine's feed, 0.01 for 1 %.
    """

    repeatability_um: float | None = None
    resolution_um: float = 0.0
    feed_error: float = 0.0


@dataclass(frozen=True, slots=True)
class Part:
    """One row of the budget.

    Attributes:
        name: The source.
        kind: "A" from repeats, "B" from anything else.
        distribution: The one it is given.
        uncertainty: Standard, in `unit`.
        unit: Of that.
        sensitivity: µm for one `unit`.
        freedom: Degrees of freedom; infinite where it is known.
    """

    name: str
    kind: str
    distribution: str
    uncertainty: float
    unit: str
    sensitivity: float
    freedom: float = math.inf

    @property
    def contribution_um(self) -> float:
        """Standard uncertainty of the result that comes from this."""
        return abs(self.sensitivity) * self.uncertainty


@dataclass(frozen=True, slots=True, eq=False)
class Budget:
    """Trigger radius of one touch at the table's feed, beside the radius all shall have.

    Attributes:
        parts: The rows.
        combined_um: Root of the sum of squares.
        freedom: Effective degrees of freedom (Welch and Satterthwaite).
    """

    parts: list[Part]
    combined_um: float
    freedom: float

    @property
    def expanded_um(self) -> float:
        """For k = 2."""
        return COVERAGE * self.combined_um


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


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """Budget and Monte Carlo, and the expanded uncertainty of V_r before.

    Attributes:
        budget: See `Budget`.
        monte_carlo: See `MonteCarlo`.
        vr_before_expanded_um: k = 2, to first order: of the difference of two mean radii.
    """

    budget: Budget
    monte_carlo: MonteCarlo
    vr_before_expanded_um: float


def assess(done: Compensation, inputs: Inputs, *, seed: int) -> Uncertainty:
    """Give the budget and the Monte Carlo of a table.

    Raises:
        InputError: The delay is so uncertain that most draws allow no table.
    """
    measured = done.probe_map.repeatability_um
    given = inputs.repeatability_um
    known = replace(inputs, repeatability_um=(measured or 0.0) if given is None else given)
    sigma_um = known.repeatability_um or 0.0
    of_mean_um = math.hypot(sigma_um, _resolution_um(known)) / math.sqrt(done.probe_map.runs)
    return Uncertainty(
        budget=_budget(done, known, measured=given is None),
        monte_carlo=_monte_carlo(done, known, np.random.default_rng(seed)),
        vr_before_expanded_um=COVERAGE * math.sqrt(2.0) * of_mean_um,
    )


def _resolution_um(inputs: Inputs) -> float:
    return 0.5 * inputs.resolution_um / UNIFORM


def _budget(done: Compensation, inputs: Inputs, *, measured: bool) -> Budget:
    sigma_um = inputs.repeatability_um or 0.0
    runs = done.probe_map.runs
    freedom = float(done.probe_map.freedom) if measured and runs > 1 else math.inf
    kind = "A" if measured else "B"
    change_mm_min = _rms(done.feed_mm_min - done.before_mm_min)
    travel_um = _rms(done.feed_mm_min) * done.delay.tau_ms * UM_MIN_PER_MM_MS
    delay = done.delay
    tau_freedom = math.inf if delay.freedom is None else float(delay.freedom)
    parts = [
        Part("repeatability of one touch", kind, "normal", sigma_um, "µm", 1.0, freedom),
        Part(
            f"the map, a mean of {runs}",
            kind,
            "normal",
            math.hypot(sigma_um, _resolution_um(inputs)),
            "µm",
            1.0 / math.sqrt(runs),
            freedom,
        ),
        Part(
            "delay tau",
            "B" if delay.fit is None else "A",
            "normal",
            delay.uncertainty_ms,
            "ms",
            change_mm_min * UM_MIN_PER_MM_MS,
            tau_freedom,
        ),
        Part(
            "feed of the machine",
            "B",
            "uniform",
            100 * inputs.feed_error / UNIFORM,
            "%",
            travel_um / 100.0,
        ),
        Part("resolution of the position", "B", "uniform", _resolution_um(inputs), "µm", 1.0),
        Part(
            "between two directions of the map",
            "B",
            "normal",
            interpolation_um(done.probe_map, sigma_um),
            "µm",
            1.0,
        ),
    ]
    combined_um = math.sqrt(sum(part.contribution_um**2 for part in parts))
    return Budget(parts, combined_um, _effective_freedom(parts, combined_um))


def _effective_freedom(parts: list[Part], combined_um: float) -> float:
    weight = sum(part.contribution_um**4 / part.freedom for part in parts)
    return combined_um**4 / weight if weight > 0.0 else math.inf


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def interpolation_um(probe_map: ProbeMap, sigma_um: float) -> float:
    """Estimate by how much the radius between two azimuths leaves the straight line.

    From second differences along the rings, less what their noise amounts to.
    """
    bends: list[FloatArray] = []
    cells = probe_map.cells
    for beta in np.unique(cells.beta_deg):
        ring = probe_map.mean_um[cells.beta_deg == beta]
        if len(ring) > 1:
            bends.append(np.roll(ring, 1) - 2.0 * ring + np.roll(ring, -1))
    noise = 6.0 * sigma_um**2 / probe_map.runs
    mean_square = float(np.mean(np.concatenate(bends) ** 2)) - noise
    return math.sqrt(max(mean_square, 0.0)) / LINEAR_RMS


def _monte_carlo(done: Compensation, inputs: Inputs, random: np.random.Generator) -> MonteCarlo:
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
