"""A campaign played over again with effects, in the columns that were recorded of it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray
from skiplatch.campaign import Status, Touches
from skiplatch.campaign.column_kinds import NOT_RECORDED
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.playing import Outcomes
from skiplatch.units import US_PER_S

CAMPAIGNS = 4
OUTCOMES = ("edge_us", "latch_us", "report_us", "deviation_um")


def replayed(
    scene: Scene,
    rows: BoolArray | NDArray[np.intp],
    rig: Rig,
    *,
    seed: int,
    campaigns: int = CAMPAIGNS,
) -> list[Scene]:
    """Play some of the touches on a rig, a few times over.

    Args:
        scene: The touches.
        rows: Those that are wanted; shape (n,), or their numbers.
        rig: What to play on.
        seed: Of the plays.
        campaigns: How often.
    """
    # Moves that wait for the recorded scans have what chance made of these in them already.
    free = replace(rig, scans={})
    outcomes = free.play(scene.touches, seed=seed, replicates=campaigns)
    columns = (as_recorded(scene.touches, outcomes, k) for k in range(campaigns))
    # Beliefs that the rig has moved are no gap in what it plays.
    return [Scene(rig.nominal, touches, physics=scene.physics).select(rows) for touches in columns]


def begun_anywhere(scene: Scene, *, seed: int) -> Scene:
    """Let the touches of scans begin up to a scan later, each by chance.

    Of moves that were begun along with the scans the times tell when the scans were.
    """
    touches, scan_s = scene.touches, scene.nominal.plc.scan_us / US_PER_S
    later_s = np.random.default_rng(seed).uniform(0.0, scan_s, len(touches))
    time_s = touches.time_s + np.where(scene.plc, later_s, 0.0)
    return Scene(scene.nominal, replace(touches, time_s=time_s), physics=scene.physics)


def as_recorded(touches: Touches, outcomes: Outcomes, replicate: int) -> Touches:
    """Give a replicate the columns, and the gaps in them, that the record has."""
    columns = {
        name: np.where(np.isnan(getattr(touches, name)), np.nan, getattr(outcomes, name)[replicate])
        for name in OUTCOMES
    }
    status = np.where(outcomes.ok[replicate], Status.OK, Status.MISSED)
    status = np.where(touches.status == NOT_RECORDED, NOT_RECORDED, status)
    return replace(touches, status=status.astype(touches.status.dtype), **columns)
