"""What was recorded of touches, taken apart by the stretches of the chain."""

from collections.abc import Mapping

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.comparison.observables import Recorded
from skiplatch.diagnosis.scene.grid import off_grid
from skiplatch.diagnosis.scene.scene import Scene, rounding_step

LINE = 0.1
"""Share of a coarse step within which values lie on the same line."""
UNITS: Mapping[str, str] = {
    "edge": "µs",
    "latch": "µs",
    "grid": "µs",
    "position": "µm",
    "report": "µs",
}


def observed(
    scene: Scene,
    recorded: Recorded,
    *,
    scan_us: float | None = None,
    moved_um: FloatArray | float = 0.0,
) -> Mapping[str, FloatArray]:
    """Take outcomes apart, as far as was recorded; each of shape (…, n), NaN where it was not.

    The edge after the expected contact, the latch after its begin, the stamp of a scan off the grid
    of the others, the position beyond the way since the begin, and the report after the latch, or
    after the one that the position tells where nobody stamped.

    Args:
        scene: The touches.
        recorded: Their outcomes, recorded or played.
        scan_us: Period of that grid, if it is not the believed one.
        moved_um: Added to positions, shape (…, n).
    """
    edges = scene.touches.edge_us
    contact_us = scene.contact.time_us + recorded.start_delay_us
    begin = np.where(np.isnan(edges), contact_us, recorded.edge_us)
    later = recorded.latch_us - begin
    deviation_um = recorded.deviation_um + moved_um
    beyond = deviation_um - scene.speed * later
    on_grid = np.where(scene.plc & scene.has_stamps, recorded.latch_us, np.nan)
    arrived = later - deviation_um / scene.speed
    return {
        "edge": recorded.edge_us - contact_us,
        "latch": np.where(scene.has_stamps, later, np.nan),
        "grid": off_grid(on_grid, scan_us or scene.nominal.plc.scan_us),
        "position": np.where(scene.has_stamps, beyond, deviation_um),
        "report": np.where(scene.has_arrivals, arrived, recorded.report_us - recorded.latch_us),
    }


def observed_evenly(
    scene: Scene,
    recorded: Recorded,
    resolution_um: float,
    rng: np.random.Generator,
    *,
    scan_us: float | None = None,
) -> Mapping[str, FloatArray]:
    """Do the same with positions that are spread evenly between lines of a counter.

    Plays lie on such lines, and stand still where nothing else scatters; those of a record need
    not lie on the same, where its surfaces lie between two. What lies close to a line that was
    found is on it.

    Args:
        scene: The touches.
        recorded: Their outcomes, recorded or played.
        resolution_um: From one line to the next.
        rng: Spreads them.
        scan_us: As above.
    """
    found = LINE * (resolution_um > scene.nominal.axis.resolution_um)
    share = found if scene.datum_names is None else 1.0
    moved_um = share * resolution_um * (rng.random(recorded.deviation_um.shape) - 0.5)
    return observed(scene, recorded, scan_us=scan_us, moved_um=moved_um)


def before_wait(
    scene: Scene, unit: str, *, is_from_contact: BoolArray | bool
) -> tuple[FloatArray, FloatArray]:
    """Give what is expected of each touch that is latched at once, and what a µs of wait adds.

    Args:
        scene: The touches.
        unit: Of the observable.
        is_from_contact: A time is counted from the expected contact, and from no recorded edge.
    """
    if unit == "µm":
        return scene.pretravel_um + scene.speed * scene.wait_us, scene.speed
    return scene.pretravel_um / scene.speed * is_from_contact, np.ones(len(scene))


def step(scene: Scene, name: str) -> float:
    """Give what an observable is rounded to, in its unit."""
    return rounding_step(scene, UNITS[name])
