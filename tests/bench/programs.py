"""The C programs under test, as child processes."""

import json
import os
import signal
import subprocess
from typing import IO, Self, cast

from tests.bench.rig import PROGRAMS, Line, Rig

PATIENCE_S = 30.0
LATCH_ID = 0x181


class Program:
    """A started program that says `ready` and, when it ends, prints its counters as JSON."""

    def __init__(self, name: str, *options: str) -> None:
        command = [str(PROGRAMS / name), *options]
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.pid = self.process.pid

    def __enter__(self) -> Self:
        line = cast(IO[str], self.process.stdout).readline()
        if line.strip() != "ready":
            errors = self.process.communicate(timeout=PATIENCE_S)[1]
            raise AssertionError(f"not ready but {line!r}: {errors}")
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def stop(self) -> dict[str, int]:
        """End the program politely and return its counters."""
        self.process.send_signal(signal.SIGINT)
        return self.finish()

    def finish(self) -> dict[str, int]:
        """Wait for the program to end by itself and return its counters."""
        output, errors = self.process.communicate(timeout=PATIENCE_S)
        assert self.process.returncode == 0, errors
        return cast(dict[str, int], json.loads(output.splitlines()[-1]))

    def outcome(self) -> tuple[int, str]:
        """Wait for the program to end and return its status and what it complained of."""
        errors = self.process.communicate(timeout=PATIENCE_S)[1]
        return self.process.returncode, errors

    def kill(self) -> None:
        """End the program as a power cut would."""
        self.process.kill()
        self.process.wait()

    def is_running(self) -> bool:
        """Tell whether the program has not ended."""
        return self.process.poll() is None


def controller(rig: Rig, line: Line, *options: str, path: str = "skip") -> Program:
    """Start a controller that watches `line`."""
    return Program(
        "skiplatch-controller",
        *("--chip", str(rig.chip), "--line", str(line.offset), "--can", rig.can),
        *("--path", path, *options),
    )


def injector(rig: Rig, line: Line, *options: str) -> Program:
    """Start an injector that drives `line`."""
    return Program("skiplatch-injector", "--can", rig.can, "--sim-pull", str(line.pull), *options)


def run(name: str, *options: str) -> tuple[int, str]:
    """Run a program that is expected to end at once; return its status and its complaint."""
    done = subprocess.run(
        [PROGRAMS / name, *options],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    return done.returncode, done.stderr


def pin(cpu: int) -> None:
    """Keep this process on one processor."""
    os.sched_setaffinity(0, {cpu})
