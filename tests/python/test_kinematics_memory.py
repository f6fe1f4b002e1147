"""The store of cycle 450 in a file."""

import struct
from dataclasses import replace
from pathlib import Path

import pytest

from kinematics_programs import MACHINE, program_of, run
from skiplatch.bench.latches import CRC_START, crc16
from skiplatch.errors import InputError
from skiplatch.kinematics.machine import read_machine
from skiplatch.kinematics.memory import Memory, StoreRefusedError, format_machine, pack, unpack


def test_the_store_keeps_restores_and_deletes(tmp_path: Path) -> None:
    machine = read_machine(MACHINE)
    memory = Memory(tmp_path / "store.bin")
    memory.activate(machine)

    memory.run(0.0, "my old one")
    memory.run(0.0, 5.0)
    assert Memory(tmp_path / "store.bin").names() == ["5", "my old one"]
    assert memory.run(1.0, "my old one") == machine
    memory.run(3.0, "my old one")
    assert memory.names() == ["5"]
    with pytest.raises(StoreRefusedError):
        memory.run(1.0, "my old one")


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


@pytest.mark.parametrize(
    "place", [0, 26, 28, 44, 52, 68, 76, 84, 92, 100], ids=lambda place: f"byte {place}"
)
def test_a_description_that_no_machine_has_is_refused(place: int) -> None:
    payload = bytearray(pack(read_machine(MACHINE)))
    payload[place : place + 8] = b"\xff" * 8

    with pytest.raises(StoreRefusedError, match="another version"):
        unpack(bytes(payload))


@pytest.mark.parametrize("payload", [b"", b"\0", bytes(26), bytes(300)])
def test_a_description_of_any_length_is_borne(payload: bytes) -> None:
    with pytest.raises(StoreRefusedError, match="another version"):
        unpack(payload)


def damaged_store(path: Path) -> bytes:
    """Write a store whose newest description has lost a bit."""
    memory = Memory(path)
    memory.activate(read_machine(MACHINE))
    memory.run(0.0, "before")
    data = bytearray(path.read_bytes())
    data[data.index(b"before") + 30] ^= 1
    path.write_bytes(data)
    return bytes(data)


def test_a_store_that_has_lost_a_bit_is_refused_until_that_is_accepted(tmp_path: Path) -> None:
    path = tmp_path / "store.bin"
    data = damaged_store(path)

    with pytest.raises(
        InputError, match=r"store\.bin: the memory has lost bits.*--discard-damaged"
    ):
        Memory(path)
    assert path.read_bytes() == data
    memory = Memory(path, discards_damaged=True)
    assert memory.names() == []
    assert Memory(path).names() == []


def test_a_damaged_store_is_one_line_of_the_command(tmp_path: Path) -> None:
    program = program_of(tmp_path, '12 TCH PROBE 450 X ~\n QS409="A" ~\n Q410=+0\n')
    damaged_store(tmp_path / "store.bin")

    assert isinstance(run(program, tmp_path).exception, InputError)
    assert run(program, tmp_path, "--discard-damaged").exit_code == 0


def test_a_store_is_made_by_a_program_that_saves_or_ends_well(tmp_path: Path) -> None:
    fails = '12 TCH PROBE 450 X ~\n QS409="B" ~\n Q410=+1\n'
    saves = '12 TCH PROBE 450 X ~\n QS409="A" ~\n Q410=+0\n'
    store = tmp_path / "store.bin"

    assert isinstance(run(program_of(tmp_path, fails), tmp_path).exception, InputError)
    assert not store.exists()
    assert isinstance(run(program_of(tmp_path, saves + fails), tmp_path).exception, InputError)
    assert Memory(store).names() == ["A"]


def full_store(size: int) -> bytes:
    """Give a store whose slots all hold a number, which no store of ours does."""
    slots = 18
    slot_bytes = size // slots
    mark = bytes([0xA5, 0x1E, 0x93, 0x6C, 0xD2, 0x39, 0x47, 0xB8])
    parts = []
    for slot in range(slots):
        payload = b"x"
        body = struct.pack("<IBI12xHs", slot, 1, slot, len(payload), payload)
        record = struct.pack("<H", crc16(CRC_START, body)) + body
        parts.append((mark.ljust(64, b"\0") + record).ljust(slot_bytes, b"\0"))
    return b"".join(parts)


def test_a_store_without_a_free_slot_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "store.bin"
    Memory(path)
    size = path.stat().st_size
    path.write_bytes(full_store(size))

    with pytest.raises(InputError, match=r"store\.bin: what stands in the memory"):
        Memory(path)
    assert path.read_bytes() == full_store(size)


def test_a_foreign_file_is_no_store(tmp_path: Path) -> None:
    path = tmp_path / "store.bin"
    path.write_bytes(b"something else")

    with pytest.raises(InputError, match="no store of kinematics"):
        Memory(path)
    assert path.read_bytes() == b"something else"
