"""Captures of logic analysers and oscilloscopes: CSV, VCD, sigrok's .sr."""

import configparser
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from vcd.common import VarType
from vcd.reader import Token, TokenKind, VCDParseError, tokenize

from skiplatch.arrays import FloatArray
from skiplatch.errors import InputError, quoted
from skiplatch.files import foreign_reader
from skiplatch.importing.analyser import RATE, Capture, hertz, only_changes, refuse_times
from skiplatch.importing.capture_csv import Sheet, read_levels, read_sheet
from skiplatch.importing.encodings import IS_WINDOWS, in_utf8
from skiplatch.importing.packed import read_member
from skiplatch.importing.scope_csv import holds_voltages, read_voltages, with_times

MOST_BYTES = 2 * 2**30
MOST_METADATA = 2**20
_HEAD_OF_TWINCAT = 60  # lines, in which it tells of each channel
MOST_TICKS = 2**63
_RATE = re.compile(RATE, re.IGNORECASE)
_ACQUIRED = re.compile(f"Acquisition with .* at {RATE}", re.IGNORECASE)
"""How sigrok says its sample rate in the comment of a VCD."""
_MAGNITUDES = (1, 10, 100)
"""Of a $timescale, as IEEE 1364 has it."""
_S_OF_UNIT = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "ps": 1e-12, "fs": 1e-15}


def read_capture(path: Path) -> Capture:
    """Read a capture by its ending.

    Raises:
        InputError: It cannot be read.
    """
    readers = {".vcd": _read_vcd, ".sr": _read_sigrok}
    return readers.get(path.suffix.lower(), _read_csv)(path)


def _read_csv(path: Path) -> Capture:
    sheet = read_sheet(path)
    _refuse_twincat(path, sheet)
    sheet = with_times(sheet)
    capture = (read_voltages if holds_voltages(sheet) else read_levels)(path, sheet)
    if not sheet.is_windows:
        return capture
    return replace(capture, assumed=(*capture.assumed, IS_WINDOWS))


def _refuse_twincat(path: Path, sheet: Sheet) -> None:
    """Refuse an export of TwinCAT Scope, in which each channel has times of its own."""
    above = (row[0] for _, row in sheet.rows[:_HEAD_OF_TWINCAT] if row)
    if any(cell.startswith("SampleTime[") for cell in above):
        message = (
            "an export of TwinCAT Scope, with times for each channel, is not read: write one "
            'column "Time [ms]" and one of 0 and 1 for each channel'
        )
        raise InputError(path, None, None, message)


def _read_vcd(path: Path) -> Capture:
    found: dict[str, list[tuple[float, float]]] = {}
    name_of: dict[str, str] = {}
    stamps: list[tuple[int, int]] = []
    scale, now, step_s = 1e-9, 0, None
    assumed: tuple[str, ...] = ("times are in ns, as the VCD has no $timescale",)
    for token in _vcd_tokens(path):
        if token.kind is TokenKind.TIMESCALE:
            scale, assumed = _timescale(path, token), ()
        elif token.kind is TokenKind.COMMENT and (sampled := _ACQUIRED.search(token.comment)):
            step_s = 1.0 / hertz(path, sampled)
        elif token.kind is TokenKind.VAR and token.var.type_ in (VarType.wire, VarType.reg):
            name_of[token.var.id_code] = token.var.reference
            found[token.var.reference] = []
        elif token.kind is TokenKind.CHANGE_TIME:
            now = token.time_change
            if now > MOST_TICKS:
                raise InputError(path, token.span.start.line, 1, "expected times up to 2^63")
            stamps.append((now, token.span.start.line))
        elif token.kind is TokenKind.CHANGE_SCALAR:
            code, value = token.scalar_change.id_code, token.scalar_change.value
            if code in name_of and value in "01":
                found[name_of[code]].append((now * scale, float(value)))
    refuse_times(path, np.array([t for t, _ in stamps]) * scale, [line for _, line in stamps])
    channels = {name: np.array(pairs) for name, pairs in found.items() if pairs}
    if not channels:
        raise InputError(path, None, None, "expected wires that change, found none")
    changes = {n: only_changes(c[:, 0], c[:, 1]) for n, c in channels.items()}
    return Capture(changes, step_s, assumed)


def _timescale(path: Path, token: Token) -> float:
    """Give the unit of the times in s."""
    magnitude, unit = int(token.timescale.magnitude), token.timescale.unit.value
    if magnitude not in _MAGNITUDES:
        message = f"expected a $timescale of 1, 10 or 100 units, got {magnitude} {unit}"
        raise InputError(path, token.span.start.line, token.span.start.column, message)
    return magnitude * _S_OF_UNIT[unit]


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
    step_s = 1.0 / hertz(path, rate)
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
        metadata = read_member(path, archive, "metadata", MOST_METADATA)
        meta.read_string(metadata.decode())
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
        elif match := re.fullmatch(rf"{re.escape(stem)}-([0-9]+)", name):
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
