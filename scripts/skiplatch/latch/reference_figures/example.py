"""The document's worked example: where in the scan the edge comes decides what is measured."""

import numpy as np

from skiplatch.campaign import InputPath
from skiplatch.latch.probing import Probing, one_touch
from skiplatch.latch.reference_figures.model import FAST_MM_MIN, IDEAL, ReferenceFigure, certain
from skiplatch.units import US_PER_S

FIRST_WAIT_US = 3250.0
SECOND_WAIT_US = 750.0


def example_figures(seed: int) -> list[ReferenceFigure]:
    """Two edges in the scan: one is seen 3.25 ms later, the other 0.75 ms later."""
    probing = one_touch(IDEAL, InputPath.PLC, FAST_MM_MIN)
    first = deviation_um(probing, FIRST_WAIT_US, seed)
    second = deviation_um(probing, SECOND_WAIT_US, seed)
    return [
        ReferenceFigure(
            name=f"way until the scan, {name}, 4 ms, 3000 mm/min",
            unit="µm",
            document=document,
            last_place=last_place,
            simulated=certain(simulated),
            note=note,
        )
        for name, document, last_place, simulated, note in (
            ("3.25 ms later", 162.0, 1.0, first, "printed in mm, cut off after the third decimal"),
            ("0.75 ms later", 37.0, 1.0, second, "printed in mm, cut off after the third decimal"),
            ("difference", 125.0, 0.0, first - second, ""),
        )
    ]


def deviation_um(probing: Probing, wait_us: float, seed: int) -> float:
    """Play a touch whose edge waits so long for the scan.

    A first touch shows where the scan stands; the second one starts as much later or earlier.
    """
    start_us = (wait_from_zero_us(probing, seed) - wait_us) % probing.nominal.plc.scan_us
    touches = probing.at(np.array([start_us / US_PER_S]))
    return float(probing.play(touches, seed=seed).deviation_um[0, 0])


def wait_from_zero_us(probing: Probing, seed: int) -> float:
    """Tell how long the edge of a touch that starts at time 0 waits for its latch."""
    outcomes = probing.play(probing.at(np.zeros(1)), seed=seed)
    return float(outcomes.latch_us[0, 0] - outcomes.true_edge_us[0, 0])
