"""Print the latches in a log of the bus: read_log.py DBC LOG (candump -L, ASC, BLF, …)."""

import sys

import can
import cantools

database = cantools.database.load_file(sys.argv[1])
first = {}  # the half that came before
for frame in can.LogReader(sys.argv[2]):
    if frame.arbitration_id == database.get_message_by_name("LatchRecord").frame_id:
        half = database.decode_message(frame.arbitration_id, frame.data)
        if half["Half"] == 0:
            first = half
        elif half["SequenceLow"] == first.get("SequenceLow"):
            number = half["SequenceHigh"] << 7 | half["SequenceLow"]
            print(frame.timestamp, number, first["Channel"], first["Flags"], first["Ticks"],
                  half["PositionCounts"])  # fmt: skip
