"""The programs of the bench as child processes: each says "ready", and ends at SIGINT."""

import contextlib
import json
import selectors
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Self

from skiplatch.errors import InputError
from skiplatch.places import ROOT

PROGRAMS = ROOT / "build" / "host"
READY_S = 20.0  # Python itself takes seconds to start on an emulated machine
END_S = 5.0


class Program:
    """A started program; use it in a `with`, which ends it.

    Attributes:
        counters: What it counted, once it has ended; empty if it told nothing.
    """

    def __init__(self, name: str, command: Sequence[str]) -> None:
        self.counters: dict[str, Any] = {}
        self._name = name
        self._command = command
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> Self:
        try:
            # Apart from the terminal, so that Ctrl-C reaches this program alone and ends in order.
            self._process = subprocess.Popen(  # noqa: S603
                self._command,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                start_new_session=True,
            )
        except OSError as error:
            message = f"cannot be started: {error.strerror}"
            raise InputError(self._name, None, None, message) from error
        try:
            self._await_ready(self._process)
        except BaseException:
            self._end(self._process)
            raise
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._end(self._process)

    def check(self) -> None:
        """Raise InputError if the program has ended by itself."""
        if self._process is not None and self._process.poll() is not None:
            self._complain(self._process, "has ended")

    def _await_ready(self, process: subprocess.Popen[str]) -> None:
        assert process.stdout is not None  # noqa: S101 - a pipe was asked for
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            if not selector.select(READY_S):
                message = f"not ready within {READY_S:g} s"
                raise InputError(self._name, None, None, message)
        if process.stdout.readline().strip() != "ready":
            self._complain(process, "did not start")

    def _complain(self, process: subprocess.Popen[str], what: str) -> None:
        """Pass on the program's own last words."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            _, errors = process.communicate(timeout=END_S)
            lines = errors.strip().splitlines()
            if lines:
                words = lines[-1].removeprefix(f"{self._name}: ")
                raise InputError(self._name, None, None, words)
        raise InputError(self._name, None, None, f"{what}: status {process.poll()}")

    def _end(self, process: subprocess.Popen[str]) -> None:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            output, _ = process.communicate(timeout=END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            output, _ = process.communicate()
        except ValueError:  # its pipes were read to the end already
            return
        with contextlib.suppress(ValueError, IndexError):
            counters = json.loads(output.splitlines()[-1])
            self.counters = counters if isinstance(counters, dict) else {}


def compiled(name: str, *options: str) -> Program:
    """Give a C program of the project, not yet started.

    Raises:
        InputError: It was not built.
    """
    path = PROGRAMS / name
    if not path.is_file():
        message = "not built; make setup (needs libgpiod 2, see the lines that begin with SKIPPED)"
        raise InputError(path, None, None, message)
    return Program(name, [str(path), *options])


def module(name: str, *options: str) -> Program:
    """Give a module of the bench as a program, not yet started."""
    title = Path(name.replace(".", "/")).name
    return Program(title, [sys.executable, "-m", name, *options])
