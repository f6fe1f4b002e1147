"""The table of the effects that can be fitted: what each does, and where a search for it begins.

The simulator has its own, exact form of every effect; these are the surrogates that propose. An
effect that the simulator knows and this table does not is searched for by simulation alone.
"""

import copyreg
from collections.abc import Callable, Mapping
from dataclasses import replace

from skiplatch.diagnosis.candidates import (
    grid_starts,
    grid_surrogates,
    linear_starts,
    scan_starts,
    scan_surrogates,
    starts,
    surrogates,
)
from skiplatch.diagnosis.candidates.applicable import (
    has_clock,
    on_machine,
    shows_lobes,
    shows_waves,
    varies,
)
from skiplatch.diagnosis.candidates.axes import axes_of_their_own, each_axis, like_datum
from skiplatch.diagnosis.candidates.candidate import Candidate
from skiplatch.diagnosis.candidates.thermometers import by_each_thermometer, shows_warmth
from skiplatch.diagnosis.candidates.waves import FURTHER_ORDERS, transmissions
from skiplatch.diagnosis.density.change import Change
from skiplatch.span import ALWAYS, Span


def candidate(effect_id: str, span: Span = ALWAYS) -> Candidate:
    """Give the candidate of an id, acting at some touches."""
    return replace(CANDIDATES[effect_id], span=span)


def _as_id_and_span(one: Candidate) -> tuple[Callable[[str, Span], Candidate], tuple[str, Span]]:
    return candidate, (one.id, one.span)


copyreg.pickle(Candidate, _as_id_and_span)  # functions do not travel to another process


WARMED = ((1.0, 0.0, 0.0), (1.0, 0.0, 1.0), (0.0, 1.0, 0.0))
"""Whether the axis drifts or its scale grows, and whether that is along the approach."""
FURTHER_LATE = tuple({i: size} for size in (10.0, 100.0, 1000.0) for i in (2, 3))
"""Forms of what comes late now and then, by its third parameter or its fourth."""
_DELAYS = starts.later(*([sign * us, 0.0, 0.0] for us in (10.0, 300.0) for sign in (1.0, -1.0)))

CANDIDATES: Mapping[str, Candidate] = {
    row.id: row
    for row in (
        Candidate(
            "feed_error",
            surrogates.feed_error,
            starts.feeds,
            refinements=({1: 1.0}, {1: -1.0}),
        ),
        Candidate(
            "unfinished_acceleration",
            surrogates.unfinished,
            starts.accelerations,
            refinements=({1: 0.5}, {1: -0.5}),
        ),
        Candidate(
            "pretravel_lobing",
            surrogates.lobing,
            linear_starts.lobes(surrogates.lobing),
            shows_lobes,
            refinements=({2: 0.5}, {2: -0.5}, {3: 0.3}, {3: -0.3}, {4: 1.0}, {4: -0.5}),
        ),
        Candidate(
            "trigger_delay",
            surrogates.delay,
            _DELAYS,
            on_machine,
            refinements=({1: 5.0}, {1: 100.0}, {2: 5.0}, {2: 100.0}),
            believed_us=lambda nominal: nominal.probe.delay_us,
        ),
        Candidate(
            "link_slotting",
            surrogates.slotted,
            grid_starts.slots,
            on_machine,
        ),
        Candidate(
            "link_retry",
            surrogates.retry,
            starts.now_and_then(
                [
                    [share, us, 0.2 * us, 0.0]
                    for share in (0.1, 0.4)
                    for us in (100.0, 500.0, 2000.0, 8000.0)
                ],
                as_late=[[1.0, 0.01, 0.0], [1.0, 0.2, 0.0]],
            ),
            on_machine,
            refinements=({3: 0.3},),
        ),
        Candidate(
            "input_filter",
            surrogates.delay,
            _DELAYS,
            refinements=({1: 5.0}, {1: 100.0}, {2: 5.0}, {2: 100.0}),
            believed_us=lambda nominal: nominal.input.filter_us,
        ),
        Candidate(
            "contact_bounce",
            surrogates.bounce,
            starts.now_and_then(
                [[0.2, us, 0.0, 0.0] for us in (30.0, 300.0, 3000.0)], as_late=[[1.4, 0.0, 0.0]]
            ),
            refinements=FURTHER_LATE,
        ),
        Candidate(
            "lost_trigger",
            lambda _, p: Change(lost=surrogates.as_share(p[0])),
            starts.fixed([0.02]),
        ),
        Candidate(
            "isr_latency",
            surrogates.interrupt,
            starts.later([10.0, 0.0, 0.0], [100.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [5.0, 5.0, 0.0]),
            refinements=({1: 1.0}, {1: 20.0}, {2: 1.0}, {2: 20.0}),
            believed_us=lambda nominal: nominal.skip.latency_us,
        ),
        Candidate(
            "isr_blocking",
            surrogates.blocking,
            starts.now_and_then(
                [
                    [0.2, *one, 0.0]
                    for us in (20.0, 200.0, 2000.0)
                    for one in ((us, 0.0), (0.0, us))
                ],
                as_late=[[2.0, 0.0, 0.0], [0.0, 1.4, 0.0]],
            ),
            refinements=FURTHER_LATE,
        ),
        Candidate(
            "timer_quantisation",
            grid_surrogates.coarse_ticks,
            grid_starts.ticks,
            refinements=({2: 0.5},),
        ),
        Candidate(
            "timer_drift",
            surrogates.drift,
            starts.drifts,
            applies=has_clock,
            refinements=(
                *({1: size} for size in (1.0, -1.0, 20.0, -20.0)),
                *({2: size} for size in (0.3, -0.3, 5.0, -5.0)),
            ),
        ),
        Candidate(
            "scan_period",
            lambda _, p: Change(period_us=p[0]),
            scan_starts.scan_periods,
            is_rough=True,
        ),
        Candidate(
            "scan_jitter",
            scan_surrogates.jitter,
            scan_starts.jitters,
            refinements=({2: 0.3},),
        ),
        Candidate(
            "scan_overrun",
            scan_surrogates.overrun,
            scan_starts.overruns,
            refinements=({1: lambda p: float(p[2] / 4.0)},),
        ),
        Candidate(
            "input_image_delay",
            scan_surrogates.image_delay,
            starts.fixed([0.3], [1.0], [1.5], [2.0], [3.0], [4.0]),
        ),
        Candidate(
            "scan_phase_lock",
            scan_surrogates.locked,
            scan_starts.locks,
            # About two points, each half as widely, the edges spread as about the one between.
            refinements=(
                {
                    0: lambda p: float(p[0] - p[1]),
                    1: lambda p: float(p[1] / 2.0),
                    3: lambda p: float(2.0 * p[1]),
                    4: 0.5,
                },
            ),
        ),
        Candidate(
            "servo_hold",
            surrogates.held,
            grid_starts.holds,
            refinements=({1: 10.0}, {1: 200.0}),
        ),
        Candidate(
            "following_error",
            surrogates.lagging,
            each_axis(
                surrogates.lagging, [[1.0, 0, 0, 0]], (10.0, 500.0), linear=1, y_excess_ratio=1
            ),
            refinements=(*axes_of_their_own(1), {3: 5.0}, {3: 100.0}),
        ),
        Candidate(
            "backlash",
            surrogates.lost_motion,
            each_axis(
                surrogates.lost_motion,
                [[*senses, 0.0, 0.0, 0.0] for senses in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))],
                (2.0,),
                linear=2,
                y_excess_ratio=2,
                moves_surface=4,
            ),
            applies=varies("sign"),
            refinements=({0: 0.1}, {1: 0.1}, *axes_of_their_own(2)),
            like_datum=like_datum,
        ),
        Candidate(
            "transmission_error",
            surrogates.transmission,
            transmissions,
            shows_waves,
            refinements=(*FURTHER_ORDERS, *axes_of_their_own(7)),
        ),
        Candidate(
            "scale_error",
            surrogates.scaled,
            each_axis(
                surrogates.scaled,
                [[1.0, 0.0, 0.0, 0.0]],
                (10.0, 100.0),
                linear=1,
                y_excess_ratio=1,
                moves_surface=3,
            ),
            refinements=axes_of_their_own(1),
            applies=varies("position_mm"),
        ),
        Candidate(
            "encoder_quantisation",
            grid_surrogates.coarse_positions,
            grid_starts.resolutions,
        ),
        Candidate(
            "thermal_drift",
            surrogates.warmed,
            by_each_thermometer(
                lambda number: each_axis(
                    surrogates.warmed,
                    [
                        [drift, growth, lag_s, cold, 0.0, 0.0, along, 0.0, number]
                        for drift, growth, along in WARMED
                        for lag_s, cold in ((0.0, 0.0), (300.0, 0.0), (3000.0, 0.0), (500.0, 1.0))
                    ],
                    (2.0,),
                    linear=2,
                    y_excess_ratio=4,
                    moves_surface=7,
                )
            ),
            applies=shows_warmth,
            refinements=({0: 1.0}, {1: 10.0}, {3: 0.5}, *axes_of_their_own(4)),
        ),
        Candidate(
            "rotary_pivot",
            surrogates.pivot,
            linear_starts.centres(surrogates.pivot),
            applies=varies("rotary_deg"),
        ),
        Candidate(
            "report_delay",
            surrogates.later_reports,
            starts.reports,
            refinements=({3: 10.0},),
            believed_us=lambda nominal: nominal.report.latency_us,
        ),
    )
}
