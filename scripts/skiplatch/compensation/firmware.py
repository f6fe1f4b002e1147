"""The firmware's mathematics of pretravel, called from Python: ``firmware/comp/pretravel*.h``.

Nothing is computed here. What the functions mean, and which errors they know, stands in those
headers. Arrays of n directions, points or runs have the shape (n,) unless it is said.
"""

from dataclasses import dataclass
from enum import IntEnum
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from skiplatch.arrays import FloatArray
from skiplatch.simulator.library import CData, connection


class Side(IntEnum):
    """From which side the artefact is touched: the sign of pretravel in the measured radius."""

    INSIDE = 1
    OUTSIDE = -1


class Shape(IntEnum):
    """What is fitted."""

    CIRCLE = 2
    SPHERE = 3


class Target(IntEnum):
    """The radius W that every direction shall get."""

    MEAN = 0
    MAX = 1
    MIN = 2
    GIVEN = 3


class PretravelError(Exception):
    """The firmware refused what it was given.

    Attributes:
        name: Of the code, without its prefix: ``GAP``, ``TOO_SLOW``, ``TAU`` and so on.
        index: Of the reading or the direction that caused it, or None.
        gap: Where directions are missing, for ``GAP``.
    """

    def __init__(self, name: str, message: str, index: int | None, gap: "Gap | None") -> None:
        super().__init__(message)
        self.name = name
        self.index = index
        self.gap = gap


@dataclass(frozen=True, slots=True)
class Gap:
    """Nothing was measured across `width_deg` after this direction."""

    alpha_deg: float
    beta_deg: float
    width_deg: float
    """In azimuth, or in β between two rows."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A best-fit circle or sphere."""

    centre_um: FloatArray
    """Shape (3,); z is 0 for a circle."""
    radius_um: float
    scatter_um: float
    shape: Shape


@dataclass(frozen=True, slots=True)
class Tau:
    """The trigger delay, from a line through mean radii over speeds."""

    tau_ms: float
    tau_uncertainty_ms: float
    """Standard uncertainty."""
    offset_um: float
    """Measured radius at speed 0."""
    scatter_um: float
    """Of the runs about the line, standard deviation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How to compensate, and what the machine can do; a limit that is not given is none."""

    tau_ms: float
    target: Target = Target.MEAN
    target_um: float = 0.0
    """For `Target.GIVEN`."""
    speed_max_mm_min: float = inf
    overtravel_speed_mm_min: float = inf
    """The speed whose overtravel is just allowed; see `safe_speed_mm_min`."""
    accel_mm_s2: float = inf
    approach_mm: float = inf


@dataclass(frozen=True, slots=True, eq=False)
class SpeedTable:
    """Compensated speeds, and the radius W they lead to."""

    speed_mm_min: FloatArray
    target_um: float


def as_doubles(values: ArrayLike) -> FloatArray:
    """Give numbers as an array that C can read."""
    return np.ascontiguousarray(values, dtype=np.float64)


def doubles(values: FloatArray) -> CData:
    """Show an array to C."""
    ffi, _ = connection()
    return ffi.from_buffer("double[]", values)


def _filled(values: FloatArray) -> CData:
    ffi, _ = connection()
    return ffi.from_buffer("double[]", values, require_writable=True)


def together(*columns: ArrayLike) -> list[FloatArray]:
    """Give columns of one length; numbers are repeated."""
    return [np.array(column) for column in np.broadcast_arrays(*map(as_doubles, columns))]


def _names() -> dict[int, str]:
    _, library = connection()
    prefix = "PRETRAVEL_ERR_"
    known = (name for name in dir(library) if name.startswith(prefix))
    return {getattr(library, name): name.removeprefix(prefix) for name in known}


def refuse(code: int, index: int | None = None, gap: CData | None = None) -> None:
    """Raise what a code of the firmware says, unless it is none.

    Raises:
        PretravelError: The code is not 0.
    """
    ffi, library = connection()
    if code == library.PRETRAVEL_OK:
        return
    name = _names()[code]
    where = Gap(gap.alpha_deg, gap.beta_deg, gap.width_deg) if gap and name == "GAP" else None
    message = ffi.string(library.pretravel_error(code)).decode()
    raise PretravelError(name, message, index, where)


def range_um(radius_um: ArrayLike) -> float:
    """V_r = max − min of at least one radius."""
    _, library = connection()
    radii = as_doubles(radius_um)
    return float(library.pretravel_range_um(doubles(radii), len(radii)))


def pretravel_um(transducer_um: float, speed_mm_min: float, tau_ms: float) -> float:
    """Give w = w_T + v·τ."""
    _, library = connection()
    return float(library.pretravel_um(transducer_um, speed_mm_min, tau_ms))


def from_radius_um(measured_um: float, nominal_um: float, side: Side) -> float:
    """Pretravel from a measured radius that would be `nominal_um` without it."""
    _, library = connection()
    return float(library.pretravel_from_radius_um(measured_um, nominal_um, side))


def estimate_tau(
    speed_mm_min: ArrayLike, mean_radius_um: ArrayLike, side: Side = Side.INSIDE
) -> Tau:
    """τ from at least three runs at two speeds.

    Raises:
        PretravelError: NOT_FINITE, SPEED, FEW_RUNS, ONE_SPEED or TAU.
    """
    ffi, library = connection()
    speeds, radii = together(speed_mm_min, mean_radius_um)
    tau = ffi.new("pretravel_tau_t *")
    code = library.pretravel_estimate_tau(doubles(speeds), doubles(radii), len(speeds), side, tau)
    refuse(code)
    return Tau(tau.tau_ms, tau.tau_uncertainty_ms, tau.offset_um, tau.scatter_um)


def fit(points_um: ArrayLike, shape: Shape) -> Fit:
    """Best-fit circle or sphere of n points, shape (n, 3); a circle does not look at z.

    Raises:
        PretravelError: FEW_POINTS, NOT_FINITE or CENTRE.
    """
    ffi, library = connection()
    points = as_doubles(points_um)
    found = ffi.new("pretravel_fit_t *")
    rows = ffi.from_buffer("pretravel_point_t[]", points)
    refuse(library.pretravel_fit(rows, len(points), shape, found))
    centre_um = np.array([found.x_um, found.y_um, found.z_um])
    return Fit(centre_um, found.radius_um, found.scatter_um, shape)


def radii_um(points_um: ArrayLike, fitted: Fit) -> FloatArray:
    """Trigger radii: the distances of n points, shape (n, 3), from the centre of a fit."""
    ffi, library = connection()
    points = as_doubles(points_um)
    radii = np.empty(len(points))
    centre = ffi.new("pretravel_fit_t *", (*fitted.centre_um, fitted.radius_um, fitted.scatter_um))
    rows = ffi.from_buffer("pretravel_point_t[]", points)
    library.pretravel_radii_um(rows, len(points), fitted.shape, centre, _filled(radii))
    return radii


def speed_table(radius_um: ArrayLike, speed_mm_min: ArrayLike, plan: Plan) -> SpeedTable:
    """Speeds v₁ = v₀ + (W − r)/τ for n directions; `speed_mm_min` is v₀, one or n of them.

    To iterate, measure at the speeds of the table and give those back as v₀.

    Raises:
        PretravelError: NOT_FINITE, TAU, LIMIT, SPEED, FEW_DIRECTIONS, TOO_SLOW, TOO_FAST,
            OVERTRAVEL or RAMP, with the direction's index.
    """
    ffi, library = connection()
    radii, before = together(radius_um, speed_mm_min)
    after = np.empty(len(radii))
    result = ffi.new("pretravel_result_t *")
    code = library.pretravel_speed_table(
        doubles(radii),
        doubles(before),
        len(radii),
        _plan(plan),
        _filled(after),
        result,
    )
    refuse(code, int(result.where))
    return SpeedTable(after, result.target_um)


def _plan(plan: Plan) -> CData:
    ffi, _ = connection()
    names = [name for name, _ in ffi.typeof("pretravel_plan_t").fields]
    return ffi.new("pretravel_plan_t *", {name: getattr(plan, name) for name in names})


def predict_um(
    radius_um: ArrayLike, speed_mm_min: ArrayLike, new_speed_mm_min: ArrayLike, tau_ms: float
) -> FloatArray:
    """Radii to be expected at new speeds: r + (v₁ − v₀)·τ."""
    _, library = connection()
    radii, before, after = together(radius_um, speed_mm_min, new_speed_mm_min)
    predicted = np.empty(len(radii))
    library.pretravel_predict_um(
        doubles(radii),
        doubles(before),
        doubles(after),
        len(radii),
        tau_ms,
        _filled(predicted),
    )
    return predicted


def time_increase(speed_mm_min: ArrayLike, new_speed_mm_min: ArrayLike) -> float:
    """Δt_R: how much longer the approaches take, as a fraction."""
    _, library = connection()
    before, after = together(speed_mm_min, new_speed_mm_min)
    return float(library.pretravel_time_increase(doubles(before), doubles(after), len(after)))


def time_s(speed_mm_min: FloatArray, approach_mm: float) -> float:
    """t_M: time of an approach at each of the speeds, shape (n,)."""
    _, library = connection()
    (speeds,) = together(speed_mm_min)
    return float(library.pretravel_time_s(doubles(speeds), len(speeds), approach_mm))


def safe_speed_mm_min(overtravel_um: float, *, reaction_us: float, accel_mm_s2: float) -> float:
    """Speed whose overtravel, v·t + v²/2a, is just `overtravel_um`; from ``cycle/overtravel.h``."""
    ffi, library = connection()
    path = ffi.new("overtravel_path_t *", (reaction_us, accel_mm_s2))
    return float(library.overtravel_safe_feed_mm_min(path, overtravel_um))
