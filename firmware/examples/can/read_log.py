"""Print the latches in a log of the bus: read_log.py DBC LOG (candump -L, ASC, BLF, …)."""

import sys
from binascii import crc_hqx  # CRC-16/CCITT-FALSE, given 0xFFFF to start from

import can
import cantools

RECORD = cantools.database.load_file(sys.argv[1]).get_message_by_name("LatchRecord")


def is_half(frame: can.Message) -> bool:
    """Tell a half of a record from all else on the bus."""
    is_data = not (frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame)
    return is_data and frame.arbitration_id == RECORD.frame_id and len(frame.data) == RECORD.length


def is_good(data: bytes, start: int) -> bool:
    """Hold the CRC of a half against its bytes; that of a second half starts from the first's."""
    return crc_hqx(data[:6], start) == int.from_bytes(data[6:], "little")


first = last = b""  # the half that waits for its second one; the record that was printed last
for frame in filter(is_half, can.LogReader(sys.argv[2])):
    data = bytes(frame.data)
    if not data[0] & 1 and is_good(data, 0xFFFF):
        first = data
    elif first and data[0] == first[0] | 1 and is_good(data, int.from_bytes(first[6:], "little")):
        if first + data != last:  # a bus may bring it twice
            low, high = RECORD.decode(first), RECORD.decode(data)
            number = high["SequenceHigh"] << 7 | low["SequenceLow"]
            print(frame.timestamp, number, low["Channel"], low["Flags"], low["Ticks"],
                  high["PositionCounts"])  # fmt: skip
        first, last = b"", first + data
