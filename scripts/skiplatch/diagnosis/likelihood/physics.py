"""Touches, and what differs from the rig that is believed in, laid out for C: see ``physics.h``."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache, reduce
from operator import attrgetter
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.density.change import Change, Number, both
from skiplatch.diagnosis.density.datum import BY_STAMPS
from skiplatch.diagnosis.density.law import SMALLEST, Extra
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.likelihood.scan_wait import other_waits, scan_period_us
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.library import CData, connection, layout

LEAST_U = 1e-12
"""Standard uncertainty in µm of a datum that is known."""


class LaidOut:
    """A structure for C, or an array of some, and what has to live as long."""

    __slots__ = ("__weakref__", "_kept", "at")

    def __init__(self, kind: str, count: int = 1) -> None:
        """Begin with zeros."""
        self.at: CData = connection()[0].new(f"{kind}[]", count)
        self._kept: list[object] = []

    def keep(self, what: object) -> None:
        """Let something live as long."""
        self._kept.append(what)

    def array(self, values: NDArray[Any], kind: str) -> CData:
        """Give a pointer to values, shape (n,), that stay as they are and are as wide in C."""
        pointer = connection()[0].from_buffer(f"{kind}[]", np.ascontiguousarray(values))
        self._kept.append(pointer)
        return pointer


_TOUCHES: WeakKeyDictionary[Scene, LaidOut] = WeakKeyDictionary()
_RECORDED: WeakKeyDictionary[Stream, tuple[LaidOut, LaidOut]] = WeakKeyDictionary()


def touches_of(scene: Scene) -> LaidOut:
    """Lay a scene out, once."""
    if scene not in _TOUCHES:
        _TOUCHES[scene] = _touches(scene)
    return _TOUCHES[scene]


def _touches(scene: Scene) -> LaidOut:
    nominal, laid_out = scene.nominal, LaidOut("sim_touches_t")
    at = laid_out.at[0]
    arrays = {
        "speed": scene.speed,
        "pretravel_um": scene.pretravel_um,
        "wait_us": scene.wait_us,
        "begin_us": scene.begin_us,
        "latch_us": scene.touches.latch_us,
        "deviation_um": scene.touches.deviation_um,
        "datum_senses": scene.datum_senses,
    }
    for name, values in arrays.items():
        setattr(at, name, laid_out.array(np.asarray(values, dtype=np.float64), "double"))
    at.is_plc = laid_out.array(scene.plc.astype(np.uint8), "uint8_t")
    at.n, at.resolution = len(scene), SMALLEST
    at.least_pretravel_um = scene.least_pretravel_um
    at.tick_us, at.jitter_us = nominal.skip.tick_us, nominal.skip.jitter_us
    at.stamp_step_us = scene.stamp_step_us
    at.scan_us, at.resolution_um = nominal.plc.scan_us, nominal.axis.resolution_um
    at.behind_us = nominal.input.filter_us + nominal.skip.latency_us
    at.is_machine, at.is_polled = scene.is_machine, bool(scene.plc.any())
    if scene.datum_groups is not None:
        at.groups = laid_out.array(scene.datum_groups.astype(np.uint32), "uint32_t")
        at.datum_count = scene.datum_count
        at.datum_u_um = 0.0 if scene.datum_u_um is None else max(scene.datum_u_um, LEAST_U)
    return laid_out


def members_of(scene: Scene, parts: Sequence[tuple[Stream, LaidOut, float]]) -> LaidOut:
    """Lay streams out, or parts of them, each with its change and the widening of its law."""
    laid_out = LaidOut("sim_member_t", len(parts))
    for i, (stream, change, widening) in enumerate(parts):
        member = laid_out.at[i]
        laid_out.at[i] = _recorded(stream)[1].at[0]
        member.change, member.widening = change.at, widening
        if change.at[0].slack:
            for path, name in enumerate(BY_STAMPS):
                if name in scene.streams:
                    member.latches[path] = _recorded(scene.streams[name])[0].at
        laid_out.keep((stream, change))
    return laid_out


def _recorded(stream: Stream) -> tuple[LaidOut, LaidOut]:
    """Lay out what was recorded of a stream, and that as a member without a change; once."""
    if stream not in _RECORDED:
        recorded, member = LaidOut("sim_recorded_t"), LaidOut("sim_member_t")
        chain = np.empty(len(stream.residuals), dtype=layout("sim_law_t"))
        fill(chain, stream.chain)
        recorded.at[0].residuals = recorded.array(stream.residuals, "double")
        recorded.at[0].chain = recorded.array(chain, "sim_law_t")
        recorded.at[0].believed = recorded.array(stream.law.offset, "double")
        recorded.at[0].known = recorded.array(stream.rows.astype(np.uint8), "uint8_t")
        member.at[0].stream = number_of(stream.name)
        member.at[0].recorded = recorded.at
        member.at[0].rows = member.array(stream.indices, "uint64_t")
        member.at[0].count = len(stream.indices)
        member.at[0].far = stream.far
        _RECORDED[stream] = recorded, member
    return _RECORDED[stream]


def fill(rows: NDArray[np.void], source: object) -> None:
    """Give structures the values of the attributes that are named like their fields."""
    for name in rows.dtype.fields or ():
        rows[name] = getattr(source, name)


@cache
def number_of(name: str) -> int:
    """Give the number that a stream has in C."""
    return int(getattr(connection()[1], f"SIM_{name.upper()}"))


def line_bonus(scene: Scene, stream: Stream, change: Change) -> FloatArray:
    """Give what the lines of coarse grids add to the likelihood of each touch; shape (n,)."""
    ffi, library = connection()
    members = members_of(scene, [(stream, change_for(scene, change, ()), 0.0)])
    found, bonus = np.zeros(len(scene)), np.zeros(len(stream.indices))
    to = ffi.from_buffer("double[]", bonus, require_writable=True)
    library.sim_line_bonus(touches_of(scene).at, members.at, to)
    found[stream.indices] = bonus
    return found


class _Fields:
    """Fields of a change in C that are of one type, and how a change gives them all at once."""

    def __init__(self, kind: str) -> None:
        fields = connection()[0].typeof("sim_change_t").fields
        named = (name for name, field in fields if field.type.cname == kind)
        self.names = tuple(name for name in named if name in Change.__dataclass_fields__)
        self.of = attrgetter(*self.names)


@cache
def _fields() -> tuple[_Fields, _Fields]:
    """Give the fields of a change in C: numbers by touch, and those that hold for all of them."""
    return _Fields("sim_number_t"), _Fields("double")


def change_for(scene: Scene, change: Change, streams: Collection[str]) -> LaidOut:
    """Lay out a change that is the same throughout, with the extras of some streams."""
    if scene.nominal.arrival_us is not None:
        change = replace(change, stamp_us=change.stamp_us + change.report_us)
    laid_out = LaidOut("sim_change_t")
    at, (by_touch, plain) = laid_out.at[0], _fields()
    for name, number in zip(by_touch.names, by_touch.of(change), strict=True):
        _put(laid_out, at, name, number)
    for name, value in zip(plain.names, plain.of(change), strict=True):
        if value:
            setattr(at, name, value)
    at.scan_us = scan_period_us(scene, change)
    if change.wait is not None:
        at.is_bound, at.unlocked = True, change.wait.unlocked
    if change.slots is not None:
        at.slot_us, at.slot_phase_us = change.slots
    for name in {*streams, *BY_STAMPS} if change.slack else streams:
        extras = extras_of(scene, name, change)
        if extras:
            at.extras[number_of(name)] = _extras(laid_out, extras)
            at.extra_counts[number_of(name)] = len(extras)
    return laid_out


def _put(laid_out: LaidOut, at: CData, name: str, value: Number) -> None:
    """Put a number into a field of a structure that is 0 so far."""
    if isinstance(value, np.ndarray) and value.ndim:
        getattr(at, name).each = laid_out.array(np.asarray(value, dtype=np.float64), "double")
    elif value:
        getattr(at, name).all = value


def _extras(laid_out: LaidOut, extras: Sequence[Extra]) -> CData:
    found = LaidOut("sim_some_t", len(extras))
    for one, extra in zip(found.at, extras, strict=True):
        one.share = extra.share
        for name in ("offset", "width", "mean", "sigma", "boxless"):
            _put(laid_out, one, name, getattr(extra, name))
    laid_out.keep(found)
    return found.at


def extras_of(scene: Scene, name: str, change: Change) -> tuple[Extra, ...]:
    """Give what some touches get on top in a stream; of a deviation in µs."""
    if name == "motion":
        return ()
    if name == "lattice":
        return change.lattice_extra
    if name == "report":
        return change.report_extra
    if name in BY_STAMPS:
        return _latch_extras(scene, name, change)
    beyond = _position_extras(scene, change)
    if name == "position":
        return beyond
    if name == "arrival":
        late = (_beyond(extra, scene.speed) for extra in change.report_extra)
        return both(beyond, tuple(late))
    us_per_um = 1.0 / (scene.speed * change.speed_ratio)
    scaled = tuple(_scaled(extra, us_per_um) for extra in beyond)
    return both(_latch_extras(scene, name, change), scaled)


def _latch_extras(scene: Scene, name: str, change: Change) -> tuple[Extra, ...]:
    if name.endswith("_plc"):
        return _joint(change.pin_extra, change.scan_extra, other_waits(scene, change))
    return _joint(change.pin_extra, change.skip_extra)


def _beyond(late: Extra, speed: FloatArray) -> Extra:
    """Give what a late stamp takes from a position that is counted from it."""
    earliest = np.asarray(late.offset) + late.width
    return Extra(
        late.share,
        offset=-speed * earliest,
        width=speed * late.width,
        mean=-speed * late.mean,
        sigma=speed * late.sigma,
    )


def _position_extras(scene: Scene, change: Change) -> tuple[Extra, ...]:
    width_us = change.position_box_us
    is_boxed = width_us > 0.0 if isinstance(width_us, float) else bool(np.any(width_us > 0.0))
    speed = scene.speed * change.speed_ratio
    box = (Extra(1.0, width=speed * width_us),) if is_boxed else ()
    return _joint(change.position_extra, box)


def _joint(*groups: tuple[Extra, ...]) -> tuple[Extra, ...]:
    """Give the extras of independent causes together."""
    return reduce(both, groups)


def _scaled(extra: Extra, scale: FloatArray) -> Extra:
    return Extra(
        extra.share,
        offset=extra.offset * scale,
        width=extra.width * scale,
        mean=extra.mean * scale,
        sigma=extra.sigma * scale,
        boxless=extra.boxless,
    )
