"""Playing touches through the firmware in the simulation."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from skiplatch.admitted import JOBS
from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath, Nominal, Status, Touches
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import SimulationError, connection, layout
from skiplatch.simulator.rig import MOST_EFFECTS, Controller, Seat, filled_rig, with_believed
from skiplatch.span import ALWAYS

# What stands in the simulation for a condition that was not recorded.
NOT_RECORDED_IS = {
    "alpha_deg": 0.0,
    "beta_deg": 0.0,
    "sign": 1.0,
    "position_mm": 0.0,
    "rotary_deg": 0.0,
}

CALIBRATED_AT_C = 20.0
"""What counts as neither warm nor cold in the simulation."""


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """What came of playing n touches r times; every array has the shape (r, n).

    Where there was no such outcome a time or a length is NaN.
    """

    edge_us: FloatArray
    """What the reference instrument saw; bench only."""
    latch_us: FloatArray
    """The firmware's own time stamp of the latch."""
    report_us: FloatArray
    deviation_um: FloatArray
    overtravel_um: FloatArray
    """Latch to standstill."""
    cycle_s: FloatArray
    """The whole cycle, until the axis is back at the start."""
    true_edge_us: FloatArray
    """When the contact really closed at the connector."""
    start_delay_us: FloatArray
    """By which the move began later than it was to."""
    status: NDArray[np.int32]
    """Codes of `Status`."""
    error: NDArray[np.int32]
    """Why the firmware's cycle failed: codes of ``touch_error_t``, 0 for none."""

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Latched; shape (r, n)."""
        return np.asarray(self.status == Status.OK)

    def select(self, touches: NDArray[np.intp]) -> "Outcomes":
        """Give those of some of the touches, by their numbers from 0 up."""
        return replace(self, **{f.name: getattr(self, f.name)[:, touches] for f in fields(self)})


def thermometers_c(touches: Touches) -> list[FloatArray]:
    """Give what each thermometer showed, temp_c first, as many as the simulation knows."""
    further = connection()[1].SIM_FURTHER_THERMOMETERS
    return [touches.temp_c, *touches.thermometers.values()][: 1 + further]


def warmths_k(touches: Touches, calibrated_at_c: float) -> FloatArray:
    """Give the degrees above the calibration that each thermometer shows; shape (1 + t, n).

    In the order of `thermometers_c`; 0 of one that is not there or did not show any.
    """
    warmths = np.zeros((1 + connection()[1].SIM_FURTHER_THERMOMETERS, len(touches)))
    for i, temp_c in enumerate(thermometers_c(touches)):
        warmths[i] = np.nan_to_num(temp_c, nan=calibrated_at_c) - calibrated_at_c
    return warmths


def touch_rows(
    nominal: Nominal,
    touches: Touches,
    pulse_us: float,
    datum_um: FloatArray | float = 0.0,
    surface_um: FloatArray | float = 0.0,
) -> NDArray[np.void]:
    """Give the conditions of touches as an array of sim_touch_t; shape (n,)."""
    _, library = connection()
    rows = np.zeros(len(touches), dtype=layout("sim_touch_t"))
    for name in ("time_s", "feed_mm_min", "approach_mm", "touch"):
        rows[name] = getattr(touches, name)
    for name, value in NOT_RECORDED_IS.items():
        rows[name] = np.nan_to_num(getattr(touches, name), nan=value)
    rows["path"] = np.where(
        touches.path == InputPath.PLC, library.SIM_PATH_PLC, library.SIM_PATH_SKIP
    )
    rows["axis"] = np.maximum(touches.axis, 0)  # what was not recorded counts as X
    at_c = nominal.probe.calibrated_at_c
    rows["temp_c"], *further_c = CALIBRATED_AT_C + warmths_k(touches, at_c)
    rows["further_temp_c"] = np.transpose(further_c)
    rows["pulse_us"] = pulse_us
    rows["datum_um"], rows["surface_um"] = datum_um, surface_um
    return rows


def play(
    nominal: Nominal,
    controller: Controller,
    touches: Touches,
    *,
    seed: int,
    replicates: int = 1,
    first_replicate: int = 0,
    jobs: int = 1,
    pulse_us: float = 0.0,
    datum_um: FloatArray | float = 0.0,
    surface_um: FloatArray | float = 0.0,
    switched_on: Sequence[Effect] = (),
    seat: Seat | None = None,
) -> Outcomes:
    """Play the conditions of n touches through the firmware, `replicates` times.

    The result depends on everything but `jobs`, the number of threads. A replicate is a rig
    switched on anew: its scan phase and all its noise are its own.

    Args:
        nominal: The rig.
        controller: The set-up of its controller.
        touches: The conditions; outcomes in it are not looked at.
        seed: Picks the random numbers, together with the number of the replicate and of the touch.
        replicates: How often to play.
        first_replicate: Number of the first replicate.
        jobs: Threads to play on.
        pulse_us: Contact opens again after this time; 0 means when the axis retreats.
        datum_um: How far past the nominal surface the axis shows the real one; shape (n,) or one
            for all.
        surface_um: How far past it that one lies, where the axis goes on at its speed; the same.
        switched_on: Effects that the nominal chain knows nothing of; one that begins or ends is
            played as if it had always been there, and taken where it is.
        seat: The mechanics of the probe, in place of its calibrated mean and lobes.

    Raises:
        SimulationError: A value is out of range, or the library is not built.
        ValueError: There are too few or too many threads.
    """
    JOBS.checked("jobs", jobs)
    alone = partial(
        _play,
        nominal,
        controller,
        touches,
        seed=seed,
        replicates=replicates,
        first_replicate=first_replicate,
        jobs=jobs,
        pulse_us=pulse_us,
        datum_um=datum_um,
        surface_um=surface_um,
        seat=seat,
    )
    if all(effect.span == ALWAYS for effect in switched_on):
        return alone(switched_on=switched_on)
    held = np.array([effect.span.holds(touches.touch) for effect in switched_on])
    sets, which = np.unique(held, axis=1, return_inverse=True)
    plays = [
        alone(switched_on=[e for e, is_there in zip(switched_on, there, strict=True) if is_there])
        for there in sets.T
    ]
    return spliced(plays, which.ravel())


def spliced(plays: Sequence[Outcomes], which: NDArray[np.intp]) -> Outcomes:
    """Take each touch from one of several plays, by its number of shape (n,)."""
    touches = np.arange(len(which))
    return Outcomes(
        *(
            np.ascontiguousarray(
                np.stack([getattr(one, f.name) for one in plays])[which, :, touches].T
            )
            for f in fields(Outcomes)
        )
    )


def _play(
    nominal: Nominal,
    controller: Controller,
    touches: Touches,
    *,
    seed: int,
    replicates: int,
    first_replicate: int,
    jobs: int,
    pulse_us: float,
    datum_um: FloatArray | float,
    surface_um: FloatArray | float,
    switched_on: Sequence[Effect],
    seat: Seat | None,
) -> Outcomes:
    ffi, library = connection()
    if (count := len(with_believed(nominal, switched_on))) > MOST_EFFECTS:
        raise SimulationError(f"expected at most {MOST_EFFECTS} effects, got {count}")
    order = np.argsort(touches.time_s, kind="stable")  # effects remember what came before
    rows = touch_rows(nominal, touches, pulse_us, datum_um, surface_um)[order]
    rig = filled_rig(
        nominal, controller, switched_on, seed=seed, replicate=first_replicate, seat=seat
    )
    raw = np.empty((replicates, len(touches)), dtype=layout("sim_outcome_t"))
    code = library.sim_play(
        rig.structure,
        ffi.from_buffer("sim_touch_t[]", rows),
        len(touches),
        replicates,
        jobs,
        ffi.from_buffer("sim_outcome_t[]", raw, require_writable=True),
    )
    if code != library.SIM_PLAY_OK:
        raise SimulationError(ffi.string(library.sim_play_error(code)).decode())
    back = np.argsort(order)
    return Outcomes(*(np.ascontiguousarray(raw[field.name][:, back]) for field in fields(Outcomes)))
