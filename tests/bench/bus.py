"""A CAN socket of the tests' own: plain SocketCAN, so that nothing of the project judges itself."""

import errno
import socket
import struct
import time
from dataclasses import dataclass
from typing import Self

FRAME = struct.Struct("=IB3x8s")
FRAME_BYTES = FRAME.size
ID_MASK = 0x7FF
ERROR_FLAG = 0x20000000
ERROR_BUS_OFF = 0x40
ERROR_CONTROLLER = 0x04
RECEIVE_BUFFER_BYTES = 64 << 20
SO_RCVBUFFORCE = 33


@dataclass(frozen=True)
class Frame:
    """One frame: `can_id` with its flags, and its data."""

    can_id: int
    data: bytes


class Bus:
    """An open raw socket on one interface."""

    def __init__(self, interface: str, *can_ids: int) -> None:
        self._socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self._socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, RECEIVE_BUFFER_BYTES)
        if can_ids:
            filters = b"".join(struct.pack("=II", can_id, ID_MASK) for can_id in can_ids)
            self._socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
        self._socket.bind((interface,))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, can_id: int, data: bytes) -> None:
        """Send one frame; an id may carry flags, such as that of an error frame."""
        self._socket.send(FRAME.pack(can_id, len(data), data.ljust(8, b"\0")))

    def receive(self, timeout_s: float) -> Frame | None:
        """Return the next frame, or nothing if none comes in time."""
        self._socket.settimeout(timeout_s)
        try:
            can_id, length, data = FRAME.unpack(self._socket.recv(FRAME_BYTES))
        except TimeoutError:
            return None
        except OSError as error:
            if error.errno != errno.ENETDOWN:
                raise
            return self.receive(timeout_s)  # said once, however often the interface was down
        return Frame(can_id, data[:length])

    def receive_raw(self, quiet_s: float, deadline_s: float, most: int) -> bytes:
        """Collect frames until `most` are there, `quiet_s` pass without one, or time is up."""
        self._socket.settimeout(quiet_s)
        frames: list[bytes] = []
        receive = self._socket.recv
        end_s = time.monotonic() + deadline_s
        try:
            while len(frames) < most:
                frames.append(receive(FRAME_BYTES))
                if len(frames) % 1024 == 0 and time.monotonic() > end_s:
                    break
        except TimeoutError:
            pass
        return b"".join(frames)

    def drain(self, quiet_s: float = 0.2) -> list[Frame]:
        """Return all frames until `quiet_s` pass without one."""
        frames = []
        while (frame := self.receive(quiet_s)) is not None:
            frames.append(frame)
        return frames
