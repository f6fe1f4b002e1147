"""How fast the transmission error is measured: pulses a second on one core, and in what memory."""

import resource
import time
from fractions import Fraction
from statistics import median

import numpy as np

from skiplatch.transmission.firmware import INPUT, OUTPUT, Method, Transmission

LINES = (1024, 3600)
RATIO = Fraction(407, 10)
REV_PER_S = 5.0
TICK_NS = 100
BLOCK_TURNS = 10
BLOCKS = 20
ROUNDS = 5
AIM_PER_S = 20e6
KIB_PER_MIB = 1024


def block() -> tuple[np.ndarray, np.ndarray, int]:
    """Pulses of some output turns at an even speed, and how long they take in nanoseconds."""
    duration_s = BLOCK_TURNS * float(RATIO) / REV_PER_S
    counts = (int(BLOCK_TURNS * RATIO * LINES[0]), BLOCK_TURNS * LINES[1])
    times_s = [duration_s * (np.arange(n) + 0.3) / n for n in counts]
    channel = np.repeat(np.array([INPUT, OUTPUT], dtype=np.uint8), counts)
    t_ns = (np.concatenate(times_s) * 1e9).astype(np.int64) // TICK_NS * TICK_NS
    order = np.argsort(t_ns, kind="stable")
    return channel[order], t_ns[order], round(duration_s * 1e9)


def rate(method: Method, channel: np.ndarray, t_ns: np.ndarray, duration_ns: int) -> float:
    """Pulses a second over many blocks, one after the other."""
    run = Transmission(*LINES, RATIO, method, tick_ns=TICK_NS)
    spent_s = 0.0
    for number in range(BLOCKS):
        shifted_ns = t_ns + number * duration_ns
        start = time.perf_counter()
        run.feed(channel, shifted_ns)
        spent_s += time.perf_counter() - start
    return BLOCKS * len(t_ns) / spent_s


def peak_mib() -> float:
    """Largest memory of the process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / KIB_PER_MIB


def bench_transmission() -> None:
    """Time the five methods in turn."""
    pulses = block()
    rate(Method.SUBDIVIDED, *pulses)
    before_mib = peak_mib()
    rates: dict[Method, list[float]] = {method: [] for method in Method}
    for _ in range(ROUNDS):
        for method in Method:
            rates[method].append(rate(method, *pulses))
    print(f"transmission error, medians of {ROUNDS} rounds of {BLOCKS * len(pulses[0]):,} pulses")
    for method, found in rates.items():
        print(
            f"  {method:17s} {median(found) / 1e6:8.1f} million pulses/s on one core   "
            f"aim: {AIM_PER_S / 1e6:.0f}"
        )
    total = len(Method) * ROUNDS * BLOCKS * len(pulses[0])
    print(f"  memory over {total:,} pulses {peak_mib() - before_mib:6.1f} MiB more   aim: 0")


if __name__ == "__main__":
    bench_transmission()
