"""How late things come, beside cyclictest and can-utils, in turn and in one run.

Part of `make bench`, and the end of the suite of the rig: `python -m tests.bench.latency`. What has
no devices or no counterpart here is skipped, loudly, and counted. Prints µs at the median, at 99 %
and the most, and the ratio of ours to theirs; the ratios of the rounds are taken in pairs, and
their median is printed, so that a disturbance that comes and goes hits both. JSON goes to
`BENCH_OUT/latency.json`.
"""

import json
import os
import re
import shutil
import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.bench import injection
from tests.bench.bus import Bus
from tests.bench.injection import EDGE_ID, STATUS_ID, Host, edges_of
from tests.bench.latches import decode
from tests.bench.programs import LATCH_ID, controller, injector
from tests.bench.rig import PROGRAMS, Rig

ROUNDS = int(os.environ.get("BENCH_ROUNDS", "3"))
SCANS = 2000
TRIPS = 1000
TOUCHES = 1000
PERIOD_US = 1000
GAP_US = 500
FIFO = 80
AIM = 1.1
OF_RIG = ("CAN round trip", "CAN to the reader", "edge to latch")  # what needs the devices
HISTOGRAM_US = 20_000
CANFDTEST_REQUEST, CANFDTEST_ANSWER = 0x77, 0x78
Micros = NDArray[np.float64]
Sample = Callable[[], Micros]


def fifo_here() -> int:
    """Tell with which SCHED_FIFO priority both sides run; 0, the usual, without privilege."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        return 0
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    return FIFO


def run(*command: str, text: str = "", answers: int | None = None) -> str:
    """Run a program and return what it printed; `answers` becomes its descriptor 3."""
    if answers is not None:
        command = ("sh", "-c", f'exec "$@" 3<&{answers}', "sh", *command)
    fds = () if answers is None else (answers,)
    return subprocess.run(
        command, input=text, stdout=subprocess.PIPE, text=True, check=True, pass_fds=fds
    ).stdout


def micros(text: str) -> Micros:
    """Nanoseconds, one a line, as µs."""
    times = np.array(text.split(), dtype=float) / 1000.0
    if np.any(times < 0):
        raise RuntimeError(f"{np.count_nonzero(times < 0)} of {len(times)} went unanswered")
    return times


# ---- scan wake-up ----


def our_wake(cpu: str, fifo: int) -> Micros:
    """Lateness of the port's scans."""
    program = str(PROGRAMS / "tests/bench/scan_wake")
    return micros(run(program, str(PERIOD_US), str(SCANS), str(fifo), cpu))


def their_wake(cpu: str, fifo: int) -> Micros:
    """Lateness that cyclictest sees, from its histogram: a value stands for its microsecond."""
    privileged = ("--mlockall", f"--priority={fifo}") if fifo else ()
    text = run(
        *("cyclictest", "--quiet", *privileged, f"--affinity={cpu}"),
        *(f"--interval={PERIOD_US}", f"--loops={SCANS}", f"--histogram={HISTOGRAM_US}"),
    )
    pairs = np.array(re.findall(r"^(\d+) (\d+)\s*$", text, re.MULTILINE), dtype=int)
    return np.repeat(pairs[:, 0] + 0.5, pairs[:, 1])


# ---- CAN round trip ----


def requests(can_id: int, data: Sequence[bytes]) -> str:
    """Return requests as can_round_trip reads them."""
    return "".join(f"{can_id:03x}#{part.hex()}\n" for part in data)


def trip(rig: Rig, cpu: str, answer_id: int, text: str, answers: int | None = None) -> Micros:
    """Time the round trips of these requests."""
    program = str(PROGRAMS / "tests/bench/can_round_trip")
    command = ("taskset", "-c", cpu, "chrt", "-f", str(FIFO), program)
    return micros(run(*command, rig.can, f"{answer_id:x}", str(GAP_US), text=text, answers=answers))


def our_trip(rig: Rig, cpu: str) -> Micros:
    """Ask the injector for its state."""
    ask = injection.frame(injection.ASK, b"\0", 0)
    with injector(rig, rig.line(0), "--cpu", cpu, "--fifo", str(FIFO)):
        return trip(rig, cpu, STATUS_ID, requests(injection.COMMAND_ID, [ask] * TRIPS))


def their_trip(rig: Rig, cpu: str) -> Micros:
    """Let canfdtest, the echo of can-utils, answer."""
    data = [bytes((number + i) & 0xFF for i in range(8)) for number in range(TRIPS)]
    command = ("taskset", "-c", cpu, "chrt", "-f", str(FIFO), "canfdtest", rig.can)
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as echo:
        time.sleep(0.5)
        try:
            return trip(rig, cpu, CANFDTEST_ANSWER, requests(CANFDTEST_REQUEST, data))
        finally:
            echo.terminate()


def candump_trip(rig: Rig, cpu: str) -> Micros:
    """Until candump has printed the frame: one way over CAN, the other through a pipe."""
    command = ("taskset", "-c", cpu, "chrt", "-f", str(FIFO), "candump", "-L", rig.can)
    with subprocess.Popen(command, stdout=subprocess.PIPE) as dump:
        time.sleep(0.5)
        assert dump.stdout is not None
        try:
            text = requests(CANFDTEST_REQUEST, [bytes(8)] * TRIPS)
            return trip(rig, cpu, 0, text, answers=dump.stdout.fileno())
        finally:
            dump.terminate()


# ---- edge to latch ----


def edge_to_latch(rig: Rig, path: str) -> Micros:
    """From the injector's edge to the latch's own time."""
    with (
        Bus(rig.can, LATCH_ID, STATUS_ID, EDGE_ID) as bus,
        injector(rig, rig.line(0), "--fifo", "85"),  # so that it sees its edge at once
        controller(rig, rig.line(0), "--fifo", str(FIFO), "--scan-us", "1000", path=path),
    ):
        host = Host(bus)
        host.shoot(count=TOUCHES, period_us=5137, width_us=2500)
        raw = bus.receive_raw(2.0, 60.0, 4 * TOUCHES)
    edges, latches = edges_of(raw), decode(raw, LATCH_ID)
    times_ns = latches.times_ns(int(edges.time_ns[0]))
    earliest_ns = edges.time_ns - edges.half_window_ns
    own = np.searchsorted(earliest_ns, times_ns, side="right") - 1
    missed = len(edges) - len(np.unique(own))
    if missed:
        print(f"  {path}: {missed} of {len(edges)} edges were not latched, or not told apart")
    return (times_ns - edges.time_ns[own]) / 1000.0


# ---- report ----


def figures(times: Micros) -> dict[str, float]:
    """Median, 99 % and most of some times, µs."""
    return {
        "median_us": float(np.median(times)),
        "p99_us": float(np.quantile(times, 0.99)),
        "max_us": float(times.max()),
    }


def show(name: str, times: Micros) -> dict[str, float]:
    """Print one distribution."""
    result = figures(times)
    print(
        f"  {name:34} {result['median_us']:10.1f} {result['p99_us']:10.1f} {result['max_us']:10.1f}"
    )
    return result


def beside(title: str, ours: tuple[str, Sample], theirs: tuple[str, Sample]) -> dict[str, object]:
    """Measure two things in turn, print both and the ratios."""
    rounds = [(ours[1](), theirs[1]()) for _ in range(ROUNDS)]
    print(f"{title}, µs {'median':>37} {'99 %':>10} {'most':>10}")
    result: dict[str, object] = {
        ours[0]: show(ours[0], np.concatenate([a for a, _ in rounds])),
        theirs[0]: show(theirs[0], np.concatenate([b for _, b in rounds])),
    }
    for key, name in (("median_us", "median"), ("p99_us", "99 %")):
        ratio = float(np.median([figures(a)[key] / figures(b)[key] for a, b in rounds]))
        result[f"ratio_{key}"] = ratio
        print(f"  ours over {theirs[0]}, {name}: {ratio:.2f}   aim: at most {AIM}")
    return result


def measure_rig(rig: Rig, cpu: str) -> dict[str, object]:
    """Measure what needs the devices."""
    ours: tuple[str, Sample] = ("injector: command, answer", lambda: our_trip(rig, cpu))
    report: dict[str, object] = {
        "trip": beside("CAN round trip", ours, ("canfdtest: echo", lambda: their_trip(rig, cpu))),
        "dump": beside(
            "CAN to the reader",
            ours,
            ("candump: frame, line in a pipe", lambda: candump_trip(rig, cpu)),
        ),
    }
    print(f"edge to latch, µs {'median':>36} {'99 %':>10} {'most':>10}")
    for path in ("skip", "plc"):
        report[f"edge_to_latch_{path}"] = show(path, edge_to_latch(rig, path))
    return report


def measure_wake(cpu: str) -> dict[str, object]:
    """Measure what needs no devices."""
    fifo = fifo_here()
    how = f"SCHED_FIFO {fifo}" if fifo else "usual scheduling, for SCHED_FIFO run as root"
    return {
        "wake": beside(
            f"scan wake-up every {PERIOD_US} µs, {how}",
            ("timerfd of the port", lambda: our_wake(cpu, fifo)),
            ("cyclictest", lambda: their_wake(cpu, fifo)),
        )
    }


def lacking_for_wake() -> list[str]:
    """Name what the wake-up needs and is not here."""
    lacking = [] if shutil.which("cyclictest") else ["cyclictest (package rt-tests)"]
    has_port = (PROGRAMS / "tests/bench/scan_wake").exists()
    return lacking if has_port else [*lacking, "the Linux port (needs libgpiod 2)"]


def lacking_for_rig(rig: Rig | None) -> list[str]:
    """Name what CAN and edges need and is not here."""
    lacking = [] if shutil.which("canfdtest") else ["can-utils"]
    has_port = (PROGRAMS / "tests/bench/can_round_trip").exists()
    lacking += [] if has_port else ["the Linux port (needs libgpiod 2)"]
    return lacking if rig else [*lacking, "vcan and gpio-sim (make bench-vm has them)"]


def main() -> None:
    """Measure everything there is to measure on, print it, and count what is skipped."""
    cpu = str((os.cpu_count() or 1) - 1)
    rig = Rig.from_environment()
    report: dict[str, object] = {}
    skipped: list[str] = []
    lacking = lacking_for_wake()
    if lacking:
        skipped += ["wake-up latency"]
        print(f"SKIPPED: {skipped[-1]}: not here: {', '.join(lacking)}")
    else:
        report |= measure_wake(cpu)
    lacking = lacking_for_rig(rig)
    if rig is None or lacking:
        skipped += list(OF_RIG)
        print(f"SKIPPED: {', '.join(OF_RIG)}: not here: {', '.join(lacking)}")
    else:
        report |= measure_rig(rig, cpu)
    measured = len(OF_RIG) + 1 - len(skipped)
    print(f"latencies: {measured} measured, {len(skipped)} skipped")
    out = os.environ.get("BENCH_OUT")
    if out:
        Path(out, "latency.json").write_text(json.dumps(report, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
