"""QEMU's lm3s6965evb as a test bench: stopped and started, its pins wired, its memory read.

The emulated chip counts virtual time by instructions (`-icount`): each lasts 2^ICOUNT_SHIFT ns.
Two devices of the chip that the firmware leaves alone are the bench's instruments, in that same
time: the watchdog is the master clock, and the interrupt output of timer 3, which the bench
rewires to the pin C4, is the stimulus. An edge therefore comes at an exact instant of virtual time,
whatever the host is doing; `set_irq_in` on the pin would come when the host gets round to it.
"""

import json
import socket
import subprocess
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Self, TextIO

ICOUNT_SHIFT = 5  # 32 ns an instruction: 1.6 cycles at 50 MHz
TICK_NS = 20  # of core, timers and watchdog
COUNTS = 1 << 32
PATIENCE_S = 10.0

PORT_C = ("pl061_luminary", 2)  # the third of that type
TRIGGER_PIN = "unnamed-gpio-in[4]"
STIMULUS = ("stellaris-gptm", 3)  # timer 3
HOLDERS = ("soc", "unattached")  # of a machine's devices: before QEMU 9, all were unattached

WATCHDOG_LOAD = 0x40000000
WATCHDOG_VALUE = 0x40000004
WATCHDOG_CTL = 0x40000008
TIMER3 = 0x40033000
TIMER_TAMR = 0x04
TIMER_CTL = 0x0C
TIMER_IMR = 0x18
TIMER_ICR = 0x24
TIMER_TAILR = 0x28
ONE_SHOT = 1


class Emulator:
    """One run of a program; a context manager. Times are ticks of 20 ns of virtual time."""

    def __init__(
        self, program: Path, options: Sequence[str] = (), *, loops_back: bool = False
    ) -> None:
        """Keep what to run, and what QEMU is given besides.

        Args:
            program: The ELF file.
            options: More of QEMU's own options.
            loops_back: Connect UART 0 to UART 1 instead of to `serial`.
        """
        self._program = program
        self._options = options
        self._loops_back = loops_back
        self._stack = ExitStack()
        self._last_clock = 0
        self._elapsed = 0

    def __enter__(self) -> Self:
        """Start the emulator, stopped at reset, with the stimulus wired to the pin."""
        with self._stack:
            self._launch()
            self._wire()
            self._stack = self._stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        """End the emulator."""
        self._stack.close()

    def _launch(self) -> None:
        folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory()))
        names = ("qtest", "qmp") if self._loops_back else ("qtest", "qmp", "serial")
        listening = {name: self._listen(folder / name) for name in names}
        command = [
            *("qemu-system-arm", "-M", "lm3s6965evb", "-kernel", str(self._program)),
            *("-accel", "tcg", "-icount", f"shift={ICOUNT_SHIFT}", "-S", "-nodefaults"),
            *("-display", "none", "-monitor", "none", "-qtest-log", "none"),
            *("-qtest", f"unix:{folder / 'qtest'}", "-qmp", f"unix:{folder / 'qmp'}"),
            *(self._loop(folder) if self._loops_back else ("-serial", f"unix:{folder / 'serial'}")),
            *self._options,
        ]
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self._stack.callback(self._end)
        sockets = {name: self._accept(listening[name]) for name in names}
        self._qtest = self._file(sockets["qtest"])
        self._qmp = self._file(sockets["qmp"])
        if not self._loops_back:
            self.serial = sockets["serial"]
        self._qmp.readline()  # the greeting
        self.monitor("qmp_capabilities")

    @staticmethod
    def _loop(folder: Path) -> tuple[str, ...]:
        path = folder / "loop"
        return (
            *("-chardev", f"socket,id=near,path={path},server=on,wait=off"),
            *("-chardev", f"socket,id=far,path={path}"),
            *("-serial", "chardev:near", "-serial", "chardev:far"),
        )

    def _listen(self, path: Path) -> socket.socket:
        listening = self._stack.enter_context(socket.socket(socket.AF_UNIX))
        listening.settimeout(PATIENCE_S)
        listening.bind(str(path))
        listening.listen(1)
        return listening

    def _accept(self, listening: socket.socket) -> socket.socket:
        connection = self._stack.enter_context(listening.accept()[0])
        connection.settimeout(PATIENCE_S)
        return connection

    def _file(self, connection: socket.socket) -> TextIO:
        return self._stack.enter_context(connection.makefile("rw", encoding="ascii", newline="\n"))

    def _end(self) -> None:
        self.process.kill()
        self.process.wait()

    def _wire(self) -> None:
        """Rewire timer 3's interrupt to the pin."""
        pin = f"{self._device(*PORT_C)}/{TRIGGER_PIN}"
        stimulus = self._device(*STIMULUS)
        self.monitor("qom-set", path=stimulus, property="sysbus-irq[0]", value=pin)

    def _device(self, kind: str, number: int) -> str:
        """Give the path of one of the devices of a type, which stand in the order of the ports."""
        found = [
            f"{holder}/{name}"
            for holder in (f"/machine/{name}" for name in HOLDERS if name in self._list("/machine"))
            for name, its_kind in self._list(holder).items()
            if its_kind == f"child<{kind}>"
        ]
        found.sort(key=lambda path: int(path.rpartition("[")[2].rstrip("]")))
        if number >= len(found):
            raise RuntimeError(f"this QEMU has {len(found)} of {kind}, and no number {number}")
        return found[number]

    def _list(self, path: str) -> dict[str, str]:
        """Give the types of what an object of QEMU's has, by name."""
        rows = self.monitor("qom-list", path=path)
        assert isinstance(rows, list)
        return {row["name"]: row["type"] for row in rows}

    # ---- QMP and qtest ----

    def monitor(self, command: str, **arguments: object) -> object:
        """Give the answer to a QMP command; events that come before it are dropped."""
        self._qmp.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self._qmp.flush()
        answer: dict[str, object] = {}
        while "return" not in answer:
            line = self._qmp.readline()
            if not line:
                raise ConnectionResetError("QEMU has ended")
            answer = json.loads(line)
            if "error" in answer:
                raise RuntimeError(f"{command}: {answer['error']}")
        return answer["return"]

    def _ask(self, line: str) -> str:
        self._qtest.write(line + "\n")
        self._qtest.flush()
        answer = self._qtest.readline().split()
        if not answer or answer[0] != "OK":
            raise RuntimeError(f"{line}: {' '.join(answer)}")
        return answer[-1]

    def read(self, address: int) -> int:
        """Read a word."""
        return int(self._ask(f"readl {address:#x}"), 16)

    def write(self, address: int, value: int) -> None:
        """Write a word."""
        self._ask(f"writel {address:#x} {value:#x}")

    # ---- time ----

    def stop(self) -> None:
        """Let virtual time stand."""
        self.monitor("stop")

    def go(self) -> None:
        """Let it go on."""
        self.monitor("cont")

    def run_until(self, address: int, mask: int) -> None:
        """Let the program run until a bit of a word is set, and stop."""
        end_s = time.monotonic() + PATIENCE_S
        self.go()
        while not self.read(address) & mask:
            if time.monotonic() > end_s:
                raise RuntimeError(f"the program did not set {mask:#x} at {address:#x}")
        self.stop()

    def start_clock(self) -> None:
        """Start the master clock from 0. Stopped, after the program has set the core's clock."""
        self.write(WATCHDOG_LOAD, COUNTS - 1)
        self.write(WATCHDOG_CTL, 1)
        self._last_clock = self.read(WATCHDOG_VALUE)
        self._elapsed = 0

    def now(self) -> int:
        """Read the master clock; at least every 42 s. While running, it may lag somewhat."""
        value = self.read(WATCHDOG_VALUE)
        passed = (self._last_clock - value + COUNTS // 2) % COUNTS - COUNTS // 2
        self._elapsed += passed
        self._last_clock = value
        return self._elapsed

    # ---- the pin ----

    def start_stimulus(self) -> None:
        """Set the stimulus up, the line low. Stopped or running."""
        self.write(TIMER3 + TIMER_TAMR, ONE_SHOT)
        self.write(TIMER3 + TIMER_IMR, 1)
        self.release()

    def release(self) -> None:
        """Let the line go low, now."""
        self.write(TIMER3 + TIMER_ICR, 1)

    def deflect_in(self, ticks: int) -> int:
        """Let the line go high in so many ticks; give the master clock of that. Stopped."""
        self.write(TIMER3 + TIMER_CTL, 0)
        self.write(TIMER3 + TIMER_TAILR, ticks)
        self.write(TIMER3 + TIMER_CTL, 1)
        return self.now() + ticks
