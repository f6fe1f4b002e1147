"""Frames with a foreign id, to disturb the bench.

``python -m skiplatch.bench.flood IFACE RATE`` sends RATE of them a second.
"""

import sys
import time

import can

from skiplatch.bench.bus import SOCKETCAN
from skiplatch.errors import InputError

FOREIGN_ID = 0x7F0
BURST_S = 0.001  # a process cannot sleep for much less


def main() -> int:
    """Send RATE frames a second until SIGINT comes; what the bus does not take is left out."""
    interface, rate_per_s = sys.argv[1], float(sys.argv[2])
    message = can.Message(arbitration_id=FOREIGN_ID, data=bytes(8), is_extended_id=False)
    sent = 0
    try:
        with can.Bus(channel=interface, interface=SOCKETCAN, can_filters=[]) as bus:
            print("ready", flush=True)
            start_s = time.monotonic()
            while True:
                due = int((time.monotonic() - start_s) * rate_per_s)
                while sent < due:
                    _send(bus, message)
                    sent += 1
                time.sleep(BURST_S)
    except KeyboardInterrupt:
        print(f'{{"frames": {sent}}}', flush=True)
        return 0
    except (OSError, InputError, can.CanError) as error:
        print(f"flood: {interface}: {error}", file=sys.stderr)
        return 2


def _send(bus: can.BusABC, message: can.Message) -> None:
    try:
        bus.send(message)
    except can.CanOperationError:
        time.sleep(BURST_S)


if __name__ == "__main__":
    sys.exit(main())
