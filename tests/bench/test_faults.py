"""What goes wrong on a bench: bus, line, clock, and programs that die."""

import json
import signal
import subprocess
import time
from typing import IO, cast

import pytest

from tests.bench import bus as can
from tests.bench.bus import FRAME, Bus
from tests.bench.latches import Latches, decode
from tests.bench.programs import LATCH_ID, Program, controller, run
from tests.bench.rig import Line, Rig

ARRIVAL_S = 2.0
SETTLE_S = 0.05


def latches_of(bus: Bus) -> Latches:
    """Take all latches that are on their way."""
    frames = bus.drain(0.5)
    return decode(
        b"".join(FRAME.pack(frame.can_id, len(frame.data), frame.data) for frame in frames),
        LATCH_ID,
    )


def counters_now(program: Program) -> dict[str, int]:
    """Ask a running program for its counters."""
    program.process.send_signal(signal.SIGUSR1)
    line = cast(IO[str], program.process.stdout).readline()
    return cast(dict[str, int], json.loads(line))


def touch(line: Line, times: int) -> None:
    """Deflect the line some times, slowly enough for everybody."""
    for _ in range(times):
        line.pulse()
        time.sleep(0.005)


# ---- bus ----


def test_error_frames_are_counted_and_latches_go_on(rig: Rig, line: Line, bus: Bus) -> None:
    with controller(rig, line) as latcher:
        for _ in range(3):
            bus.send(can.ERROR_FLAG | can.ERROR_BUS_OFF, bytes(8))
        bus.send(can.ERROR_FLAG | can.ERROR_CONTROLLER, bytes([0, 0x20, 0, 0, 0, 0, 0, 0]))
        time.sleep(SETTLE_S)
        touch(line, 3)

        assert len(latches_of(bus)) == 3
        counters = latcher.stop()
    assert counters["bus_offs"] == 3
    assert counters["error_frames"] == 4


def test_touches_while_the_interface_is_down_come_when_it_is_up(
    rig: Rig, line: Line, bus: Bus
) -> None:
    with controller(rig, line) as latcher:
        touch(line, 1)
        assert len(latches_of(bus)) == 1
        rig.set_link(up=False)
        touch(line, 3)
        time.sleep(SETTLE_S)
        rig.set_link(up=True)
        time.sleep(0.2)
        touch(line, 1)
        latches = latches_of(bus)
        counters = latcher.stop()

    assert counters["bus_downs"] >= 1
    assert counters["latches"] + counters["dropped"] == 5
    assert len(latches) + counters["dropped"] == 4, "each one comes or is counted as dropped"


def test_an_interface_that_flaps_costs_nothing_once_it_is_up(
    rig: Rig, line: Line, bus: Bus
) -> None:
    with controller(rig, line) as latcher:
        for _ in range(10):
            rig.set_link(up=False)
            rig.set_link(up=True)
        time.sleep(0.2)
        with Bus(rig.can, LATCH_ID) as again:
            touch(line, 5)
            assert len(latches_of(again)) == 5
        assert latcher.stop()["dropped"] == 0


def test_a_recorder_with_a_full_queue_costs_the_others_nothing(
    rig: Rig, line: Line, bus: Bus
) -> None:
    with controller(rig, line) as latcher, Bus(rig.can) as sleeper:
        for _ in range(20_000):
            bus.send(0x100, bytes(8))
        touch(line, 5)

        assert len(latches_of(bus)) == 5
        assert latcher.stop()["dropped"] == 0
        assert sleeper.receive(1.0) is not None


def test_a_controller_with_a_full_receive_queue_counts_it_and_latches(
    rig: Rig, line: Line, bus: Bus
) -> None:
    with controller(rig, line) as latcher:
        latcher.process.send_signal(signal.SIGSTOP)
        for _ in range(5000):
            bus.send(LATCH_ID, bytes(8))
        latcher.process.send_signal(signal.SIGCONT)
        time.sleep(0.5)
        bus.drain()
        touch(line, 5)

        assert len(latches_of(bus)) == 5
        counters = latcher.stop()
    assert counters["frames_foreign"] + counters["frames_missed"] == 5000
    assert counters["frames_missed"] > 0


# ---- line ----


def test_a_chip_pulled_out_is_noticed_and_taken_up_again(rig: Rig, line: Line, bus: Bus) -> None:
    with controller(rig, line) as latcher:
        touch(line, 1)
        rig.set_chip_live(live=False)
        time.sleep(0.5)
        assert latcher.is_running()
        rig.set_chip_live(live=True)
        time.sleep(3.0)
        back = rig.line(0)
        touch(back, 2)

        assert len(latches_of(bus)) == 3
        assert latcher.stop()["line_losses"] == 1


def test_a_line_in_use_is_refused_in_one_line(rig: Rig, line: Line, bus: Bus) -> None:
    with controller(rig, line) as first:
        second = run(
            "skiplatch-controller",
            *("--chip", str(rig.chip), "--line", "0", "--can", rig.can),
        )
        touch(line, 1)

        assert len(latches_of(bus)) == 1
        assert first.is_running()
    status, complaint = second
    assert status == 2
    assert len(complaint.splitlines()) == 1
    assert "skiplatch-controller" in complaint.split(":", 1)[1], "it tells who has the line"


def test_two_controllers_on_two_lines_do_not_disturb_each_other(
    rig: Rig, line: Line, bus: Bus
) -> None:
    other = rig.line(1)
    other.set(high=False)
    with (
        controller(rig, line) as first,
        controller(rig, other, "--latch-id", "0x182") as second,
        Bus(rig.can, 0x182) as second_bus,
    ):
        touch(line, 3)
        touch(other, 4)

        assert len(latches_of(bus)) == 3
        assert len(second_bus.drain()) == 2 * 4
        assert first.stop()["latches"] == 3
        assert second.stop()["latches"] == 4


def test_a_pulse_shorter_than_the_debounce_is_no_touch(rig: Rig, line: Line, bus: Bus) -> None:
    with controller(rig, line, "--debounce-us", "50000") as latcher:
        line.pulse(0.001)
        time.sleep(0.2)
        assert len(latches_of(bus)) == 0
        line.pulse(0.2)

        assert len(latches_of(bus)) == 1
        assert latcher.stop()["latches"] == 1


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (("--can", "can99"), "ip link"),
        (("--chip", "gpiochip99"), "gpiochip99"),
        (("--line", "4000"), "4000"),
    ],
)
def test_what_is_not_there_is_one_line_that_says_what_to_do(
    rig: Rig, change: tuple[str, str], word: str
) -> None:
    options = {"--chip": str(rig.chip), "--line": "0", "--can": rig.can, **dict([change])}
    status, complaint = run(
        "skiplatch-controller", *(part for pair in options.items() for part in pair)
    )

    assert status == 2
    assert len(complaint.splitlines()) == 1
    assert word in complaint


# ---- clock ----


def test_a_step_of_the_wall_clock_moves_no_latch(rig: Rig, line: Line, bus: Bus) -> None:
    if rig.machine != "vm":
        pytest.skip("steps the clock of the machine: only in the virtual one")
    windows = []
    with controller(rig, line):
        for step_s in (3600, -7200, 86_400):
            now_s = int(time.time())
            subprocess.run(["date", "-s", f"@{now_s + step_s}"], check=True)  # noqa: S607
            windows.append(line.pulse())
            time.sleep(0.02)
        latches = latches_of(bus)

    assert len(latches) == len(windows)
    for time_ns, (before_ns, after_ns) in zip(
        latches.times_ns(windows[0][0]), windows, strict=True
    ):
        assert before_ns - 100 <= time_ns <= after_ns + 1_000_000


# ---- power cuts ----


STAGES = ("starting", "armed", "latching", "reporting", "ending")


@pytest.mark.parametrize("stage", STAGES)
def test_a_controller_killed_at_any_stage_can_be_started_again(
    rig: Rig, line: Line, bus: Bus, stage: str
) -> None:
    kill_at(stage, rig, line)
    line.set(high=False)
    bus.drain()

    with controller(rig, line) as again:
        touch(line, 3)
        latches = latches_of(bus)
        assert len(latches) == 3
        assert latches.sequence.tolist() == [0, 1, 2]
        assert again.stop()["latches"] == 3


def kill_at(stage: str, rig: Rig, line: Line) -> None:
    """Start a controller and kill it at that stage of its life."""
    program = controller(rig, line)
    try:
        if stage == "starting":
            return
        program.__enter__()
        if stage == "latching":
            line.set(high=True)
        elif stage == "reporting":
            rig.set_link(up=False)
            touch(line, 3)
            rig.set_link(up=True)
        elif stage == "ending":
            program.process.send_signal(signal.SIGINT)
    finally:
        program.kill()
        program.__exit__()
