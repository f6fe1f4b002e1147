"""A Cortex-M board in QEMU as a test bench: stopped and started, wired, its memory read.

The emulated chip counts virtual time by instructions (`-icount`): each lasts 2^ICOUNT_SHIFT ns,
whatever the host is doing. What a board's pins are wired to, and which of its devices are the
bench's instruments, its own subclass knows.
"""

import json
import socket
import subprocess
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import ClassVar, Self, TextIO

ICOUNT_SHIFT = 5  # 32 ns an instruction
PATIENCE_S = 10.0


class QemuBoard:
    """One run of a program; a context manager."""

    QEMU: ClassVar[str] = "qemu-system-arm"
    MACHINE: ClassVar[str]

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

    def _launch(self) -> None:
        folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory()))
        names = ("qtest", "qmp") if self._loops_back else ("qtest", "qmp", "serial")
        listening = {name: self._listen(folder / name) for name in names}
        command = [
            *(self.QEMU, "-M", self.MACHINE, "-kernel", str(self._program.resolve())),
            *("-accel", "tcg", "-icount", f"shift={ICOUNT_SHIFT}", "-S", "-nodefaults"),
            *("-display", "none", "-monitor", "none", "-qtest-log", "none"),
            *("-qtest", f"unix:{folder / 'qtest'}", "-qmp", f"unix:{folder / 'qmp'}"),
            *(self._loop(folder) if self._loops_back else ("-serial", f"unix:{folder / 'serial'}")),
            *self._options,
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
        """Give the options that let the program hear its own bytes. QEMU runs in that folder."""
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
        """Wire what is to be wired. Stopped."""

    def listed(self, path: str) -> dict[str, str]:
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

    def now(self) -> int:
        """Read the bench's master clock."""
        raise NotImplementedError

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
