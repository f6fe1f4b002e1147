"""Print the latches in a log of the bus: read_log.py DBC LOG (candump -L, ASC, BLF, …)."""

import sys
from binascii import crc_hqx  # CRC-16/CCITT-FALSE, given 0xFFFF to start from

import can
import cantools

RECORD = cantools.database.load_file(sys.argv[1]).get_message_by_name("LatchRecord")
frames = (f for f in can.LogReader(sys.argv[2]) if not f.is_extended_id and len(f.data) == 8)
halves = [bytes(f.data) for f in frames if f.arbitration_id == RECORD.frame_id]
# A bus may bring a record twice. What a CRC was made of, and the CRC behind it, has the CRC 0.
for one, two in dict.fromkeys(zip(halves, halves[1:])):
    if not crc_hqx(one[:6] + one[:5:-1], 0xFFFF) | crc_hqx(one[:6] + two[:6] + two[:5:-1], 0xFFFF):
        print(RECORD.decode(one) | RECORD.decode(two))
