"""Frames with a foreign id, to disturb the bench.

``python -m skiplatch.bench.flood IFACE RATE`` sends RATE of them a second.
"""

import errno
import socket
import struct
import sys
import time

FOREIGN_ID = 0x7F0
FRAME = struct.pack("=IB3x8s", FOREIGN_ID, 8, bytes(8))  # struct can_frame
QUEUE_FULL = (errno.ENOBUFS, errno.EAGAIN)
BURST_S = 0.001  # a process cannot sleep for much less
BEHIND_S = 0.005  # what was due earlier than that is not made good in one burst


def main() -> int:
    """Send RATE frames a second until SIGINT comes; what the bus does not take is left out."""
    interface, rate_per_s = sys.argv[1], float(sys.argv[2])
    sent = refused = 0
    try:
        with _open(interface) as bus:
            print("ready", flush=True)
            start_s = time.monotonic()
            while True:
                start_s = max(start_s, time.monotonic() - BEHIND_S - sent / rate_per_s)
                due = int((time.monotonic() - start_s) * rate_per_s)
                while sent < due:
                    refused += not _send(bus)
                    sent += 1
                time.sleep(BURST_S)
    except KeyboardInterrupt:
        print(f'{{"frames": {sent - refused}, "refused": {refused}}}', flush=True)
        return 0
    except OSError as error:
        print(f"flood: {interface}: {error.strerror}; ip link set {interface} up", file=sys.stderr)
        return 2


def _open(interface: str) -> socket.socket:
    """Open a socket that hears nothing; python-can takes ten times as long for a frame."""
    bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    bus.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"")
    bus.bind((interface,))
    return bus


def _send(bus: socket.socket) -> bool:
    try:
        bus.send(FRAME, socket.MSG_DONTWAIT)
    except OSError as error:
        if error.errno in QUEUE_FULL:
            return False
        raise
    return True


if __name__ == "__main__":
    sys.exit(main())
