"""What is known of all touches of a scene, whatever they are held against."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.scene.covariates import (
    Order,
    conditions,
    recorded_only,
    sequence,
)
from skiplatch.diagnosis.scene.observed import UNITS, step
from skiplatch.diagnosis.scene.periodogram import shortest_wave
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.units import US_PER_S

LONGEST = 100_000
"""Touches of which a sequence may have as many as it likes."""
MOSTLY_WAIT = 0.8
"""Scatter of the wait for a scan over that of plays from which on it is nearly all of it. Touches
bound to the scan share the phases of all sixty plays, which tell it to some 6 % alone."""
ALONG = {
    "temperature": "K",
    "approach": "mm",
    "rest before": "s",
    "touches in the 60 s before": "",
    "azimuth": "°",
    "rotary angle": "°",
}
"""Further conditions along which a wave may lie, and their units."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A line along which a wave may lie; arrays of shape (n,).

    Attributes:
        name: For reports.
        unit: Of `where`.
        where: Each touch lies on it.
        sense: What multiplies a score, 1 or -1.
        shortest: Wave that can be told; 0 for what the number of touches lets tell.
    """

    name: str
    unit: str
    where: FloatArray
    sense: FloatArray
    shortest: float = 0.0


@dataclass(frozen=True, eq=False)
class Setting:
    """What is known of all touches of a scene, whatever they are held against.

    Attributes:
        scene: The touches.
        seed: Of what is drawn to look at them.
        longest_scan_us: From one scan to the next where they are played, if not as believed.
    """

    scene: Scene
    seed: int
    longest_scan_us: float | None = None

    @property
    def _scan_us(self) -> float:
        return self.longest_scan_us or self.scene.nominal.plc.scan_us

    @cached_property
    def order(self) -> Order:
        """The sequence of the touches."""
        return Order.of(self.scene)

    @cached_property
    def known(self) -> Mapping[str, FloatArray]:
        """What each could depend on; shape (n,)."""
        whole, rows = self.scene.in_sequence(LONGEST)
        made = {name: values[rows] for name, values in sequence(whole).items()}
        return recorded_only(self.scene, {**conditions(self.scene), **made})

    @cached_property
    def places(self) -> Sequence[Place]:
        """Where waves are looked for."""
        touches, sign = self.scene.touches, self.scene.sign
        along = np.ones(len(self.scene))
        serial = self.order.serial.astype(float)
        found = [Place("serial number", "touches", serial, along, 2.0)]
        if "time" in self.known:
            found.append(Place("time", "s", touches.time_s, along))
        shortest_mm = self.scene.shortest_wave_mm
        if np.isfinite(shortest_mm):
            position = touches.position_mm
            found += [Place("position", "mm", position, s, shortest_mm) for s in (along, sign)]
        for name, unit in ALONG.items():
            values = self.known.get(name)
            if values is not None and np.isfinite(shortest := shortest_wave(values)):
                found.append(Place(name, unit, values, along, shortest))
        return found

    @cached_property
    def irregular_places(self) -> Sequence[Place]:
        """Where waves are looked for of which many lie between two touches.

        When an edge was due tells the phase of all that runs by a clock of its own.
        """
        found = [place for place in self.places if place.name in ("position", *ALONG)]
        if "time" not in self.known:
            return found
        due_s = self.scene.begin_us / US_PER_S
        # Where in the scan an edge falls goes with the time by the very period of the scans.
        shortest_s = 2.0 * self._scan_us / US_PER_S if self.scene.plc.any() else 0.0
        return [Place("time", "s", due_s, np.ones(len(due_s)), shortest_s), *found]

    def repeats_to(self, observable: str) -> float:
        """Give what a touch repeats to in an observable, in its unit; 0 of times."""
        is_probe = UNITS[observable] == "µm" and self.scene.is_machine
        return self.scene.nominal.probe.repeatability_um if is_probe else 0.0

    def is_mostly_wait(
        self, observable: str, path: str, noise: FloatArray, rows: BoolArray
    ) -> bool:
        """Tell whether plays of a path, which scatter so much, do so for the phase of the scan."""
        scene = self.scene
        if path != "plc" or observable not in ("latch", "position"):
            return False
        wait = np.full(len(scene), self._scan_us / np.sqrt(12.0))
        if observable == "position":
            wait = np.where(scene.has_stamps, 0.0, wait * scene.speed)
        return float(np.median(wait[rows] / noise)) > MOSTLY_WAIT

    def step(self, observable: str) -> float:
        """Give what an observable is rounded to, in its unit; of a position, its stamp as well."""
        rounded = step(self.scene, observable)
        if UNITS[observable] == "µs" or not self.scene.has_stamps.any():
            return rounded
        return rounded + self.scene.nominal.skip.tick_us * float(np.median(self.scene.speed))
