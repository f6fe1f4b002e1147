"""A board in its emulator as a test bench, whichever the emulator is.

Time passes for the program between `go` and `stop`, or while bytes of it are waited for.
"""

from abc import ABC, abstractmethod
from pathlib import Path
from types import TracebackType
from typing import ClassVar, Protocol, Self


class Wire(Protocol):
    """The other end of the board's UART, as a socket is."""

    def sendall(self, data: bytes, /) -> None:
        """Send to the board."""

    def settimeout(self, seconds: float, /) -> None:
        """Wait so long for what the board sends."""

    def recv(self, count: int, /) -> bytes:
        """Receive at most so many bytes of what the board has sent; TimeoutError without any."""


class EmulatedBoard(ABC):
    """One run of a program; a context manager. Made, it knows what to run; entered, it is at reset.

    Attributes:
        NM: What lists the symbols of a program.
        serial: The other end of the UART.
    """

    NM: ClassVar[str] = "arm-none-eabi-nm"
    serial: Wire

    @abstractmethod
    def __init__(self, program: Path) -> None:
        """Keep what to run."""

    @abstractmethod
    def __enter__(self) -> Self:
        """Start the emulator."""

    @abstractmethod
    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
        /,
    ) -> None:
        """End it."""

    @classmethod
    @abstractmethod
    def is_here(cls) -> bool:
        """Tell whether the emulator is installed."""

    @abstractmethod
    def read(self, address: int) -> int:
        """Read a word."""

    @abstractmethod
    def now(self) -> int:
        """Read the bench's master clock."""

    @abstractmethod
    def stop(self) -> None:
        """Let virtual time stand."""

    @abstractmethod
    def go(self) -> None:
        """Let it go on."""
