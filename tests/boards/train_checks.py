"""What holds of a board that makes its edges itself, 20 µs apart: hal/ports/qemu/train.h."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import ClassVar

import pytest

from skiplatch.bench.latches import FRAMES_PER_RECORD
from tests.boards.emulated import EmulatedBoard
from tests.boards.qemu import QemuBoard
from tests.boards.qemu_rig import FRAME_BYTES, Rig, symbols_of

COUNTERS = 12  # bytes into a latch_t: four of 16 bits
TRAIN = 512  # a power of two: one bit tells its end
SPACING_US = 20
REST_US = 100_000
SILENCE_S = 0.05
LAST_S = 1.0  # of silence after the last byte: QEMU hands it over when the machine lets it
WAITS_US = 5.0  # the interrupt that makes an edge, for critical sections and for a byte


def counted_by_latch(board: EmulatedBoard, symbols: dict[str, int]) -> int:
    """Give how many edges the latch that is on has counted without a record."""
    counters = board.read(symbols["measuring"]) + COUNTERS
    words = [board.read(counters), board.read(counters + 4)]
    return sum((word & 0xFFFF) + (word >> 16) for word in words)


def records_in(sent_bytes: int) -> int:
    """Give how many records so many bytes of the report bus are."""
    return sent_bytes // (FRAME_BYTES * FRAMES_PER_RECORD)


class Train:
    """The program of a train with its skip input armed, scanning, its axis at 3000 mm/min."""

    def __init__(self, emulator: QemuBoard, rig: Rig, symbols: dict[str, int]) -> None:
        """Let it get so far."""
        self.emulator = emulator
        self._rig = rig
        self._symbols = symbols
        self._sent_bytes = 0
        rig.start_block(b"s", b"3")

    def variable(self, name: str) -> int:
        """Read a variable of the program."""
        return self.emulator.read(self._symbols[name])

    def play(self) -> None:
        """Let the edges come, and what they leave be sent.

        QEMU stands still while a byte of the UART cannot leave, and answers nothing: bytes are
        fetched all the while that it is asked.
        """
        with ThreadPoolExecutor(1) as asking:
            played = asking.submit(self._make_edges)
            while not played.done():
                self._receive()
        played.result()
        self._receive(LAST_S)

    def _make_edges(self) -> None:
        """Let the edges come, and their records leave."""
        self.emulator.write(self._symbols["train_wanted"], TRAIN)
        while self.variable("train_made") < TRAIN:
            self._rig.run_for(REST_US)
        self._rig.run_for(REST_US)

    def _receive(self, silence_s: float = SILENCE_S) -> None:
        """Fetch bytes of the UART until none comes for a while."""
        self.emulator.serial.settimeout(silence_s)
        with suppress(TimeoutError):
            while received := self.emulator.serial.recv(1 << 16):
                self._sent_bytes += len(received)

    def told_of(self) -> int:
        """Give how many edges the skip input has told of: sent, or counted by its latch."""
        return counted_by_latch(self.emulator, self._symbols) + records_in(self._sent_bytes)

    def gaps_us(self) -> tuple[float, float]:
        """Give how far apart two edges were at the least and at the most."""
        tick_us = self._rig.DEVICE_TICK / self._rig.TICKS_PER_US
        least, most = (self.variable(f"train_{which}_ticks") for which in ("least", "most"))
        return least * tick_us, most * tick_us

    def rounds_at_rest(self) -> int:
        """Give how often the task goes round in 100 ms without any edge."""
        begun = self.variable("rest_count")
        while self.variable("rest_count") < begun + 2:
            self._rig.run_for(REST_US / 4)
        return self.variable("rest_rounds")


class TrainChecks:
    """No edge is lost, and an armed input costs nothing.

    Attributes:
        RIG: Of the board.
        ARMED_BY: The register that lets edges in; 0 disarms the hardware.
    """

    RIG: ClassVar[type[Rig]]
    ARMED_BY: ClassVar[int]

    @pytest.fixture
    def train(self) -> Iterator[Train]:
        """Start the program."""
        program = Path("build/boards", self.RIG.__module__.split(".")[2], "train.elf")
        if not self.RIG.EMULATOR.is_here() or not program.exists():
            pytest.skip(f"no {program} here: make setup-test says what is missing")
        board = self.RIG.EMULATOR
        assert issubclass(board, QemuBoard)
        symbols = symbols_of(program, board.NM)
        with board(program, sends_much=True) as emulator:
            yield Train(emulator, self.RIG(emulator, symbols, 0), symbols)

    def test_no_edge_of_a_train_is_lost_while_all_interrupts_run(self, train: Train) -> None:
        before = train.told_of()
        train.play()

        assert train.told_of() - before == TRAIN

    def test_each_edge_of_a_train_comes_20_us_after_another(self, train: Train) -> None:
        train.play()
        least_us, most_us = train.gaps_us()

        assert least_us > SPACING_US - WAITS_US
        assert most_us < SPACING_US + WAITS_US

    def test_an_armed_input_costs_nothing_while_the_line_rests(self, train: Train) -> None:
        armed = train.rounds_at_rest()
        train.emulator.write(self.ARMED_BY, 0)
        disarmed = train.rounds_at_rest()

        assert armed == pytest.approx(disarmed, abs=1)
