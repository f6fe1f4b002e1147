"""Logic analysers: CSV of Saleae, VCD, sigrok's .sr; which channel is probe, which latch."""

import configparser
import csv
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from vcd.common import VarType
from vcd.reader import TokenKind, VCDParseError, tokenize

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Kind, Touches
from skiplatch.errors import InputError, hint, quoted
from skiplatch.files import failures_named
from skiplatch.importing.log_lines import read_text
from skiplatch.importing.model import Imported

US_PER_S = 1e6
MOST_BYTES = 2 * 2**30
LONGEST_WAIT_S = 1.0  # from an edge to its latch
_RATE = re.compile(r"([\d.]+)\s*([kMG]?)Hz", re.IGNORECASE)
_TIMES = {"": 1.0, "k": 1e3, "m": 1e6, "g": 1e9}


@dataclass(frozen=True, slots=True, eq=False)
class Capture:
    """What a logic analyser saw.

    Attributes:
        changes: For each channel by name: times in s of its changes, and the levels after them.
        step_s: Distance of two samples; None where the file does not say it.
    """

    changes: Mapping[str, tuple[FloatArray, FloatArray]]
    step_s: float | None

    def edges(self, name: str, *, falling: bool) -> FloatArray:
        """Give the times in s of a channel's edges, without its state at first."""
        times, levels = self.changes[name]
        found: FloatArray = times[1:][levels[1:] == (0.0 if falling else 1.0)]
        return found


def read_edges(
    path: Path,
    probe: str | None,
    latch: str | None,
    report: str | None,
    *,
    falling: bool,
    holdoff_s: float,
) -> Imported:
    """Read a capture.

    Args:
        path: The file.
        probe: Channel of the injected edge; the first where none is named.
        latch: Channel that changes at the latch; the second.
        report: Channel that changes at the report, if any.
        falling: Whether the falling edges count rather than the rising ones.
        holdoff_s: Edges of the probe within this time of one before are bounces.

    Raises:
        InputError: It cannot be read, or a channel is not in it.
    """
    capture = read_capture(path)
    probe, latch = _channels(path, capture, probe, latch)
    edges = capture.edges(_named(path, capture, probe), falling=falling)
    first = np.diff(edges, prepend=-np.inf) > holdoff_s
    bounces, edges = int((~first).sum()), edges[first]
    if not len(edges):
        sense = "falling" if falling else "rising"
        raise InputError(path, None, None, f"no {sense} edge on channel {quoted(probe)}")
    zero = edges[0]
    latched = _following(edges, capture.edges(_named(path, capture, latch), falling=falling))
    columns = {
        "touch": np.arange(len(edges)),
        "time_s": edges - zero,
        "edge_us": (edges - zero) * US_PER_S,
        "latch_us": (latched - zero) * US_PER_S,
        "status": np.where(np.isnan(latched), 1, 0),
    }
    if report:
        seen = _following(edges, capture.edges(_named(path, capture, report), falling=falling))
        columns["report_us"] = np.where(np.isnan(latched), np.nan, (seen - zero) * US_PER_S)
    found = Imported(kind=Kind.BENCH, preset="bench", columns=Touches.from_columns(**columns))
    _say(found, capture, (probe, latch, report), bounces, latched)
    return found


def _say(
    found: Imported,
    capture: Capture,
    names: tuple[str, str, str | None],
    bounces: int,
    latched: FloatArray,
) -> None:
    probe, latch, report = names
    reports = f", report {report}" if report else ""
    found.known.append(f"channels: probe {probe}, latch {latch}{reports}")
    found.known.append("edges and latches by one clock: no drift between two can be told")
    missed = int(np.isnan(latched).sum())
    if missed:
        found.known.append(f"{missed} edges without a latch within {LONGEST_WAIT_S:g} s")
    if bounces:
        found.assumed.append(f"{bounces} edges so near to one before are its bounces (--holdoff)")
    if capture.step_s:
        step_us = capture.step_s * US_PER_S
        found.figure("skip", "tick_us", step_us, "distance of two samples of the capture")
        noise_us = step_us / np.sqrt(12.0)
        found.figure("bench", "reference_jitter_us", noise_us, "a sample's width over √12")
    found.assumed.append("the latch output changes at the latch itself, not some time later")


def _channels(
    path: Path, capture: Capture, probe: str | None, latch: str | None
) -> tuple[str, str]:
    """Take the channels that are named, else those whose names say so, else the first two."""
    active = [name for name, (times, _) in capture.changes.items() if len(times) > 1]
    probe = (
        probe or _like(active, ("probe", "edge", "trig", "touch", "in")) or next(iter(active), "")
    )
    others = [name for name in active if name != probe]
    latch = latch or _like(others, ("latch", "skip", "out", "ack")) or next(iter(others), "")
    if not probe or not latch:
        names = ", ".join(capture.changes)
        raise InputError(path, None, None, f"expected two channels that change; there are: {names}")
    return probe, latch


def _like(names: list[str], words: tuple[str, ...]) -> str | None:
    return next((name for word in words for name in names if word in name.lower()), None)


def _named(path: Path, capture: Capture, name: str) -> str:
    """Give the channel of a name, or of its number."""
    names = list(capture.changes)
    for known in names:
        if name in (known, known.removeprefix("Channel ")) or name.lower() == known.lower():
            return known
    message = f"no channel {quoted(name)}{hint(name, names)}; there are: {', '.join(names)}"
    raise InputError(path, None, None, message)


def _following(edges: FloatArray, latches: FloatArray) -> FloatArray:
    """Give the first latch after each edge and before the next; NaN where there is none."""
    index = np.searchsorted(latches, edges, side="left")
    padded = np.append(latches, np.inf)
    latch = padded[index]
    following = np.append(edges[1:], np.inf)
    late = (latch >= following) | (latch - edges > LONGEST_WAIT_S)
    return np.where(late, np.nan, latch)


def read_capture(path: Path) -> Capture:
    """Read a capture by its ending.

    Raises:
        InputError: It cannot be read.
    """
    readers = {".vcd": _read_vcd, ".sr": _read_sigrok}
    return readers.get(path.suffix.lower(), _read_csv)(path)


def _read_csv(path: Path) -> Capture:
    """Read what Saleae's Logic exports: a time in seconds and a column for each channel."""
    lines = [line for line in read_text(path).splitlines() if line.strip() and line[0] not in "#;"]
    rows = list(csv.reader(lines, skipinitialspace=True))
    head = [cell.strip() for cell in rows[0]]
    if not head[0].lower().startswith("time"):
        raise InputError(path, 1, None, 'expected a header such as "Time [s],Channel 0,Channel 1"')
    try:
        numbers = np.array([[float(c) for c in row[: len(head)]] for row in rows[1:] if row])
    except ValueError as error:
        raise InputError(path, None, None, f"expected numbers: {error}") from error
    if numbers.ndim != 2 or numbers.shape[1] < 2:
        raise InputError(path, None, None, "expected rows of a time and levels")
    changes = {name: _changes(numbers[:, 0], numbers[:, i]) for i, name in enumerate(head) if i}
    return Capture(changes, _step(numbers[:, 0]))


def _step(times: FloatArray) -> float | None:
    """Give the distance of samples that all times are multiples of, as far as decimals show it."""
    gaps = np.diff(np.unique(times))
    if not len(gaps):
        return None
    least = float(gaps.min())
    parts = gaps / least
    is_grid = bool((np.abs(parts - np.round(parts)) < 0.02 * np.maximum(parts, 1.0) / 10.0).all())
    return least if is_grid and least > 0 else None


def _changes(times: FloatArray, levels: FloatArray) -> tuple[FloatArray, FloatArray]:
    kept = np.concatenate([[True], np.diff(levels) != 0])
    return times[kept], levels[kept]


def _read_vcd(path: Path) -> Capture:
    found: dict[str, list[tuple[float, float]]] = {}
    name_of: dict[str, str] = {}
    scale, now = 1e-9, 0
    with failures_named(path, "read"), path.open("rb") as file:
        try:
            for token in tokenize(file):
                if token.kind is TokenKind.TIMESCALE:
                    magnitude, unit = int(token.timescale.magnitude), token.timescale.unit.value
                    scale = magnitude * {"s": 1, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}.get(
                        unit, 1e-12 if unit == "ps" else 1e-15
                    )
                elif token.kind is TokenKind.VAR and token.var.type_ in (VarType.wire, VarType.reg):
                    name_of[token.var.id_code] = token.var.reference
                    found[token.var.reference] = []
                elif token.kind is TokenKind.CHANGE_TIME:
                    now = token.time_change
                elif token.kind is TokenKind.CHANGE_SCALAR:
                    code, value = token.scalar_change.id_code, token.scalar_change.value
                    if code in name_of and value in "01":
                        found[name_of[code]].append((now * scale, float(value)))
        except VCDParseError as error:
            raise InputError(path, error.loc.line, error.loc.column, "not valid VCD") from error
    channels = {name: np.array(pairs) for name, pairs in found.items() if pairs}
    if not channels:
        raise InputError(path, None, None, "expected wires that change, found none")
    return Capture({n: _changes(c[:, 0], c[:, 1]) for n, c in channels.items()}, None)


def _read_sigrok(path: Path) -> Capture:
    """Read a session of sigrok: a zip of metadata and samples, a bit a channel."""
    try:
        with failures_named(path, "read"), zipfile.ZipFile(path) as archive:
            meta = configparser.ConfigParser()
            meta.read_string(archive.read("metadata").decode())
            device = meta["device 1"]
            parts = sorted(_parts(archive, device["capturefile"]))
            if sum(archive.getinfo(name).file_size for _, name in parts) > MOST_BYTES:
                raise InputError(path, None, None, f"more than {MOST_BYTES} bytes of samples")
            samples = b"".join(archive.read(name) for _, name in parts)
    except (zipfile.BadZipFile, KeyError, configparser.Error, UnicodeDecodeError) as error:
        raise InputError(path, None, None, "no session of sigrok") from error
    rate = _RATE.search(device.get("samplerate", ""))
    if not rate:
        raise InputError(path, None, None, "the session does not say its sample rate")
    step_s = 1.0 / (float(rate[1]) * _TIMES[rate[2].lower()])
    size = int(device.get("unitsize", "1"))
    if not samples:
        raise InputError(path, None, None, "the session holds no samples")
    units = np.frombuffer(samples[: len(samples) // size * size], dtype="u1").reshape(-1, size)
    names = {
        int(key.removeprefix("probe")): name
        for key, name in device.items()
        if re.fullmatch(r"probe\d+", key)
    }
    return Capture(dict(_bits(units, names, step_s)), step_s)


def _parts(archive: zipfile.ZipFile, stem: str) -> Iterator[tuple[int, str]]:
    for name in archive.namelist():
        if name == stem:
            yield 0, name
        elif match := re.fullmatch(rf"{re.escape(stem)}-(\d+)", name):
            yield int(match[1]), name


def _bits(
    units: "np.typing.NDArray[np.uint8]", names: Mapping[int, str], step_s: float
) -> Iterator[tuple[str, tuple[FloatArray, FloatArray]]]:
    for number, name in sorted(names.items()):
        byte, bit = divmod(number - 1, 8)
        if byte >= units.shape[1]:
            continue
        levels = (units[:, byte] >> bit) & 1
        index = np.append(0, np.flatnonzero(np.diff(levels)) + 1)
        yield name, (index * np.float64(step_s), levels[index].astype(np.float64))
