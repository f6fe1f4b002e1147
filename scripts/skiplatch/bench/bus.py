"""A CAN bus by python-can, and what to do where there is none."""

import errno
import time
from pathlib import Path

import can

from skiplatch.bench.protocol import EDGE_ID, LATCH_ID, STATUS_ID
from skiplatch.errors import InputError

SOCKETCAN = "socketcan"
NS_PER_S = 1_000_000_000
ID_MASK = 0x7FF
INTERFACES = Path("/sys/class/net")
FLAG_UP = 0x1


def open_bus(interface: str, backend: str = SOCKETCAN, latch_id: int = LATCH_ID) -> can.BusABC:
    """Open the interface for what injector and controller send.

    Raises:
        InputError: There is no such interface, or it cannot be had; the message tells the remedy.
    """
    if backend == SOCKETCAN:
        _refuse_absent(interface)
    try:
        return can.Bus(
            channel=interface,
            interface=backend,
            can_filters=[
                {"can_id": wanted, "can_mask": ID_MASK, "extended": False}
                for wanted in (STATUS_ID, EDGE_ID, latch_id)
            ],
        )
    except (OSError, can.CanError, ValueError) as error:
        raise InputError(interface, None, None, _explained(interface, error)) from error


def arrival_ns(message: can.Message) -> int:
    """Give when a message arrived, on CLOCK_MONOTONIC.

    The kernel stamps on the wall clock; the offset between the two is taken as it is now.
    """
    if not message.timestamp:
        return time.monotonic_ns()
    age_ns = time.time_ns() - int(message.timestamp * NS_PER_S)
    return time.monotonic_ns() - max(age_ns, 0)


def _refuse_absent(interface: str) -> None:
    flags = INTERFACES / interface / "flags"
    if "/" in interface or not flags.is_file():
        message = (
            "no such CAN interface; see: ip -br link show type can; for a virtual one: modprobe "
            f"vcan; ip link add {interface} type vcan; ip link set {interface} up"
        )
        raise InputError(interface, None, None, message)
    if not int(flags.read_text(), 16) & FLAG_UP:
        message = f"the interface is down; ip link set {interface} up"
        raise InputError(interface, None, None, message)


def _explained(interface: str, error: Exception) -> str:
    match getattr(error, "errno", None) or getattr(error, "error_code", None):
        case errno.EAFNOSUPPORT | errno.EPROTONOSUPPORT:
            return "this kernel has no SocketCAN; modprobe can-raw"
        case errno.EPERM | errno.EACCES:
            return "no permission for CAN sockets; run as root"
        case errno.ENODEV:
            return "no CAN interface; see: ip -br link show type can"
        case errno.ENETDOWN:
            return f"the interface is down; ip link set {interface} up"
    return f"cannot be opened: {error}"
