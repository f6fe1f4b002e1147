"""A recorded campaign as residuals of the nominal chain, stage by stage.

Each stream is what one stretch of the chain adds, as far as it was recorded: with time stamps and
edges the stretches come apart, and the likelihood is a product over them.
"""

import pickle
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray, IndexArray, drawn
from skiplatch.campaign import Campaign, Nominal
from skiplatch.campaign.datum_names import datum_names, datum_senses
from skiplatch.diagnosis.density.change import NOTHING, Change
from skiplatch.diagnosis.density.datum import SHIFTED
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.scene.grid import WRITTEN_US, keep_grid, mean_turn
from skiplatch.diagnosis.scene.nominal_chain import NominalChain
from skiplatch.diagnosis.scene.nominal_streams import nominal_streams

OF_TOUCHES = frozenset(
    {
        *("is_machine", "plc", "sign", "latched_mm", "false", "has_stamps", "shortest_wave_mm"),
        *("alpha", "alpha_before", "cos_beta", "is_sideways", "shortest_lobe_deg"),
        *("rest_s", "follows", "_axes_beyond_x"),
    }
)
"""Cached properties of a scene that no number of nominal.toml changes."""
OF_MOTION = frozenset({"contact", "speed"})
"""Those that depend on the axis alone, beside the touches."""
OF_TICKS = frozenset({"stamp_step_us"})
"""Those that depend on the believed tick alone, beside the touches."""
OF_SCANS = frozenset({"off_grid_us"})
"""Those that depend on the period of the scans alone."""
OF_DATUM = frozenset({"datum_names", "datum_groups", "datum_count", "datum_senses"})
"""Those that depend on how the datum is free."""
KEPT = 16
"""Scenes that a process keeps that gets them from another one."""


class BelievedPhysics(Protocol):
    """Effects that a rig is believed to have, where touches are made."""

    def change(self, scene: "Scene") -> Change:
        """Give what they make of the physics of the chain."""

    def law(self, scene: "Scene", stream: Stream) -> Law:
        """Give the law of a stream's residuals, all n of them."""


@dataclass(frozen=True, eq=False)
class Scene(NominalChain):
    """A campaign under the nominal chain: streams, datum, and the effects that are believed in."""

    moved_at: int | None = None
    """Number of a touch from which on the datum may be another one."""
    physics: BelievedPhysics | None = None
    """Of the effects in the nominal chain, if there are any."""
    stood_in: frozenset[str] = frozenset()
    """Columns with values that nobody recorded."""
    is_directed: bool = True
    """It was recorded in which direction of the probe touches were made, where that matters."""

    @classmethod
    def of(cls, campaign: Campaign, physics: BelievedPhysics | None = None) -> "Scene":
        """Take a campaign's touches in order of time."""
        return cls(campaign.nominal, campaign.touches.in_order_of_time(), physics=physics)

    def __reduce__(self) -> tuple[object, ...]:
        """Travel to another process, which derives from a scene once what it needs."""
        return _unpacked, (self._packed,)

    @cached_property
    def _packed(self) -> bytes:
        return pickle.dumps(tuple(getattr(self, field.name) for field in fields(self)))

    def select(self, rows: BoolArray | IndexArray) -> "Scene":
        """Give some of the touches."""
        chosen = np.arange(len(self))[rows]
        return replace(self, touches=self.touches.select(rows), whole=self, chosen=chosen)

    def drawn(self, most: int, seed: int) -> "Scene":
        """Give at most so many touches, drawn evenly, in their order."""
        return self if len(self) <= most else self.select(drawn(len(self), most, seed))

    def in_sequence(self, most: int) -> tuple["Scene", IndexArray]:
        """Give the largest scene, of at most so many touches, that this one is a part of.

        And which of its touches these are; shape (n,).
        """
        if self.whole is None or self.chosen is None or len(self.whole) > most:
            return self, np.arange(len(self))
        sequence, rows = self.whole.in_sequence(most)
        return sequence, rows[self.chosen]

    def with_nominal(self, nominal: Nominal) -> "Scene":
        """Give the same touches under another belief."""
        whole = None if self.whole is None else self.whole.with_nominal(nominal)
        moved = replace(self, nominal=nominal, whole=whole)
        kept = set(OF_TOUCHES)
        if nominal.axis == self.nominal.axis:
            kept |= OF_MOTION
        if nominal.plc.scan_us == self.nominal.plc.scan_us:
            kept |= OF_SCANS
        if nominal.skip.tick_us == self.nominal.skip.tick_us:
            kept |= OF_TICKS
        if nominal.datum == self.nominal.datum:
            kept |= OF_DATUM
        # Derived once from what stays the same; beliefs are tried out by the hundred.
        moved.__dict__.update({name: getattr(self, name) for name in kept})
        return moved

    def with_datum_moved(self, touch: int) -> "Scene":
        """Give the same touches, the datum of which may be another one from a touch on."""
        return replace(self, moved_at=touch)

    @cached_property
    def datum_groups(self) -> IndexArray | None:
        """Number of the datum that each touch has, shape (n,); None where it is known."""
        names = self.datum_names
        return None if names is None else np.searchsorted(np.unique(names), names)

    @cached_property
    def datum_names(self) -> NDArray[np.str_] | None:
        """Names of the data of the touches, shape (n,); None where they are known."""
        names = datum_names(self.nominal, self.touches)
        if names is None or self.moved_at is None:
            return names
        return np.char.add(names, np.where(self.touches.touch < self.moved_at, "", " moved"))

    @cached_property
    def datum_count(self) -> int:
        """How many data there are, at least one."""
        return 1 if self.datum_groups is None else int(self.datum_groups.max(initial=0)) + 1

    @property
    def datum_u_um(self) -> float | None:
        """Standard uncertainty of each about 0; None for a datum that may be anywhere."""
        return self.nominal.datum.u_um

    def datum_of(self, stream: Stream) -> IndexArray:
        """Number of the datum of each touch in a stream's rows; 0 where it is known."""
        if self.datum_groups is None:
            return np.zeros(len(stream.indices), dtype=np.intp)
        return self.datum_groups[stream.indices]

    @cached_property
    def datum_senses(self) -> FloatArray:
        """What a µm of its datum adds to how far each touch goes along its approach; shape (n,)."""
        return datum_senses(self.nominal, self.touches)

    def per_datum_um(self, stream: Stream) -> FloatArray:
        """By how much a µm of datum shifts the residuals of a stream; shape (n,)."""
        if stream.name not in SHIFTED:
            return np.zeros(len(self))
        return self.datum_senses / self.speed if stream.unit == "µs" else self.datum_senses

    @cached_property
    def stamp_step_us(self) -> float:
        """What stamps are rounded to: believed ticks, or what they are written to if on none."""
        tick_us, known = self.nominal.skip.tick_us, np.isfinite(self.touches.latch_us)
        turn = complex(mean_turn(self.touches.latch_us[known], tick_us))
        return tick_us if keep_grid(turn) or not known.any() else WRITTEN_US

    @cached_property
    def streams(self) -> dict[str, Stream]:
        """All streams in which something was recorded, by name."""
        return {stream.name: self._as_believed(stream) for stream in nominal_streams(self)}

    @cached_property
    def believed(self) -> Change:
        """What the effects that are believed in make of the physics of the chain."""
        return NOTHING if self.physics is None else self.physics.change(self)

    def with_beliefs(self, change: Change) -> Change:
        """Give a change of the believed rig as one of the chain."""
        return change if self._is_plain else self.believed.joined(change)

    @property
    def _is_plain(self) -> bool:
        return self.physics is None or not self.nominal.believed_effects

    def _as_believed(self, stream: Stream) -> Stream:
        if self.physics is None or self._is_plain:
            return stream
        return replace(stream, law=self.physics.law(self, stream))


@lru_cache(maxsize=KEPT)
def _unpacked(packed: bytes) -> Scene:
    return Scene(*pickle.loads(packed))  # noqa: S301 - packed by the process that asked


def rounding_step(scene: Scene, unit: str) -> float:
    """Give what times, in µs, or lengths, in µm, are rounded to."""
    if unit == "µs":
        return scene.nominal.skip.tick_us
    return scene.nominal.axis.resolution_um
