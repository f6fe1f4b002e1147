"""The store of cycle 450 in a file."""

from dataclasses import replace
from pathlib import Path

import pytest

from kinematics_programs import MACHINE
from skiplatch.errors import InputError
from skiplatch.kinematics.machine import read_machine
from skiplatch.kinematics.memory import Memory, StoreRefusedError, format_machine, pack, unpack


def test_the_store_keeps_restores_and_deletes(tmp_path: Path) -> None:
    machine = read_machine(MACHINE)
    memory = Memory(tmp_path / "store.bin")
    memory.activate(machine)

    memory.run(0.0, "before")
    memory.run(0.0, 5.0)
    assert Memory(tmp_path / "store.bin").names() == ["5", "before"]
    assert memory.run(1.0, "before") == machine
    memory.run(3.0, "before")
    assert memory.names() == ["5"]
    with pytest.raises(StoreRefusedError):
        memory.run(1.0, "before")


def test_a_description_survives_store_and_file(tmp_path: Path) -> None:
    machine = read_machine(MACHINE)
    b, c = machine.axes
    machine = replace(machine, axes=(replace(b, datum_deg=-0.0123), c))
    path = tmp_path / "machine.toml"
    path.write_text(format_machine(machine), encoding="utf-8")

    assert unpack(pack(machine)) == machine
    assert read_machine(path) == machine


def test_a_description_of_another_version_is_refused() -> None:
    with pytest.raises(StoreRefusedError, match="another version"):
        unpack(pack(read_machine(MACHINE))[:-1])


def test_a_foreign_file_is_no_store(tmp_path: Path) -> None:
    path = tmp_path / "store.bin"
    path.write_bytes(b"something else")

    with pytest.raises(InputError, match="no store of kinematics"):
        Memory(path)
    assert path.read_bytes() == b"something else"
