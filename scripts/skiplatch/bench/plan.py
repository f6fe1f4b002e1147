"""Plans of the bench: what is injected, how often, and what disturbs it meanwhile."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign import InputPath, Kind, Nominal, read_nominal
from skiplatch.campaign.toml_positions import KeyPath, Position, key_positions
from skiplatch.campaign.toml_text import parse_toml, read_toml_text
from skiplatch.errors import InputError, hint, quoted
from skiplatch.units import S_PER_MIN, US_PER_S

FORMAT = "skiplatch-bench-plan/1"
PATHS = {path.name.lower(): path for path in InputPath}


@dataclass(frozen=True, slots=True)
class Load:
    """What disturbs the bench.

    Attributes:
        cpu_share: Part of the time that a busy process takes, 0 for none.
        cpu_period_us: It is busy for its share of each such period.
        cpu_priority: Its SCHED_FIFO priority; 0 for usual scheduling.
        bus_frames_per_s: Frames with a foreign id, 0 for none.
        debounce_us: Debounce period of the line; the kernel's, 0 for none.
    """

    cpu_share: float = 0.0
    cpu_period_us: float = 10_000.0
    cpu_priority: int = 0
    bus_frames_per_s: float = 0.0
    debounce_us: int = 0


UNLOADED = Load()


@dataclass(frozen=True, slots=True)
class Plan:
    """What `skiplatch bench run` plays.

    Attributes:
        touches: On each path, for each scan period.
        paths: Input paths, one after the other.
        feeds_mm_min: Feeds, mixed at random.
        scan_us: Scan periods, one campaign each.
        rate_per_s: Touches a second.
        pulse_us: How long the probe stays deflected.
        approach_mm: From the start of the virtual move to the surface.
        load: What disturbs the bench.
        nominal: What is believed of the bench.
    """

    touches: int
    paths: tuple[InputPath, ...]
    feeds_mm_min: tuple[float, ...]
    scan_us: tuple[int, ...]
    rate_per_s: float
    pulse_us: int
    approach_mm: float
    load: Load
    nominal: Nominal

    def believed(self, scan_us: int) -> Nominal:
        """Give nominal.toml of the campaign with this scan period."""
        return replace(self.nominal, plc=replace(self.nominal.plc, scan_us=float(scan_us)))

    def travel_us(self, feed_mm_min: float) -> float:
        """Give the time from the start of a move to the surface."""
        accel = self.nominal.axis.accel_mm_s2
        speed = min(feed_mm_min / S_PER_MIN, float(np.sqrt(2.0 * accel * self.approach_mm)))
        return (self.approach_mm / speed + speed / (2.0 * accel)) * US_PER_S


@dataclass(frozen=True, slots=True)
class _Number:
    """What may stand for a number, or for each of a list of them."""

    low: float
    high: float
    is_whole: bool = False
    is_list: bool = False
    default: float | None = None

    @property
    def words(self) -> str:
        kind = "a whole number" if self.is_whole else "a number"
        words = f"{kind} from {self.low:.15g} to {self.high:.15g}"
        return f"{words}, or a list of them" if self.is_list else words

    def fits(self, value: object) -> bool:
        if isinstance(value, list):
            return self.is_list and bool(value) and all(self._fits_one(v) for v in value)
        return self._fits_one(value)

    def _fits_one(self, value: object) -> bool:
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
        return self.low <= value <= self.high and (not self.is_whole or value == int(value))


_NUMBERS: Mapping[KeyPath, _Number] = {
    ("touches",): _Number(1, 1_000_000, is_whole=True),
    ("feeds_mm_min",): _Number(0.1, 100_000, is_list=True),
    ("scan_us",): _Number(100, 20_000, is_whole=True, is_list=True, default=4000),
    ("rate_per_s",): _Number(0.001, 10_000),
    ("pulse_us",): _Number(1, 10_000_000, is_whole=True),
    ("approach_mm",): _Number(0.000_1, 1000),
    ("load", "cpu_share"): _Number(0, 0.95, default=UNLOADED.cpu_share),
    ("load", "cpu_period_us"): _Number(100, 1_000_000, default=UNLOADED.cpu_period_us),
    ("load", "cpu_priority"): _Number(0, 99, is_whole=True, default=UNLOADED.cpu_priority),
    ("load", "bus_frames_per_s"): _Number(0, 1_000_000, default=UNLOADED.bus_frames_per_s),
    ("load", "debounce_us"): _Number(0, 65_535, is_whole=True, default=UNLOADED.debounce_us),
}
_FORMAT: KeyPath = ("format",)
_PATHS: KeyPath = ("paths",)
_NOMINAL: KeyPath = ("nominal",)
_TABLE = "load"
_KNOWN: tuple[KeyPath, ...] = (_FORMAT, _NOMINAL, _PATHS, *_NUMBERS)


def read_plan(
    path: str | os.PathLike[str], nominal_path: str | os.PathLike[str] | None = None
) -> Plan:
    """Read a plan, and the nominal.toml that it names unless another one is given.

    Raises:
        InputError: A file cannot be read; a key is unknown or missing; a value is of the wrong
            type, out of range, or cannot be played together with the others.
    """
    path = Path(path)
    text = read_toml_text(path)
    document = _Document(path, _entries(parse_toml(path, text)), key_positions(text))
    document.check_keys()
    beliefs = Path(nominal_path) if nominal_path else path.parent / document.text(_NOMINAL)
    plan = _plan(document, read_nominal(beliefs))
    if plan.nominal.kind is not Kind.BENCH:
        raise InputError(beliefs, None, None, 'kind: expected "bench" to record on a bench')
    _refuse_impossible(document, plan)
    return plan


def _plan(document: "_Document", nominal: Nominal) -> Plan:
    load = Load(
        cpu_share=document.number("load", "cpu_share"),
        cpu_period_us=document.number("load", "cpu_period_us"),
        cpu_priority=int(document.number("load", "cpu_priority")),
        bus_frames_per_s=document.number("load", "bus_frames_per_s"),
        debounce_us=int(document.number("load", "debounce_us")),
    )
    return Plan(
        touches=int(document.number("touches")),
        paths=document.paths(),
        feeds_mm_min=document.numbers("feeds_mm_min"),
        scan_us=tuple(int(scan) for scan in document.numbers("scan_us")),
        rate_per_s=document.number("rate_per_s"),
        pulse_us=int(document.number("pulse_us")),
        approach_mm=document.number("approach_mm"),
        load=load,
        nominal=nominal,
    )


def _refuse_impossible(document: "_Document", plan: Plan) -> None:
    """Refuse a rate at which one touch would run into the next.

    A trigger is delayed by up to a scan period, and one of the busy process, so that edges fall
    anywhere in both; the line has to rest for a scan, a debounce period or the way to the surface,
    whichever is longest.
    """
    slowest = min(plan.feeds_mm_min)
    scan_us = max(plan.scan_us)
    delay_us = scan_us + (plan.load.cpu_period_us if plan.load.cpu_share else 0.0)
    rest_us = max(plan.travel_us(slowest), scan_us, plan.load.debounce_us)
    needed_us = delay_us + plan.pulse_us + rest_us
    period_us = US_PER_S / plan.rate_per_s
    if needed_us > period_us:
        message = (
            f"{plan.rate_per_s:g} touches a second leave {period_us:.0f} µs for each, but delay, "
            f"pulse and the way at {slowest:g} mm/min take {needed_us:.0f} µs; give at most "
            f"{_floor(US_PER_S / needed_us):g}, or shorten approach_mm or pulse_us"
        )
        raise document.error(("rate_per_s",), message)


def _floor(rate: float) -> float:
    """Round down to three digits, so that the proposal itself is possible."""
    unit = 10.0 ** (np.floor(np.log10(rate)) - 2)
    return float(np.floor(rate / unit) * unit)


@dataclass(frozen=True, slots=True)
class _Document:
    """What stands in the file, by key, and where it stands."""

    path: Path
    entries: Mapping[KeyPath, object]
    positions: Mapping[KeyPath, Position]

    def check_keys(self) -> None:
        """Complain of another format, then of the first unknown key, else of a missing one."""
        self._require(_FORMAT)
        if self.entries[_FORMAT] != FORMAT:
            raise self._wrong(_FORMAT, quoted(FORMAT))
        for key in self.entries:
            if key == (_TABLE,):
                raise self._wrong(key, "a table")
            if key not in _KNOWN:
                name = ".".join(key)
                known = [".".join(path) for path in _KNOWN]
                raise self.error(key, f"unknown key {quoted(name)}{hint(name, known)}")
        for key in _KNOWN:
            if key not in _NUMBERS or _NUMBERS[key].default is None:
                self._require(key)

    def text(self, key: KeyPath) -> str:
        """Give a text or complain of it."""
        value = self.entries[key]
        if not isinstance(value, str) or not value:
            raise self._wrong(key, "a text")
        return value

    def paths(self) -> tuple[InputPath, ...]:
        """Give the input paths or complain of them."""
        names = self.entries[_PATHS]
        if (
            not isinstance(names, list)
            or not names
            or len(set(map(str, names))) < len(names)
            or any(name not in tuple(PATHS) for name in names)
        ):
            raise self._wrong(_PATHS, 'a list of "skip", "plc" or both')
        return tuple(PATHS[name] for name in names)

    def number(self, *key: str) -> float:
        """Give a number or complain of it."""
        (value,) = self.numbers(*key)
        return value

    def numbers(self, *key: str) -> tuple[float, ...]:
        """Give a list of numbers, a single one as a list of one, or complain of it."""
        known = _NUMBERS[key]
        value: Any = self.entries.get(key, known.default)
        if not known.fits(value):
            raise self._wrong(key, known.words)
        return tuple(map(float, value)) if isinstance(value, list) else (float(value),)

    def error(self, key: KeyPath, message: str) -> InputError:
        """Give the complaint with the place of the key."""
        place = self.positions.get(key) or self.positions.get(key[:1])
        return InputError(self.path, place.line if place else None, None, message)

    def _require(self, key: KeyPath) -> None:
        if key not in self.entries:
            raise InputError(self.path, None, None, f"missing key {quoted('.'.join(key))}")

    def _wrong(self, key: KeyPath, expected: str) -> InputError:
        got = quoted(str(self.entries[key]))
        return self.error(key, f"{'.'.join(key)}: expected {expected}, got {got}")


def _entries(tables: Mapping[str, Any]) -> dict[KeyPath, object]:
    """Lay the keys of the one table out flat."""
    entries: dict[KeyPath, object] = {}
    for name, value in tables.items():
        if name == _TABLE and isinstance(value, dict):
            entries |= {(name, key): inner for key, inner in value.items()}
        else:
            entries[name,] = value
    return entries
