"""A board in QEMU as a test bench: stopped and started, wired, its memory read.

The emulated chip counts virtual time by instructions (`-icount`): each lasts 2^ICOUNT_SHIFT ns,
whatever the host is doing. What a board's pins are wired to, and which of its devices are the
bench's instruments, its own subclass knows.
"""

import json
import re
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import ClassVar, Self, TextIO

from tests.boards.emulated import EmulatedBoard

ICOUNT_SHIFT = 5  # 32 ns an instruction
PATIENCE_S = 60.0
HOLDERS = ("soc", "unattached")  # of a machine's devices, beside the machine itself


class QemuBoard(EmulatedBoard):
    """One run of a program; a context manager.

    Attributes:
        QEMU: The emulator, its name or path.
        MACHINE: What it emulates.
        MORE: Options that the machine wants besides.
    """

    QEMU: ClassVar[str] = "qemu-system-arm"
    MACHINE: ClassVar[str]
    MORE: ClassVar[tuple[str, ...]] = ()

    def __init__(
        self,
        program: Path,
        options: Sequence[str] = (),
        *,
        loops_back: bool = False,
        sends_much: bool = False,
    ) -> None:
        """Keep what to run, and what QEMU is given besides.

        Args:
            program: The ELF file.
            options: More of QEMU's own options.
            loops_back: Let what UART 0 sends go into a file, `sent`, instead of to `serial`.
            sends_much: Let `serial` hold hundreds of bytes; they are there a little later.
        """
        self._program = program
        self._options = options
        self._loops_back, self._sends_much = loops_back, sends_much
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        """Start the emulator, stopped at reset, its pins wired."""
        with self._stack:
            self._launch()
            self._wire()
            self._stack = self._stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        """End the emulator."""
        self._stack.close()

    @classmethod
    def is_here(cls) -> bool:
        """Tell whether this QEMU is installed."""
        return shutil.which(cls.QEMU) is not None

    def _launch(self) -> None:
        folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory()))
        names = ("qtest", "qmp") if self._loops_back else ("qtest", "qmp", "serial")
        listening = {name: self._listen(folder / name) for name in names}
        serial = self._by_tcp(listening) if self._sends_much else f"unix:{folder / 'serial'}"
        command = [
            *(self.QEMU, "-M", self.MACHINE, "-kernel", str(self._program.resolve())),
            *("-accel", "tcg", "-icount", f"shift={ICOUNT_SHIFT}", "-S", "-nodefaults"),
            *("-display", "none", "-monitor", "none", "-qtest-log", "none"),
            *("-qtest", f"unix:{folder / 'qtest'}", "-qmp", f"unix:{folder / 'qmp'}"),
            *(self._loop(folder) if self._loops_back else ("-serial", serial)),
            *(*self.MORE, *self._options),
        ]
        self.process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self._stack.callback(self._end)
        sockets = {name: self._accept(listening[name]) for name in names}
        self._qtest = self._file(sockets["qtest"])
        self._qmp = self._file(sockets["qmp"])
        if not self._loops_back:
            self.serial = sockets["serial"]
        self._qmp.readline()  # the greeting
        self.monitor("qmp_capabilities")

    def _loop(self, folder: Path) -> tuple[str, ...]:
        """Give the options that put what is sent where the program reads it, in no time."""
        return ("-chardev", f"file,id=sent,path={folder / 'sent'}", "-serial", "chardev:sent")

    def _by_tcp(self, listening: dict[str, socket.socket]) -> str:
        """Wire the UART by TCP, whose buffers take many bytes that come one by one.

        A UNIX socket counts some 800 bytes for each. It is full after 270 of them, and QEMU loses
        what follows wherever a busy machine lets nobody fetch them in time.
        """
        wire = self._stack.enter_context(socket.socket(socket.AF_INET))
        wire.settimeout(PATIENCE_S)
        wire.bind(("127.0.0.1", 0))
        wire.listen(1)
        listening["serial"] = wire
        return f"tcp:127.0.0.1:{wire.getsockname()[1]},nodelay"

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
        """Wire what is to be wired. Stopped."""

    def listed(self, path: str) -> dict[str, str]:
        """Give the types of what an object of QEMU's has, by name."""
        rows = self.monitor("qom-list", path=path)
        assert isinstance(rows, list)
        return {row["name"]: row["type"] for row in rows}

    def device(self, kind: str, number: int = 0) -> str:
        """Give the path of one of the machine's devices of a type, in the order of their numbers.

        Which of QEMU's objects holds them differs with its version.
        """
        machine = self.listed("/machine")
        holders = ["/machine", *(f"/machine/{name}" for name in HOLDERS if name in machine)]
        found = [
            f"{holder}/{name}"
            for holder in holders
            for name, its_kind in self.listed(holder).items()
            if its_kind == f"child<{kind}>"
        ]
        found.sort(key=lambda path: [int(digits) for digits in re.findall(r"\[(\d+)\]", path)])
        if number >= len(found):
            raise RuntimeError(f"this QEMU has {len(found)} of {kind}, and no number {number}")
        return found[number]

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
