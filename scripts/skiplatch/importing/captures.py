"""Captures of logic analysers: CSV of Saleae or sigrok, VCD, sigrok's .sr."""

import configparser
import csv
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from vcd.common import VarType
from vcd.reader import Token, TokenKind, VCDParseError, tokenize

from skiplatch.arrays import FloatArray
from skiplatch.campaign.csv_text import delimiter_of
from skiplatch.errors import InputError, quoted
from skiplatch.files import foreign_reader
from skiplatch.importing.decimal_marks import Marks
from skiplatch.importing.encodings import in_utf8
from skiplatch.importing.log_lines import read_text
from skiplatch.units import NS_PER_S

MOST_BYTES = 2 * 2**30
MOST_TICKS = 2**63
_RATE = re.compile(r"(\d+\.?\d*)\s*([kMG]?)Hz", re.IGNORECASE)
_ACQUIRED = re.compile(r"Acquisition with .* at (\d+\.?\d*)\s*([kMG]?)Hz", re.IGNORECASE)
"""How sigrok says its sample rate in the comment of a VCD."""
_SAMPLED = re.compile(r"^;.*?Samplerate:\s*(\d+\.?\d*)\s*([kMG]?)Hz", re.IGNORECASE | re.MULTILINE)
_CHANNELS = re.compile(r"^;\s*Channels[^:]*:\s*(.+)$", re.IGNORECASE | re.MULTILINE)
_LEVELS = {"0": 0.0, "1": 1.0, "0.0": 0.0, "1.0": 1.0, "X": np.nan}
_S_OF_UNIT = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "ps": 1e-12, "fs": 1e-15}
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


def read_capture(path: Path) -> Capture:
    """Read a capture by its ending.

    Raises:
        InputError: It cannot be read.
    """
    readers = {".vcd": _read_vcd, ".sr": _read_sigrok}
    return readers.get(path.suffix.lower(), _read_csv)(path)


def _read_csv(path: Path) -> Capture:
    """Read a column for each channel, as Saleae's Logic or sigrok export them.

    Saleae puts a time before each change; sigrok a row for each sample, and the sample rate into a
    comment.
    """
    text = read_text(path)
    lines = [line for line in text.splitlines() if line.strip() and line[0] not in "#;"]
    delimiter = delimiter_of(lines[0] if lines else "")
    try:
        rows = list(csv.reader(lines, skipinitialspace=True, delimiter=delimiter))
    except csv.Error as error:
        raise InputError(path, None, None, f"no CSV: {error}") from error
    if delimiter != ",":  # as a spreadsheet writes it that has a decimal comma
        marks = Marks()
        rows = [row for _, row in marks.with_points((0, row) for row in rows)]
        marks.refuse_doubtful(path, {0})
    head = [cell.strip() for cell in rows[0]] if rows else [""]
    if head[0].lower().startswith("time"):
        times = _times(path, [row[0] for row in rows[1:]])
        names, levels = head[1:], _levels(path, [row[1:] for row in rows[1:]], len(head) - 1)
        return Capture(_by_name(times, names, levels), _step(times))
    if sampled := _SAMPLED.search(text):
        step_s = 1.0 / _hertz(path, sampled)
        channels = _CHANNELS.search(text)
        names = [name.strip() for name in channels[1].split(",")] if channels else head
        levels = _levels(path, rows[1:], len(names))
        return Capture(
            _by_name(np.arange(len(levels), dtype=np.float64) * step_s, names, levels), step_s
        )
    expected = 'expected a header such as "Time [s],Channel 0,Channel 1"'
    raise InputError(path, 1, None, expected)


def _hertz(path: Path, match: re.Match[str]) -> float:
    try:
        found = float(match[1]) * _TIMES[match[2].lower()]
    except ValueError:
        found = 0.0
    if found <= 0.0:
        raise InputError(path, None, None, f"expected a sample rate above 0, got {match[0]}")
    return found


def _times(path: Path, texts: list[str]) -> FloatArray:
    """Give times in s: numbers, or dates of ISO 8601 since the first."""
    try:
        if not any("T" in text for text in texts):
            return _all_finite(np.array([float(text) for text in texts]))
        stamps = np.array([text.strip().split("+")[0].rstrip("Z") for text in texts], "M8[ns]")
        return np.asarray((stamps - stamps[:1]).astype(np.float64) / NS_PER_S)
    except (ValueError, OverflowError) as error:
        raise InputError(path, None, None, f"expected times: {error}") from error


def _all_finite(times: FloatArray) -> FloatArray:
    """Give the times, or raise ValueError."""
    if not np.isfinite(times).all():
        raise ValueError("one is not finite")
    return times


def _levels(path: Path, rows: list[list[str]], count: int) -> FloatArray:
    """Give levels 0 and 1, NaN where a channel was off; shape (n, count)."""
    try:
        levels = [[_LEVELS[cell.strip().upper()] for cell in row[:count]] for row in rows]
        found = np.array(levels, dtype=float)
    except (KeyError, ValueError) as error:
        raise InputError(path, None, None, f"expected levels 0 and 1: {error}") from error
    if found.ndim != 2 or found.shape[1] != count or not count:
        raise InputError(path, None, None, "expected rows of a time and levels")
    return found


def _by_name(
    times: FloatArray, names: list[str], levels: FloatArray
) -> dict[str, tuple[FloatArray, FloatArray]]:
    known = [~np.isnan(levels[:, i]) for i in range(len(names))]
    return {
        name: _changes(times[rows], levels[rows, i])
        for i, (name, rows) in enumerate(zip(names, known, strict=True))
        if rows.any()
    }


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
    scale, now, step_s = 1e-9, 0, None
    for token in _vcd_tokens(path):
        if token.kind is TokenKind.TIMESCALE:
            magnitude, unit = int(token.timescale.magnitude), token.timescale.unit.value
            scale = magnitude * _S_OF_UNIT[unit]
        elif token.kind is TokenKind.COMMENT and (sampled := _ACQUIRED.search(token.comment)):
            step_s = 1.0 / _hertz(path, sampled)
        elif token.kind is TokenKind.VAR and token.var.type_ in (VarType.wire, VarType.reg):
            name_of[token.var.id_code] = token.var.reference
            found[token.var.reference] = []
        elif token.kind is TokenKind.CHANGE_TIME:
            now = token.time_change
            if now > MOST_TICKS:
                raise InputError(path, None, None, "expected times up to 2^63")
        elif token.kind is TokenKind.CHANGE_SCALAR:
            code, value = token.scalar_change.id_code, token.scalar_change.value
            if code in name_of and value in "01":
                found[name_of[code]].append((now * scale, float(value)))
    channels = {name: np.array(pairs) for name, pairs in found.items() if pairs}
    if not channels:
        raise InputError(path, None, None, "expected wires that change, found none")
    return Capture({n: _changes(c[:, 0], c[:, 1]) for n, c in channels.items()}, step_s)


def _vcd_tokens(path: Path) -> Iterator[Token]:
    with (
        foreign_reader(path, MOST_BYTES, "VCD"),
        in_utf8(path) as plain,
        plain.open("rb") as file,
    ):
        try:
            yield from tokenize(file)
        except VCDParseError as error:
            raise InputError(path, error.loc.line, error.loc.column, "not valid VCD") from error


def _read_sigrok(path: Path) -> Capture:
    """Read a session of sigrok: a zip of metadata and samples, a bit a channel."""
    device, samples = _sigrok_session(path)
    rate = _RATE.search(device.get("samplerate", ""))
    if not rate:
        raise InputError(path, None, None, "the session does not say its sample rate")
    step_s = 1.0 / _hertz(path, rate)
    size = _sigrok_unit(path, device)
    if not samples:
        raise InputError(path, None, None, "the session holds no samples")
    units = np.frombuffer(samples[: len(samples) // size * size], dtype="u1").reshape(-1, size)
    names = {
        int(key.removeprefix("probe")): name
        for key, name in device.items()
        if re.fullmatch(r"probe[1-9]\d{0,3}", key, re.ASCII)
    }
    return Capture(dict(_bits(units, names, step_s)), step_s)


def _sigrok_session(path: Path) -> tuple[dict[str, str], bytes]:
    """Give what the session says of its device, and the samples."""
    with foreign_reader(path, MOST_BYTES, "session of sigrok"), zipfile.ZipFile(path) as archive:
        meta = configparser.ConfigParser(interpolation=None)
        meta.read_string(archive.read("metadata").decode())
        device = dict(meta["device 1"])
        parts = sorted(_parts(archive, device["capturefile"]))
        if sum(archive.getinfo(name).file_size for _, name in parts) > MOST_BYTES:
            raise InputError(path, None, None, f"more than {MOST_BYTES} bytes of samples")
        return device, b"".join(archive.read(name) for _, name in parts)


def _sigrok_unit(path: Path, device: Mapping[str, str]) -> int:
    """Give the bytes of a sample."""
    text = device.get("unitsize", "1")
    if not re.fullmatch(r"[1-9]\d{0,2}", text, re.ASCII):
        raise InputError(path, None, None, f"expected a unitsize of 1 to 999, got {quoted(text)}")
    return int(text)


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
