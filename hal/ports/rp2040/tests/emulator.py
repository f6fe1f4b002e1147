"""rp2040js as a test bench.

The emulator runs in a process of its own, `bench.js`, which does what it is asked and lets time
pass only then: its time is virtual, in ns, and the same whatever the host is doing. An edge comes
at an exact instant; the chip sees it at the next instruction, at most some 50 ns later.
"""

import json
import subprocess
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from tests.boards.emulated import EmulatedBoard

ROOT = Path(__file__).resolve().parents[4]
NODE = ROOT / "build/rp2040js/node"
BENCH = Path(__file__).with_name("bench.js")

STEP_NS = 1_000_000  # of virtual time for what the board sends, at a time


class Uart:
    """The other end of UART 0: virtual time passes while it waits."""

    def __init__(self, board: "Emulator") -> None:
        """Belong to a board."""
        self._board = board

    def sendall(self, data: bytes, /) -> None:
        """Send to the board."""
        self._board.ask("send", digits=data.hex())

    def settimeout(self, seconds: float, /) -> None:
        """Do nothing: how long it waits is a question of virtual time."""

    def recv(self, count: int, /) -> bytes:
        """Receive at most so many bytes; TimeoutError if there is none for a millisecond."""
        if not self._board.sent:
            self._board.run(STEP_NS, count)
        data, self._board.sent = self._board.sent[:count], self._board.sent[count:]
        if not data:
            raise TimeoutError
        return data


class Emulator(EmulatedBoard):
    """One run of a program. Times are ns of virtual time since reset."""

    def __init__(self, program: Path) -> None:
        """Keep what to run."""
        self._program = program
        self._stack = ExitStack()
        self._now = 0
        self.sent = b""
        self.serial = Uart(self)

    def __enter__(self) -> Self:
        """Start the emulator, at reset."""
        self._process = self._stack.enter_context(
            subprocess.Popen(
                (NODE, BENCH, self._program),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                encoding="ascii",
            )
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
        /,
    ) -> None:
        """End it, by the end of its input."""
        self._stack.close()

    @classmethod
    def is_here(cls) -> bool:
        """Tell whether the emulator is installed."""
        return NODE.exists()

    def ask(self, what: str, **arguments: int | str) -> int:
        """Give the answer to a request; what was sent meanwhile is kept."""
        requests, answers = self._process.stdin, self._process.stdout
        assert requests is not None
        assert answers is not None
        requests.write(json.dumps({"do": what, **arguments}) + "\n")
        requests.flush()
        line = answers.readline()
        if not line:
            raise ConnectionResetError("the emulator has ended")
        answer = json.loads(line)
        self._now = int(answer["now"])
        self.sent += bytes.fromhex(answer["sent"])
        return int(answer.get("value") or 0)

    def run(self, ns: int, bytes_wanted: int | None = None) -> None:
        """Let so much time pass, or less, until so many bytes have come."""
        if bytes_wanted is None:
            self.ask("run", ns=ns)
        else:
            self.ask("run", ns=ns, bytes=bytes_wanted)

    def read(self, address: int) -> int:
        """Read a word."""
        return self.ask("read", address=address)

    def now(self) -> int:
        """Give the time."""
        return self._now

    def stop(self) -> None:
        """Do nothing: time stands, unless it is let pass."""

    def go(self) -> None:
        """Do nothing: time passes where a byte is waited for."""

    def deflect_in(self, ns: int) -> int:
        """Let the line go low now, and high in so many ns; give the time of that."""
        self.ask("deflect", ns=ns)
        return self._now + ns

    def last_step(self) -> int:
        """Give when the axis has made its last step."""
        return self.ask("step")

    def entered(self, interrupt: int, core: int = 0) -> int:
        """Give how often a core has entered an interrupt, by its number."""
        return self.ask("entered", interrupt=interrupt, core=core)
