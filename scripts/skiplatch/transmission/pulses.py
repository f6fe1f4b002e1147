"""Reading and writing trains of pulses, a block at a time; the layouts are in docs/TRANSMISSION.md.

CSV has the columns ``channel`` (1 input, 2 output, 3 and 4 their index pulses), ``t_ns`` and, if
the machine turned both ways, ``sense`` (1 or -1) and perhaps ``edge`` (1 rising, -1 falling). A
binary file has a head of 16 bytes and 8 bytes a pulse.
"""

import os
import re
import struct
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from skiplatch.errors import InputError, quoted
from skiplatch.files import failures_named, refuse_special_or_large
from skiplatch.numbers import number

INPUT, OUTPUT, INPUT_INDEX, OUTPUT_INDEX = 1, 2, 3, 4
BACKWARD = 128
FALLING = 64
CODED = BACKWARD | FALLING
"""What is added to a channel."""
MAGIC = b"SKLPULS1"
MAGIC_EDGES = b"SKLPULS2"
"""Of files that tell rising from falling edges."""
HEAD = struct.Struct("<8sQ")
WORD_BYTES = 8
TIME_BITS = 61
CHANNEL_SHIFT = np.uint64(TIME_BITS)
CHANNEL_MASK = np.uint64(3)
REVERSE_SHIFT = np.uint64(63)
FALLING_SHIFT = np.uint64(TIME_BITS - 1)
FALLING_BIT = np.uint64(1 << (TIME_BITS - 1))
TIME_MASK = np.uint64((1 << TIME_BITS) - 1)
LATEST_NS = (1 << TIME_BITS) - 1

BLOCK_PULSES = 1 << 19
BLOCK_BYTES = 8 << 20
COLUMNS = ("channel", "t_ns")
_WHOLE = re.compile(r"[-+]?[0-9]{1,20}")  # exact, where a float is not
SENSE, EDGE = "sense", "edge"
MOST_HEADER_BYTES = 4096
MOST_BYTES = 64 << 30


@dataclass(frozen=True, slots=True, eq=False)
class Pulses:
    """Pulses in order of time; every array has the shape (n,)."""

    channel: NDArray[np.uint8]
    """`INPUT`, `OUTPUT`, `INPUT_INDEX` or `OUTPUT_INDEX`, plus `BACKWARD` when turning back, plus
    `FALLING` for a falling edge."""
    t_ns: NDArray[np.int64]
    """Not negative."""

    def __len__(self) -> int:
        return len(self.t_ns)


def read_pulses(path: Path) -> Iterator[Pulses]:
    """Yield the pulses of a file in blocks; memory does not grow with the file.

    Raises:
        InputError: The file cannot be read, is truncated, holds something else, or its time goes
            back.
    """
    with failures_named(path, "read"):
        refuse_special_or_large(path, MOST_BYTES)
    with failures_named(path, "read"), path.open("rb") as file:
        is_binary = _is_binary(path, file.read(MOST_HEADER_BYTES))
        file.seek(0)
        blocks = _binary(path, file) if is_binary else _csv(path, file)
        yield from _in_order(path, blocks, is_binary=is_binary)


def tells_edges(path: Path) -> bool:
    """Tell whether a file that `read_pulses` takes says of each pulse which edge it is."""
    with failures_named(path, "read"):
        refuse_special_or_large(path, MOST_BYTES)
    with failures_named(path, "read"), path.open("rb") as file:
        head = file.readline(MOST_HEADER_BYTES)
    return head.startswith(MAGIC_EDGES) or EDGE in _names(head.decode("utf-8-sig", "replace"))


def _is_binary(path: Path, head: bytes) -> bool:
    """Tell a binary file by its magic; what is neither that nor text is refused."""
    magic = head[: len(MAGIC)]
    is_text = b"\0" not in head and not magic.startswith(MAGIC[:-1])
    if magic in (MAGIC, MAGIC_EDGES) or is_text:
        return not is_text
    shown = magic.decode("ascii", "backslashreplace")
    message = f"a binary file that begins with {quoted(shown)}, expected {quoted(MAGIC.decode())}"
    raise InputError(path, None, None, message)


def write_binary(path: Path, blocks: Iterable[Pulses]) -> int:
    """Write a binary file, and give the number of pulses; the head is written last."""
    count, has_falling = 0, False
    with failures_named(path, "write"), path.open("wb") as file:
        file.write(bytes(HEAD.size))
        for block in blocks:
            file.write(_words(block).tobytes())
            has_falling |= bool(np.any(block.channel & FALLING))
            count += len(block)
        file.seek(0)
        file.write(HEAD.pack(MAGIC_EDGES if has_falling else MAGIC, count))
    return count


def write_csv(path: Path, blocks: Iterable[Pulses]) -> int:
    """Write a CSV file with the columns `sense` and `edge`, and give the number of pulses."""
    count = 0
    with failures_named(path, "write"), path.open("w", encoding="utf-8") as file:
        file.write(",".join((*COLUMNS, SENSE, EDGE)) + "\n")
        for block in blocks:
            sense = np.where(block.channel & BACKWARD, -1, 1)
            edge = np.where(block.channel & FALLING, -1, 1)
            rows = np.column_stack([block.channel & ~np.uint8(CODED), block.t_ns, sense, edge])
            np.savetxt(file, rows, fmt="%d", delimiter=",")
            count += len(block)
    return count


def _words(block: Pulses) -> NDArray[np.uint64]:
    words = block.t_ns.astype("<u8")
    channel = block.channel.astype(np.uint64)
    words |= ((channel - np.uint64(INPUT)) & CHANNEL_MASK) << CHANNEL_SHIFT
    words |= (channel >= np.uint64(BACKWARD)).astype(np.uint64) << REVERSE_SHIFT
    words |= ((block.channel & FALLING) != 0).astype(np.uint64) << FALLING_SHIFT
    return words


def _binary(path: Path, file: BinaryIO) -> Iterator[Pulses]:
    magic = _refuse_truncated(path, file)
    edges = FALLING_BIT if magic == MAGIC_EDGES else np.uint64(0)
    while data := file.read(BLOCK_PULSES * WORD_BYTES):
        words = np.frombuffer(data, dtype="<u8")
        channel = ((words >> CHANNEL_SHIFT) & CHANNEL_MASK).astype(np.uint8) + np.uint8(INPUT)
        channel |= (words >> REVERSE_SHIFT).astype(np.uint8) * np.uint8(BACKWARD)
        channel |= ((words & edges) != 0).astype(np.uint8) * np.uint8(FALLING)
        yield Pulses(channel, (words & TIME_MASK & ~edges).astype(np.int64))


def _refuse_truncated(path: Path, file: BinaryIO) -> bytes:
    """Give the magic of a file that is whole."""
    head = file.read(HEAD.size)
    if len(head) < HEAD.size:
        raise InputError(path, None, None, f"truncated: the head has {HEAD.size} bytes")
    magic, count = HEAD.unpack(head)
    there = os.fstat(file.fileno()).st_size - HEAD.size
    if there != count * WORD_BYTES:
        is_short = there < count * WORD_BYTES
        rest = " and a part of one" if there % WORD_BYTES else ""
        message = f"the head announces {count} pulses, the file holds {there // WORD_BYTES}{rest}"
        raise InputError(path, None, None, f"truncated: {message}" if is_short else message)
    return bytes(magic)


def _csv(path: Path, file: BinaryIO) -> Iterator[Pulses]:
    header = file.readline(MOST_HEADER_BYTES).decode("utf-8-sig", "replace")
    places = _places(path, header)
    line = 2
    while text := file.read(BLOCK_BYTES):
        text += file.readline()
        table = _table(path, text, places, line)
        yield _checked(path, table, places, line)
        line += text.count(b"\n")


@dataclass(frozen=True, slots=True)
class _Places:
    channel: int
    t_ns: int
    sense: int | None
    edge: int | None
    width: int


def _places(path: Path, header: str) -> _Places:
    names = _names(header)
    for name in COLUMNS:
        if names.count(name) != 1:
            message = f"expected the columns channel,t_ns, found {quoted(header.strip())}"
            raise InputError(path, 1, None, message)
    sense, edge = (names.index(name) if name in names else None for name in (SENSE, EDGE))
    return _Places(names.index("channel"), names.index("t_ns"), sense, edge, len(names))


def _names(header: str) -> list[str]:
    return [name.strip().strip('"') for name in header.split(",")]


def _table(path: Path, text: bytes, places: _Places, first_line: int) -> NDArray[np.int64]:
    """Parse rows of whole numbers; shape (n, width). What is not so plain goes row by row."""
    width = places.width
    plain = text.replace(b"\r", b"").strip(b"\n")
    rows = plain.count(b"\n") + 1 if plain else 0
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # numpy stops at what is no number
        try:
            flat = np.fromstring(plain.replace(b"\n", b","), dtype=np.int64, sep=",")
        except (DeprecationWarning, ValueError):
            flat = np.empty(0, dtype=np.int64)
    commas = plain.count(b",")
    if len(flat) == rows * width and commas == rows * (width - 1):
        return flat.reshape(rows, width)
    return _row_by_row(path, text, places, first_line)


def _row_by_row(path: Path, text: bytes, places: _Places, first_line: int) -> NDArray[np.int64]:
    rows = []
    for line, raw in enumerate(text.splitlines(), first_line):
        cells = raw.decode("utf-8", "replace").split(",")
        if cells == [""]:
            continue
        if len(cells) != places.width:
            message = f"expected {places.width} cells, found {len(cells)}: truncated?"
            raise InputError(path, line, None, message)
        try:
            rows.append([_whole(cell, may_round=i == places.t_ns) for i, cell in enumerate(cells)])
        except (ValueError, OverflowError):
            message = f"expected whole numbers, found {quoted(','.join(cells))}"
            raise InputError(path, line, None, message) from None
    return np.array(rows, dtype=np.int64).reshape(-1, places.width)


def _whole(cell: str, *, may_round: bool) -> int:
    """Give a whole number; fractions of a nanosecond are nothing to any capture unit."""
    value = int(cell) if _WHOLE.fullmatch(cell.strip()) else round(number(cell))
    if not may_round and value != number(cell):
        raise ValueError
    if not -LATEST_NS <= value <= LATEST_NS:
        raise OverflowError
    return value


def _checked(path: Path, table: NDArray[np.int64], places: _Places, first_line: int) -> Pulses:
    channel, t_ns = table[:, places.channel], table[:, places.t_ns]
    sense, edge = (
        np.ones_like(t_ns) if place is None else table[:, place]
        for place in (places.sense, places.edge)
    )
    checks = (
        (
            (channel < INPUT) | (channel > OUTPUT_INDEX),
            "channel",
            channel,
            "1 (input), 2 (output), 3 or 4 (their index)",
        ),
        ((t_ns < 0) | (t_ns > LATEST_NS), "t_ns", t_ns, "a time from 0 on"),
        (np.abs(sense) != 1, "sense", sense, "1 or -1"),
        (np.abs(edge) != 1, "edge", edge, "1 (rising) or -1 (falling)"),
    )
    for wrong, name, values, expected in checks:
        if wrong.any():
            at = int(np.argmax(wrong))
            message = f"expected {expected}, found {values[at]}"
            raise InputError(path, first_line + at, name, message)
    coded = channel + BACKWARD * (sense < 0) + FALLING * (edge < 0)
    return Pulses(coded.astype(np.uint8), t_ns.copy())


def _in_order(path: Path, blocks: Iterable[Pulses], *, is_binary: bool) -> Iterator[Pulses]:
    """Refuse time that goes back: nobody can say by how much a clock that wrapped was late."""
    before, passed = np.int64(0), 0
    for block in blocks:
        steps = np.diff(block.t_ns, prepend=before)
        if (steps < 0).any():
            at = int(np.argmax(steps < 0))
            place = f"pulse {passed + at + 1}"
            is_last = not is_binary and at == len(block) - 1
            message = (
                f"{place}: time goes back by {-steps[at]} ns to {block.t_ns[at]} ns: "
                f"the clock wrapped, {'the file is truncated, ' if is_last else ''}"
                "or the pulses are not in order of time"
            )
            raise InputError(path, None if is_binary else passed + at + 2, None, message)
        if len(block):
            before, passed = block.t_ns[-1], passed + len(block)
            yield block
