"""Replayed, forged, damaged and stray injection frames move no line."""

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.bench import injection
from tests.bench.bus import Bus, Frame
from tests.bench.injection import COMMAND_ID, EDGE_ID, Host
from tests.bench.programs import LATCH_ID, Program, controller, injector
from tests.bench.rig import Line, Rig


@pytest.fixture
def driver(rig: Rig, line: Line) -> Iterator[Program]:
    """An injector on line 0."""
    with injector(rig, line) as program:
        yield program


def edges_in(frames: list[Frame]) -> int:
    return sum(1 for frame in frames if frame.can_id == EDGE_ID) // 2


def test_a_trigger_makes_one_edge(driver: Program, bus: Bus) -> None:
    host = Host(bus)
    host.shoot()

    assert edges_in(bus.drain()) == 1


def test_a_replayed_trigger_makes_no_second_edge(driver: Program, bus: Bus) -> None:
    host = Host(bus)
    host.prepare()
    trigger = injection.frame(
        injection.TRIGGER, injection.u16(host.token) + injection.u24(0), host.counter
    )
    bus.send(COMMAND_ID, trigger)
    assert edges_in(bus.drain()) == 1

    for _ in range(10):
        bus.send(COMMAND_ID, trigger)
    assert edges_in(bus.drain()) == 0
    assert host.counts()["repeated"] == 10


def test_a_recorded_session_played_again_makes_no_edge(driver: Program, bus: Bus, rig: Rig) -> None:
    with Bus(rig.can, COMMAND_ID) as recorder:
        host = Host(bus)
        host.shoot()
        session = recorder.drain()
    bus.drain()

    for frame in session:
        bus.send(COMMAND_ID, frame.data)
    assert edges_in(bus.drain()) == 0


def test_a_forged_token_makes_no_edge(driver: Program, bus: Bus) -> None:
    host = Host(bus)
    host.prepare()
    token = host.token
    host.token = token ^ 1

    assert host.trigger().verdict == injection.WRONG_TOKEN
    assert edges_in(bus.drain()) == 0


def test_with_a_key_only_who_has_it_triggers(
    rig: Rig, line: Line, bus: Bus, tmp_path: Path
) -> None:
    key = bytes(range(16))
    path = tmp_path / "bench.key"
    path.touch(mode=0o600)
    path.write_text(key.hex())
    with injector(rig, line, "--key", str(path)) as program:
        assert Host(bus).command(injection.ARM, injection.u16(1000)).verdict == injection.FORGED
        stranger = Host(bus, bytes(16))
        answer = stranger.command(injection.ARM, injection.u16(1000))
        assert answer.verdict == injection.FORGED
        assert edges_in(bus.drain()) == 0

        Host(bus, key).shoot()
        assert edges_in(bus.drain()) == 1
        counters = program.stop()

    assert (counters["edges"], counters["forged"]) == (1, 2)


@pytest.mark.parametrize("byte", range(8))
def test_a_flipped_bit_makes_no_edge(driver: Program, bus: Bus, byte: int) -> None:
    host = Host(bus)
    host.prepare()
    trigger = bytearray(
        injection.frame(
            injection.TRIGGER, injection.u16(host.token) + injection.u24(0), host.counter
        )
    )
    trigger[byte] ^= 1 << byte
    bus.send(COMMAND_ID, bytes(trigger))

    assert edges_in(bus.drain()) == 0
    assert host.counts()["damaged"] == 1


def test_random_frames_make_no_edge(driver: Program, bus: Bus) -> None:
    dice = random.Random(1)
    host = Host(bus)
    for _ in range(2000):
        bus.send(COMMAND_ID, dice.randbytes(dice.randrange(9)))

    assert edges_in(bus.drain()) == 0
    assert host.counts()["damaged"] > 1900
    assert driver.is_running()


def test_a_flood_of_foreign_frames_moves_nothing_and_hides_no_trigger(
    driver: Program, bus: Bus, rig: Rig, line: Line
) -> None:
    with controller(rig, line) as latcher:
        host = Host(bus)
        for number in range(20):
            for can_id in range(100, 400):
                if can_id != LATCH_ID:
                    bus.send(can_id, bytes([number]) * 8)
            host.shoot()
            host.rest()
        counters = latcher.stop()

    assert counters["latches"] == 20
    assert host.counts()["edges"] == 20


def test_an_injector_that_was_killed_starts_unarmed(rig: Rig, line: Line, bus: Bus) -> None:
    with injector(rig, line) as first:
        host = Host(bus)
        host.prepare()
        first.kill()
    with injector(rig, line):
        host.counter = (host.ask().answered + 1) & 0xFF
        bus.drain()
        token = host.token

        answer = host.command(injection.TRIGGER, injection.u16(token) + injection.u24(0))
        assert answer.verdict in (injection.UNARMED, injection.INCOMPLETE)
        assert edges_in(bus.drain()) == 0
