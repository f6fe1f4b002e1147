"""A process that works for a command is killed, as where memory runs out."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from pathlib import Path

import pytest

from skiplatch.side_by_side import processes

CAMPAIGN = Path(__file__).parents[2] / "scripts" / "samples" / "bench_isr_latency"
PATIENCE_S = 60.0


def child_of(program: subprocess.Popen[str]) -> int:
    """Wait for the first process that a program starts."""
    children = Path(f"/proc/{program.pid}/task/{program.pid}/children")
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        if found := children.read_text(encoding="ascii").split():
            return int(found[0])
        time.sleep(0.01)
    raise AssertionError("it starts no process")


def test_a_diagnosis_whose_process_is_killed_ends_in_one_line() -> None:
    """With status 2: 1 would say that there is a gap."""
    words = ["diagnose", str(CAMPAIGN), "--jobs", "2", "--fail-on-gap"]
    command = [sys.executable, "-m", "skiplatch", *words]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as program:
        try:
            os.kill(child_of(program), signal.SIGKILL)
            stdout, stderr = program.communicate(timeout=PATIENCE_S)
        finally:
            program.kill()

    assert (program.returncode, stdout) == (2, "")
    died = "a process that did a part of the work died, as out of memory; try fewer --jobs"
    assert stderr == f"skiplatch: {died}\n"


def test_a_busy_process_ends_when_it_is_told_to_whatever_the_program_does_then() -> None:
    """The pool tells it so where another one died, and waits for that."""
    before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    try:
        with processes(1) as executor:
            busy_pid = executor.submit(os.getpid).result(PATIENCE_S)
            busy = executor.submit(time.sleep, PATIENCE_S)
            time.sleep(0.2)
            os.kill(busy_pid, signal.SIGTERM)
            with pytest.raises(BrokenExecutor):
                busy.result(PATIENCE_S)
    finally:
        signal.signal(signal.SIGTERM, before)


def test_a_process_ends_that_is_told_to_before_it_has_begun() -> None:
    """On one processor a new process begins only when the one that made it waits."""
    before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    processors = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(processors)})
    try:
        for _ in range(20):
            with processes(1) as executor:
                waiting = executor.submit(time.sleep, PATIENCE_S)
                (new,) = multiprocessing.active_children()
                new.terminate()
                new.join(PATIENCE_S / 2)
                ended = new.exitcode
                new.kill()
                with pytest.raises(BrokenExecutor):
                    waiting.result(PATIENCE_S)
            assert ended == -signal.SIGTERM
    finally:
        os.sched_setaffinity(0, processors)
        signal.signal(signal.SIGTERM, before)
