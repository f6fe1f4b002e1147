"""Plays that keep to what is known of when: edges that were injected, and the phase of the scans.

A play of its own switches the PLC on at some moment. The recorded rig's was switched on at one, and
its stamps show which: they lie on the grid of the scans, and so will those of further touches.
"""

from dataclasses import replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Touches
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.grid import mean_turn
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import Outcomes
from skiplatch.units import DEG_PER_TURN, US_PER_S

NOISE_EXPLAINS = 1.5
"""Times the noise of the reference instrument, root mean square, that edges may lie off by."""
RESOLVED_US = 0.002  # to which edges are written
KEPT = 0.5
"""Mean of the stamps as turns of the scan, from which on they keep to its grid."""
FEWEST_STAMPS = 16
ON_THE_CLOCK = {"servo_hold": "period_us", "link_slotting": "slot_us"}
"""Effects with a phase on a clock, and the name of their period."""
TIMES = ("edge_us", "latch_us", "report_us", "true_edge_us")


def at_given_edges(rig: Rig, conditions: Touches) -> Touches:
    """Start the moves so that contacts close when a bench is known to have closed them.

    What the noise of the reference instrument explains is left: the rig latched the edge, and not
    its reading.
    """
    played = rig.play(conditions, seed=0, replicates=1)
    off_us = conditions.edge_us - played.true_edge_us[0]
    known = off_us[~np.isnan(off_us)]
    noise_us = NOISE_EXPLAINS * rig.nominal.bench.reference_jitter_us + RESOLVED_US
    if not len(known) or np.sqrt(np.mean(known**2)) <= noise_us:
        return conditions
    return _later(conditions, np.nan_to_num(off_us))


def play_in_phase(
    rig: Rig,
    recorded: Touches,
    conditions: Touches,
    *,
    seed: int,
    replicates: int,
    jobs: int,
) -> Outcomes:
    """Play conditions on the rig of a record: its scans begin when the recorded ones did.

    Where the recorded stamps keep no grid, each replicate has a phase of its own.
    """
    free = rig.play(conditions, seed=seed, replicates=replicates, jobs=jobs)
    period_us = _period_us(rig)
    stamps = recorded.latch_us[recorded.on_plc]
    turn, plc = mean_turn(stamps, period_us), conditions.on_plc
    if not plc.any() or abs(turn) < KEPT or np.isfinite(stamps).sum() < FEWEST_STAMPS:
        return free
    own = mean_turn(free.latch_us[:, plc], period_us)
    later_us = np.angle(own * np.conj(turn)) / (2.0 * np.pi) * period_us
    bound = [
        replace(rig, effects=[_moved(effect, later) for effect in rig.effects]).play(
            _later(conditions, later), seed=seed, replicates=1, first_replicate=replicate
        )
        for replicate, later in enumerate(later_us)
    ]

    def together(name: str) -> FloatArray:
        values = np.concatenate([getattr(one, name) for one in bound])
        back = later_us[:, None] if name in TIMES else 0.0
        return np.asarray(np.where(plc, values - back, getattr(free, name)))

    return replace(
        free,
        edge_us=together("edge_us"),
        latch_us=together("latch_us"),
        report_us=together("report_us"),
        true_edge_us=together("true_edge_us"),
        deviation_um=together("deviation_um"),
        overtravel_um=together("overtravel_um"),
        status=np.where(plc, np.concatenate([one.status for one in bound]), free.status),
    )


def _later(conditions: Touches, by_us: FloatArray | float) -> Touches:
    return replace(conditions, time_s=conditions.time_s + by_us / US_PER_S)


def _moved(effect: Effect, by_us: float) -> Effect:
    """Let what an effect does on the clock come later by as much as the moves do."""
    phase_deg = effect.parameters.get("phase_deg", 0.0)
    if effect.id not in ON_THE_CLOCK or not phase_deg:
        return effect
    period_us = effect.parameters[ON_THE_CLOCK[effect.id]]
    moved_deg = (phase_deg + by_us / period_us * DEG_PER_TURN) % DEG_PER_TURN
    return replace(effect, parameters={**effect.parameters, "phase_deg": moved_deg or DEG_PER_TURN})


def _period_us(rig: Rig) -> float:
    """Give the period of the scans as far as effects change it."""
    changes = [e.parameters["period_us"] for e in rig.effects if e.id == "scan_period"]
    return rig.nominal.plc.scan_us + sum(changes)
