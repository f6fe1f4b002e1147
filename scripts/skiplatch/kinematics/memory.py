"""Cycle 450: kinematics saved, restored, shown and deleted by number or name."""

import re
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.files import atomic_write_text, failures_named
from skiplatch.kinematics.machine import Machine, read_machine
from skiplatch.kinematics.program import Cycle, Program

SAVE, RESTORE, SHOW, DELETE = range(4)
MODE, DESIGNATION = 410, 409
NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")


class Memory:
    """A folder with a description of the kinematics for each number or name."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def _path(self, name: str) -> Path:
        return self._folder / f"{name}.toml"

    def save(self, name: str, machine: Machine) -> None:
        """Save, in place of what was there; a power cut leaves the old or the new."""
        with failures_named(self._folder, "write"):
            self._folder.mkdir(parents=True, exist_ok=True)
        atomic_write_text(self._path(name), format_machine(machine))

    def restore(self, name: str) -> Machine:
        """Give what was saved.

        Raises:
            InputError: Nothing was, or it cannot be read.
        """
        return read_machine(self._path(name))

    def names(self) -> list[str]:
        """Name what is there."""
        return sorted(path.stem for path in self._folder.glob("*.toml"))

    def delete(self, name: str) -> None:
        """Delete what was saved."""
        with failures_named(self._path(name), "delete"):
            self._path(name).unlink()


def run_450(
    program: Program, cycle: Cycle, machine: Machine, memory: Memory
) -> tuple[Machine, str]:
    """Run cycle 450; give the kinematics that are then active, and what was done.

    Raises:
        InputError: A parameter is wrong, or the kinematics are not there.
    """
    mode = _mode(program, cycle)
    name = _designation(program, cycle)
    if mode == SAVE:
        memory.save(name, machine)
        return machine, f"cycle 450: kinematics saved as {name}"
    if mode == RESTORE:
        return memory.restore(name), f"cycle 450: kinematics {name} restored"
    if mode == DELETE:
        memory.delete(name)
        return machine, f"cycle 450: kinematics {name} deleted"
    return machine, f"cycle 450: saved are {', '.join(memory.names()) or 'none'}"


def _mode(program: Program, cycle: Cycle) -> int:
    given = cycle.parameters.get(MODE)
    if given is None:
        return SAVE
    if given.value not in range(4):
        message = f"cycle 450: Q{MODE}: expected a mode from 0 to 3, got {given.value}"
        raise InputError(program.path, given.line, given.column, message)
    return int(given.value)


def _designation(program: Program, cycle: Cycle) -> str:
    given = cycle.parameters.get(DESIGNATION)
    if given is None:
        message = f"cycle 450: Q{DESIGNATION}: no number or name to save under"
        raise InputError(program.path, cycle.line, None, message)
    value = given.value
    name = f"{value:g}" if isinstance(value, float) else value
    if not NAME.fullmatch(name) or (isinstance(value, float) and not value >= 0.0):
        message = (
            f"cycle 450: Q{DESIGNATION}: expected a number from 0, or a name of letters, digits, "
            f"_ and -, got {quoted(name)}"
        )
        raise InputError(program.path, given.line, given.column, message)
    return name


def format_machine(machine: Machine) -> str:
    """Write the description as TOML; ``read_machine`` reads it back the same."""
    table = [a.letter for a in machine.axes if not a.in_head]
    head = [a.letter for a in machine.axes if a.in_head]
    lines = [f"table = {_list(table)}", f"head = {_list(head)}"]
    if machine.tool_mm is not None:
        lines.append(f"tool_mm = {_list(machine.tool_mm)}")
    for axis in machine.axes:
        lines += [
            "",
            f"[axes.{axis.letter}]",
            f"direction = {_list(axis.direction)}",
            f"point_mm = {_list(axis.point_mm)}",
            f"range_deg = {_list(axis.travel_deg)}",
        ]
    return "\n".join(lines) + "\n"


def _list(values: list[str] | tuple[float, ...]) -> str:
    texts = [f'"{v}"' if isinstance(v, str) else repr(float(v)) for v in values]
    return f"[{', '.join(texts)}]"
