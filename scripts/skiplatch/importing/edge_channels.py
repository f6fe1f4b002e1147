"""Which channels of a capture are the probe and the latches."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from skiplatch.campaign import InputPath
from skiplatch.errors import InputError, hint, quoted
from skiplatch.importing.analyser import Capture


@dataclass(frozen=True, slots=True)
class Channels:
    """Channels by name or number; those of None are guessed, but for the last two."""

    probe: str | None = None
    """The injected edge."""
    latch: str | None = None
    """Changes at the latch of the skip input."""
    report: str | None = None
    """Changes at the report."""
    plc_latch: str | None = None
    """Changes at the latch of the PLC task."""


@dataclass(frozen=True, slots=True)
class Named:
    """The channels that were found."""

    probe: str
    latches: Mapping[InputPath, str]
    report: str | None


def channels_of(path: Path, capture: Capture, wanted: Channels) -> Named:
    """Take the channels that are named, else those whose names say so, else the first two.

    Raises:
        InputError: One is not in the capture or is noise alone, or too few change.
    """
    given = {
        field: _named(path, capture, name)
        for field in ("probe", "latch", "report", "plc_latch")
        if (name := getattr(wanted, field)) is not None
    }
    _refuse_shared(path, given)
    probe, latch, plc = given.get("probe"), given.get("latch"), given.get("plc_latch")
    free = [
        name
        for name, (times, _) in capture.changes.items()
        if len(times) > 1 and name not in (*given.values(), *capture.noise)
    ]
    probe = probe or _like(free, ("probe", "edge", "trig", "touch", "in")) or next(iter(free), "")
    if not latch and not plc:
        others = [name for name in free if name != probe]
        latch = _like(others, ("latch", "skip", "out", "ack")) or next(iter(others), "")
    if not probe or not (latch or plc):
        names = ", ".join(n + " (noise)" * (n in capture.noise) for n in capture.changes)
        raise InputError(path, None, None, f"expected two channels that change; there are: {names}")
    latches = {InputPath.SKIP: latch, InputPath.PLC: plc}
    return Named(probe, {p: n for p, n in latches.items() if n}, given.get("report"))


def _refuse_shared(path: Path, given: Mapping[str, str]) -> None:
    """Refuse a channel that is to be two things."""
    option_of: dict[str, str] = {}
    for field, name in given.items():
        option = f"--{field.replace('_', '-')}"
        if name in option_of:
            message = (
                f"expected a channel each, got {quoted(name)} for {option_of[name]} and {option}"
            )
            raise InputError(path, None, None, message)
        option_of[name] = option


def _like(names: list[str], words: tuple[str, ...]) -> str | None:
    return next((name for word in words for name in names if word in name.lower()), None)


def _named(path: Path, capture: Capture, name: str) -> str:
    """Give the channel of a name, or of its number."""
    names = list(capture.changes)
    for known in names:
        if name in (known, known.removeprefix("Channel ")) or name.lower() == known.lower():
            _refuse_noise(path, capture, known)
            return known
    message = f"no channel {quoted(name)}{hint(name, names)}; there are: {', '.join(names)}"
    raise InputError(path, None, None, message)


def _refuse_noise(path: Path, capture: Capture, name: str) -> None:
    if name in capture.noise:
        message = f"channel {quoted(name)} swings between no two levels: it is noise, or slopes"
        raise InputError(path, None, None, message)
