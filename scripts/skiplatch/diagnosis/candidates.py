"""The table of the effects that can be fitted: what each does, and where a search for it begins.

The simulator has its own, exact form of every effect; these are the surrogates that propose. An
effect that the simulator knows and this table does not is searched for by simulation alone.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.campaign import Nominal
from skiplatch.diagnosis import starts, surrogates
from skiplatch.diagnosis.axes import each_axis
from skiplatch.diagnosis.change import Change
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.starts import Starts
from skiplatch.diagnosis.surrogates import Parameters
from skiplatch.diagnosis.waves import transmissions
from skiplatch.simulator.effects import effects
from skiplatch.span import ALWAYS, Span

FEWEST_AZIMUTHS = 7
"""Directions, to a degree, that show three lobes in a turn: two each and one more (Nyquist)."""
LEEWAY = 0.05
"""Of the scatter of a delay, by which a fit may miss its least."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One effect as a surrogate.

    Attributes:
        id: As in the table of effects.
        names: Of the parameters, as in the table of effects.
        change: What parameters, shape (p,), make of the physics.
        starts: Parameters to start a search from, given what is known to differ already. What is
            0 in a start stays 0.
        applies: Whether a campaign can show the effect at all.
    """

    id: str
    names: tuple[str, ...]
    change: Callable[[Scene, Parameters], Change]
    starts: Starts
    applies: Callable[[Scene], bool] = lambda _: True
    refinements: tuple[Mapping[int, float], ...] = ()
    """Parameters, by number and with a first value, that make other forms of the effect."""
    believed_us: Callable[[Nominal], float] | None = None
    """Of a delay, the first parameter of which adds to it: what it is believed to take already."""
    like_datum: frozenset[str] = frozenset()
    """Parameters beside which a datum that may be anywhere makes another of the same."""
    span: Span = ALWAYS
    """The touches at which it acts."""

    def acting(self, scene: Scene, parameters: Parameters) -> Change:
        """Give what parameters, shape (p,), make of the physics of the touches at which it acts."""
        change = self.change(scene, parameters)
        return change if self.span == ALWAYS else Change(passing=((self.span, change),))

    def taken_up(self, scene: Scene) -> frozenset[int]:
        """Number the parameters that stay at 0, for the datum does what they do."""
        is_anywhere = scene.datum_groups is not None and scene.datum_u_um is None
        return frozenset(map(self.names.index, self.like_datum if is_anywhere else ()))

    def is_possible(self, scene: Scene, parameters: Parameters) -> bool:
        """Tell whether no size is beyond its range, and nothing comes before its cause."""
        if self.is_named and any(
            abs(value) > max(abs(p.low), abs(p.high))
            for p, value in zip(effects()[self.id].parameters, parameters, strict=True)
            if p.unit not in ("deg", "1")
        ):
            return False
        if self.believed_us is None:
            return True
        open_us = scene.nominal.skip.tick_us + LEEWAY * float(np.abs(parameters[1:3]).sum())
        return bool(parameters[0] >= -self.believed_us(scene.nominal) - open_us)

    @property
    def is_named(self) -> bool:
        """It stands in the table of effects."""
        return self.id in CANDIDATES

    def __reduce__(self) -> tuple[Callable[[str, Span], "Candidate"], tuple[str, Span]]:
        """Travel to another process as the id and the span alone."""
        return candidate, (self.id, self.span)


def candidate(effect_id: str, span: Span = ALWAYS) -> Candidate:
    """Give the candidate of an id, acting at some touches."""
    return replace(CANDIDATES[effect_id], span=span)


def _machine(scene: Scene) -> bool:
    return scene.is_machine


def _varies(column: str) -> Callable[[Scene], bool]:
    """Tell whether a condition was recorded and varied: else nothing can be seen to go with it."""

    def applies(scene: Scene) -> bool:
        values = getattr(scene.touches, column)
        known = values[~np.isnan(values)]
        return bool(len(known) and np.ptp(known) > 0.0)

    return applies


def _shows_waves(scene: Scene) -> bool:
    return bool(np.isfinite(scene.shortest_wave_mm))


def _shows_lobes(scene: Scene) -> bool:
    """Tell lobes from backlash: the two senses of two axes show no three of anything in a turn."""
    azimuths = np.unique(np.round(scene.touches.alpha_deg[~np.isnan(scene.touches.alpha_deg)]))
    return scene.is_machine and len(azimuths) >= FEWEST_AZIMUTHS


def _per_axis(first: int) -> tuple[Mapping[int, float], ...]:
    """Refine by axes of their own; `first` is the number of y_excess_ratio."""
    return ({first: 0.1}, {first: -0.5}, {first + 1: -0.9}, {first: 0.1, first + 1: -0.9})


CANDIDATES: Mapping[str, Candidate] = {
    row.id: row
    for row in (
        Candidate(
            "feed_error",
            ("feed_percent", "offset_mm_min", "limit_mm_min"),
            surrogates.feed_error,
            starts.feeds,
            refinements=({1: 1.0}, {1: -1.0}),
        ),
        Candidate(
            "unfinished_acceleration",
            ("accel_ratio", "by_feed"),
            surrogates.unfinished,
            starts.accelerations,
            refinements=({1: 0.5}, {1: -0.5}),
        ),
        Candidate(
            "pretravel_lobing",
            ("amplitude_um", "azimuth_deg", "second_um", "third_um", "elevation_power"),
            surrogates.lobing,
            starts.fixed(*([2.0, azimuth, 0.0, 0.0, 0.0] for azimuth in (0.0, 30.0, 60.0, 90.0))),
            _shows_lobes,
            refinements=({2: 0.5}, {2: -0.5}, {3: 0.3}, {3: -0.3}, {4: 1.0}, {4: -0.5}),
        ),
        Candidate(
            "trigger_delay",
            ("delay_us", "jitter_us", "tail_us"),
            surrogates.delay,
            starts.delays,
            _machine,
            refinements=({1: 5.0}, {1: 100.0}, {2: 5.0}, {2: 100.0}),
            believed_us=lambda nominal: nominal.probe.delay_us,
        ),
        Candidate(
            "link_slotting",
            ("slot_us", "phase_deg"),
            surrogates.slotted,
            starts.slots,
            _machine,
        ),
        Candidate(
            "link_retry",
            ("probability", "period_us", "scatter_us", "retry_excess"),
            surrogates.retry,
            starts.fixed(
                *(
                    [share, period, 0.2 * period, 0.0]
                    for share in (0.1, 0.4)
                    for period in (100.0, 500.0, 2000.0, 8000.0)
                )
            ),
            _machine,
            refinements=({3: 0.3},),
        ),
        Candidate(
            "input_filter",
            ("delay_us", "jitter_us", "tail_us"),
            surrogates.delay,
            starts.delays,
            refinements=({1: 5.0}, {1: 100.0}, {2: 5.0}, {2: 100.0}),
            believed_us=lambda nominal: nominal.input.filter_us,
        ),
        Candidate(
            "contact_bounce",
            ("probability", "mean_us", "least_us", "span_us"),
            surrogates.bounce,
            starts.fixed(*([0.2, mean, 0.0, 0.0] for mean in (30.0, 300.0, 3000.0))),
            refinements=tuple({i: size} for size in (10.0, 100.0, 1000.0) for i in (2, 3)),
        ),
        Candidate(
            "lost_trigger",
            ("probability",),
            lambda _, p: Change(lost=surrogates.as_share(p[0])),
            starts.fixed([0.02]),
        ),
        Candidate(
            "isr_latency",
            ("latency_us", "jitter_us", "tail_us"),
            surrogates.interrupt,
            starts.fixed([10.0, 0.0, 0.0], [100.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [5.0, 5.0, 0.0]),
            refinements=({1: 1.0}, {1: 20.0}, {2: 1.0}, {2: 20.0}),
            believed_us=lambda nominal: nominal.skip.latency_us,
        ),
        Candidate(
            "isr_blocking",
            ("probability", "length_us", "tail_us"),
            surrogates.blocking,
            starts.fixed([0.2, 20.0, 0.0], [0.2, 200.0, 0.0], [0.2, 2000.0, 0.0]),
            refinements=({2: 10.0}, {2: 100.0}, {2: 1000.0}),
        ),
        Candidate(
            "timer_quantisation",
            ("tick_us", "origin_us", "nearest"),
            surrogates.coarse_ticks,
            starts.ticks,
        ),
        Candidate(
            "timer_drift",
            ("drift_ppm", "ageing_ppm_h", "warmth_ppm_k"),
            surrogates.drift,
            starts.drifts,
            refinements=(
                *({1: size} for size in (1.0, -1.0, 20.0, -20.0)),
                *({2: size} for size in (0.3, -0.3, 5.0, -5.0)),
            ),
        ),
        Candidate(
            "scan_period", ("period_us",), lambda _, p: Change(period_us=p[0]), starts.scan_periods
        ),
        Candidate(
            "scan_jitter",
            ("jitter_us", "tail_us", "on_time_share"),
            surrogates.jitter,
            starts.fixed(
                [20.0, 5.0, 0.0], [200.0, 100.0, 0.0], [100.0, 500.0, 0.0], [10.0, 0.0, 0.5]
            ),
            refinements=({2: 0.3},),
        ),
        Candidate(
            "scan_overrun",
            ("probability", "overrun_us", "span_us"),
            surrogates.overrun,
            starts.overruns,
        ),
        Candidate(
            "input_image_delay",
            ("scans",),
            surrogates.image_delay,
            starts.fixed([0.3], [1.0], [1.5], [2.0], [3.0], [4.0]),
        ),
        Candidate(
            "scan_phase_lock",
            ("phase", "spread", "unlocked"),
            lambda _, p: Change(
                wait=(
                    -p[0] % 1.0,
                    float(np.clip(abs(p[1]), 1e-3, surrogates.LOOSEST)),
                    surrogates.as_share(p[2]),
                )
            ),
            starts.locks,
        ),
        Candidate(
            "servo_hold",
            ("period_us", "dead_us", "phase_deg"),
            surrogates.held,
            starts.holds,
            refinements=({1: 10.0}, {1: 200.0}),
        ),
        Candidate(
            "following_error",
            ("lag_us", "y_excess_ratio", "z_excess_ratio"),
            surrogates.lagging,
            each_axis(
                surrogates.lagging, [[1.0, 0.0, 0.0]], (10.0, 500.0), linear=1, y_excess_ratio=1
            ),
            refinements=_per_axis(1),
        ),
        Candidate(
            "backlash",
            ("backlash_um", "positive_um", "y_excess_ratio", "z_excess_ratio"),
            surrogates.lost_motion,
            each_axis(
                surrogates.lost_motion,
                [[*senses, 0.0, 0.0] for senses in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))],
                (2.0,),
                linear=2,
                y_excess_ratio=2,
            ),
            applies=_varies("sign"),
            refinements=({0: 0.1}, {1: 0.1}, *_per_axis(2)),
            like_datum=frozenset({"positive_um"}),
        ),
        Candidate(
            "transmission_error",
            (
                "amplitude_um",
                "period_mm",
                "phase_deg",
                "amplitude2_um",
                "phase2_deg",
                "amplitude3_um",
                "phase3_deg",
                "y_excess_ratio",
                "z_excess_ratio",
                "y_ahead_deg",
                "z_ahead_deg",
                "at_surface",
            ),
            surrogates.transmission,
            transmissions,
            _shows_waves,
            refinements=(
                *({3: 0.3, 4: phase} for phase in (45.0, 135.0, 225.0, 315.0)),
                *_per_axis(7),
            ),
        ),
        Candidate(
            "scale_error",
            ("scale_ppm", "y_excess_ratio", "z_excess_ratio"),
            surrogates.scaled,
            each_axis(
                surrogates.scaled, [[1.0, 0.0, 0.0]], (10.0, 100.0), linear=1, y_excess_ratio=1
            ),
            refinements=_per_axis(1),
            applies=_varies("position_mm"),
        ),
        Candidate(
            "encoder_quantisation",
            ("resolution_um", "is_coordinate", "origin"),
            surrogates.coarse_positions,
            starts.resolutions,
        ),
        Candidate(
            "thermal_drift",
            ("drift_um_k", "lag_s", "starts_at_calibration", "y_excess_ratio", "z_excess_ratio"),
            surrogates.warmed,
            each_axis(
                surrogates.warmed,
                [
                    *([1.0, lag_s, 0.0, 0.0, 0.0] for lag_s in (0.0, 300.0, 3000.0)),
                    [1.0, 500.0, 1.0, 0.0, 0.0],
                ],
                (2.0,),
                linear=1,
                y_excess_ratio=3,
            ),
            applies=_varies("temp_c"),
            refinements=_per_axis(3),
        ),
        Candidate(
            "rotary_pivot",
            ("x_um", "y_um", "set_on_believed_centre", "mirrored"),
            surrogates.pivot,
            starts.fixed(
                *(
                    [x, y, unset, mirrored]
                    for x, y in ((5.0, 0.5), (0.5, -5.0), (-5.0, 0.5), (0.5, 5.0))
                    for unset, mirrored in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))
                )
            ),
            applies=_varies("rotary_deg"),
        ),
        Candidate(
            "report_delay",
            ("delay_us", "queue_us", "unqueued_share", "stepping_us_min_m"),
            surrogates.later_reports,
            starts.reports,
            refinements=({3: 10.0},),
            believed_us=lambda nominal: nominal.report.latency_us,
        ),
    )
}
