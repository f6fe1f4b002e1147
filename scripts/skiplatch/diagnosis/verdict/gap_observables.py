"""What a gap is measured in: what every comparison looks at, and what stamps or arrivals add."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.comparison.observables import OBSERVABLES, Observable, Recorded
from skiplatch.diagnosis.plays.playing import Folds, Rig, has_like_grid
from skiplatch.diagnosis.scene.grid import off_grid
from skiplatch.diagnosis.scene.observed import observed, observed_evenly
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.motion import Contact

NS = 3  # decimals of a µs


def observables(scene: Scene, after: Rig | Folds, seed: int) -> Iterator[Observable]:
    """Give those of every comparison, that of the way to the contact, and two of stamps.

    An edge that was recorded tells when the contact was, whatever came after it. A scan that is
    late moves the stamp of its touch by little of the wait for a scan: it is only beside the other
    stamps that it shows. Nor does a position that is off show in that wait: it does beside the way
    until its own stamp.
    """
    if scene.has_arrivals.any():
        yield from _of_arrivals(scene, after, np.random.default_rng(seed))
        return
    yield from OBSERVABLES

    def met(recorded: Recorded, _: Contact) -> FloatArray:
        return observed(scene, recorded)["edge"]

    if "motion" in scene.streams:
        yield Observable("edge_after_contact_us", "edge − expected contact", "µs", met)

    def beyond(recorded: Recorded, _: Contact) -> FloatArray:
        return np.where(scene.has_stamps, observed(scene, recorded)["position"], np.nan)

    if "position" in scene.streams:
        yield Observable(
            "deviation_beyond_stamp_um", "deviation − way until its stamp", "µm", beyond
        )

    def late(recorded: Recorded, _: Contact) -> FloatArray:
        stamps = np.where(scene.plc, recorded.latch_us, np.nan)
        return np.asarray(np.round(off_grid(stamps, after.scan_us), NS))

    if "lattice" in scene.streams and has_like_grid(after, scene.touches):
        yield Observable("latch_off_scan_grid_us", "latch − grid of scans", "µs", late)


def _of_arrivals(
    scene: Scene, after: Rig | Folds, rng: np.random.Generator
) -> Iterator[Observable]:
    """Give those of positions, and how late arrivals are for the latch that these tell."""

    def arrived(recorded: Recorded, _: Contact) -> FloatArray:
        return observed_evenly(scene, recorded, after.resolution_um, rng)["report"]

    for one in OBSERVABLES:
        if one.name == "report_after_latch_us":
            yield replace(one, values=arrived)
        elif not one.name.startswith("latch"):
            yield one
