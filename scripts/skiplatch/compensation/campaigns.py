"""An experiment as campaigns: what somebody would have recorded of it.

The control knows one figure of a probe: how far past the surface the tip goes. Before compensation
the engineer has it from the mean pretravel and the delay. After it, pretravel and delay add up to
the same in all directions at whatever feed the table gives, so it is that figure and no delay.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign import Nominal, Touches, write_campaign
from skiplatch.compensation import firmware
from skiplatch.compensation.experiment import Result, Survey
from skiplatch.compensation.rigs import US_PER_MS
from skiplatch.compensation.touching import Recording

FloatArray = NDArray[np.float64]

BEFORE = "before"
AFTER = "after"


def record(folder: Path, result: Result) -> None:
    """Write the campaigns `before`, ring and map, and `after`, the map at the table's feeds.

    Raises:
        InputError: A folder cannot be written.
    """
    touches = _joined([*(_about_own_centre(ring) for ring in result.rings), _map(result.before)])
    tau_ms = result.tau.tau_ms
    way_um = firmware.pretravel_um(0.0, result.rig.feed_mm_min, tau_ms)
    pretravel_um = float(result.before.mean_um.mean()) - way_um
    write_campaign(folder / BEFORE, _believed(result, pretravel_um, tau_ms), touches)
    after_um = float(result.after.mean_um.mean())
    write_campaign(folder / AFTER, _believed(result, after_um, 0.0), _map(result.after))


def _about_own_centre(ring: Recording) -> Touches:
    found = firmware.fit(ring.points_um.mean(axis=0), firmware.Shape.CIRCLE)
    return ring.about(found.centre_um)


def _map(survey: Survey) -> Touches:
    return survey.recording.about(survey.centre_um)


def _believed(result: Result, pretravel_um: float, tau_ms: float) -> Nominal:
    """Give the chain of somebody who knows one figure for all directions."""
    nominal = result.rig.nominal
    latch_us = nominal.input.filter_us + nominal.skip.latency_us + nominal.skip.jitter_us / 2.0
    delay_us = max(tau_ms * US_PER_MS - latch_us, 0.0)
    return replace(
        nominal,
        probe=replace(
            nominal.probe, pretravel_um=round(pretravel_um, 3), delay_us=round(delay_us, 1)
        ),
    )


def _joined(parts: Sequence[Touches]) -> Touches:
    return Touches.from_columns(
        **{
            name: np.concatenate([part.columns()[name] for part in parts])
            for name in parts[0].columns()
        }
    )
