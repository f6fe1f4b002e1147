"""A busy process, to disturb the bench.

``python -m skiplatch.bench.busy CPU SHARE PERIOD PRIORITY`` is busy for SHARE of each PERIOD (µs)
on processor CPU, with SCHED_FIFO at PRIORITY unless that is 0.
"""

import os
import sys
import time

from skiplatch.units import US_PER_S


def main() -> int:
    """Take the processor until SIGINT comes."""
    cpu, priority = int(sys.argv[1]), int(sys.argv[4])
    share, period_s = float(sys.argv[2]), float(sys.argv[3]) / US_PER_S
    try:
        os.sched_setaffinity(0, {cpu})
        if priority:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        print(
            f"busy: processor {cpu} with SCHED_FIFO {priority}: {error.strerror}; run as root, or "
            "set load.cpu_priority to 0",
            file=sys.stderr,
        )
        return 2
    try:
        print("ready", flush=True)
        while True:
            start_s = time.monotonic()
            while time.monotonic() - start_s < share * period_s:
                pass
            time.sleep(max(0.0, start_s + period_s - time.monotonic()))
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
