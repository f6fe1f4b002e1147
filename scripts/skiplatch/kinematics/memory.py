"""Cycle 450: kinematics saved, restored, shown and deleted by the firmware's store, in a file.

The table of cycle 453 is none of them: it stays as it is.
"""

import os
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from skiplatch.errors import InputError
from skiplatch.files import atomic_write_bytes, failures_named, refuse_special_or_large
from skiplatch.kinematics.grid import format_grid
from skiplatch.kinematics.machine import Machine, RotaryAxis, Vector, is_possible
from skiplatch.kinematics.program import Cycle, Program, Value
from skiplatch.simulator.library import SimulationError, connection
from skiplatch.undo import keep_outputs, make_folders

CData = Any
MODE, DESIGNATION = 410, 409
SAVE, RESTORE, SHOW, DELETE = range(4)
DONE = {SAVE: "saved as", RESTORE: "restored from", DELETE: "deleted:"}
HEAD = struct.Struct("<BB3d")
AXIS = struct.Struct("<cB9d")
TIP_SHIFT = struct.Struct("<3d")
NO_SHIFT = (0.0, 0.0, 0.0)


class StoreRefusedError(Exception):
    """The store refused an operation."""


class Memory:
    """The store in a file; every write of the firmware's reaches the disk before the next.

    Raises:
        InputError: The file is no store, or one that has lost bits and is not to go on with what
            is left (`discards_damaged`).
    """

    def __init__(self, path: Path, *, discards_damaged: bool = False) -> None:
        _, lib = connection()
        self._path = path
        size = lib.sim_kinematics_memory_bytes()
        with failures_named(path, "read"):
            is_there = path.exists()
        if not is_there:
            with failures_named(path.parent, "write"):
                make_folders(path.parent)
            atomic_write_bytes(path, bytes(size))
        with failures_named(path, "read"):
            refuse_special_or_large(path, size)
            if path.stat().st_size != size:
                raise InputError(path, None, None, f"no store of kinematics: not {size} bytes")
        with self._mounted() as handle:
            self._carry_out(handle)  # what a power cut left undone
            if discards_damaged:
                self._refuse_state(lib.sim_kinematics_memory_discard_damaged(handle))
                self._carry_out(handle)
            self._refuse_state(lib.sim_kinematics_memory_check(handle))

    def _refuse_state(self, code: int) -> None:
        if code != 0:
            raise InputError(self._path, None, None, _phrase(code))

    @contextmanager
    def _mounted(self) -> Iterator[CData]:
        ffi, lib = connection()
        with failures_named(self._path, "read"):
            handle = lib.sim_kinematics_memory_open(
                ffi.from_buffer("uint8_t[]", self._path.read_bytes())
            )
        if not handle:
            raise SimulationError("out of memory")
        try:
            yield handle
        finally:
            lib.sim_kinematics_memory_close(handle)

    def activate(self, machine: Machine) -> None:
        """Make a description the active one."""
        _, lib = connection()
        payload = pack(machine)
        with self._mounted() as handle:
            self._refuse_state(lib.sim_kinematics_memory_activate(handle, payload, len(payload)))
            self._carry_out(handle)

    def run(self, mode: float, designation: float | str) -> Machine:
        """Run cycle 450; give the description that is then active.

        Raises:
            StoreRefusedError: A parameter is wrong, or there is no such record.
        """
        ffi, lib = connection()
        number = designation if isinstance(designation, float) else 0.0
        name = ffi.NULL if isinstance(designation, float) else designation.encode()
        payload = ffi.new("uint8_t[]", lib.SIM_450_PAYLOAD_MAX)
        with self._mounted() as handle:
            _refuse(lib.sim_kinematics_memory_start(handle, mode, number, name))
            self._carry_out(handle)
            length = lib.sim_kinematics_memory_active(handle, payload)
        if mode != SHOW:
            keep_outputs()  # it is the machine's: what a program saved stays if it fails then
        return unpack(bytes(ffi.buffer(payload, length)))

    def names(self) -> list[str]:
        """Name what is saved."""
        ffi, lib = connection()
        text = ffi.new("char[]", lib.SIM_450_TEXT_MAX)
        found: list[str] = []
        with self._mounted() as handle:
            while lib.sim_kinematics_memory_show(handle, len(found), text):
                found.append(ffi.string(text).decode())
        return sorted(found)

    def _carry_out(self, handle: CData) -> None:
        ffi, lib = connection()
        offset = ffi.new("uint32_t *")
        data = ffi.new("uint8_t[]", lib.SIM_450_WRITE_MAX)
        with failures_named(self._path, "write"), self._path.open("r+b", buffering=0) as file:
            while length := lib.sim_kinematics_memory_next_write(handle, offset, data):
                os.pwrite(file.fileno(), bytes(ffi.buffer(data, length)), offset[0])
                os.fsync(file.fileno())


def _phrase(code: int) -> str:
    ffi, lib = connection()
    phrase = str(ffi.string(lib.sim_kinematics_memory_phrase(code)).decode())
    if code == lib.SIM_450_DAMAGED:
        phrase += "; --discard-damaged goes on with what is left"
    return phrase


def _refuse(code: int) -> None:
    if code != 0:
        raise StoreRefusedError(_phrase(code))


def run_450(
    program: Program, cycle: Cycle, machine: Machine, memory: Memory
) -> tuple[Machine, str]:
    """Run cycle 450 of a program; give the kinematics that are then active, and what was done.

    Raises:
        InputError: The store refused it.
    """
    mode = cycle.parameters.get(MODE, Value(float(SAVE), cycle.line, 1))
    given = cycle.parameters.get(DESIGNATION)
    if isinstance(mode.value, str):
        message = f"cycle 450: Q{MODE}: expected a number"
        raise InputError(program.path, mode.line, mode.column, message)
    if given is None and mode.value != SHOW:
        message = f"cycle 450: Q{DESIGNATION}: no number or name given"
        raise InputError(program.path, cycle.line, None, message)
    designation = given.value if given else 0.0
    memory.activate(machine)
    try:
        active = replace(memory.run(mode.value, designation), grid=machine.grid)
    except StoreRefusedError as error:
        raise InputError(program.path, cycle.line, None, f"cycle 450: {error}") from error
    shown = f"{designation:g}" if isinstance(designation, float) else designation
    if mode.value == SHOW:
        return active, f"cycle 450: saved are {', '.join(memory.names()) or 'none'}"
    return active, f"cycle 450: kinematics {DONE[int(mode.value)]} {shown}"


def pack(machine: Machine) -> bytes:
    """Write a description in as many bytes as the store has for one."""
    tool_mm = machine.tool_mm or (0.0, 0.0, 0.0)
    parts = [HEAD.pack(len(machine.axes), machine.tool_mm is not None, *tool_mm)]
    parts += [
        AXIS.pack(
            a.letter.encode(), a.in_head, *a.direction, *a.point_mm, *a.travel_deg, a.datum_deg
        )
        for a in machine.axes
    ]
    if machine.tip_shift_mm != NO_SHIFT:
        parts.append(TIP_SHIFT.pack(*machine.tip_shift_mm))
    return b"".join(parts)


def unpack(payload: bytes) -> Machine:
    """Read what `pack` wrote.

    Raises:
        StoreRefusedError: Something else wrote it.
    """
    foreign = StoreRefusedError("another version has saved this description")
    if len(payload) < HEAD.size:
        raise foreign
    end = HEAD.size + payload[0] * AXIS.size
    if len(payload) not in (end, end + TIP_SHIFT.size):
        raise foreign
    shift_mm = TIP_SHIFT.unpack_from(payload, end) if len(payload) > end else NO_SHIFT
    count, has_tool, *tool_mm = HEAD.unpack_from(payload)
    axes = [_axis(AXIS.unpack_from(payload, HEAD.size + i * AXIS.size)) for i in range(count)]
    machine = Machine(tuple(axes), cast(Vector, tuple(tool_mm)) if has_tool else None, shift_mm)
    if not is_possible(machine):
        raise foreign
    return machine


def _axis(values: tuple[Any, ...]) -> RotaryAxis:
    letter, in_head, *numbers = values
    return RotaryAxis(
        letter.decode("latin-1"),
        bool(in_head),
        cast(Vector, tuple(numbers[:3])),
        cast(Vector, tuple(numbers[3:6])),
        (numbers[6], numbers[7]),
        numbers[8],
    )


def format_machine(machine: Machine) -> str:
    """Write the description as TOML; ``read_machine`` reads it back the same."""
    table = [a.letter for a in machine.axes if not a.in_head]
    head = [a.letter for a in machine.axes if a.in_head]
    lines = [f"table = {_list(table)}", f"head = {_list(head)}"]
    if machine.tool_mm is not None:
        lines.append(f"tool_mm = {_list(machine.tool_mm)}")
    if machine.tip_shift_mm != NO_SHIFT:
        lines.append(f"tip_shift_mm = {_list(machine.tip_shift_mm)}")
    for axis in machine.axes:
        lines += [
            "",
            f"[axes.{axis.letter}]",
            f"direction = {_list(axis.direction)}",
            f"point_mm = {_list(axis.point_mm)}",
            f"range_deg = {_list(axis.travel_deg)}",
        ]
        if axis.datum_deg != 0.0:
            lines.append(f"datum_deg = {axis.datum_deg!r}")
    lines += format_grid(machine.grid) if machine.grid is not None else []
    return "\n".join(lines) + "\n"


def _list(values: Sequence[str] | Sequence[float]) -> str:
    texts = [f'"{v}"' if isinstance(v, str) else repr(float(v)) for v in values]
    return f"[{', '.join(texts)}]"
