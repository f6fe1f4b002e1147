"""What a command has written is taken back if it fails: its outputs are all there, or none."""

import os
import secrets
import shutil
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import click

LEFTOVER_S = 86_400.0
"""Age of a temporary file that no command can be at work with any longer."""
INTERRUPTED, TERMINATED = 128 + signal.SIGINT, 128 + signal.SIGTERM
"""Exit statuses, as a shell gives them."""


@dataclass(frozen=True, slots=True)
class _Step:
    """A file or folder that is about to be replaced.

    Attributes:
        target: What is replaced.
        made: Device and inode of what replaces it.
        backup: Where the file that stood there is kept.
        was_folder: Whether an empty folder stood there.
    """

    target: Path
    made: tuple[int, int]
    backup: Path
    was_folder: bool

    def keep(self) -> None:
        """Keep the file that stands there, if one does, under the name of the backup, too."""
        if self.target.is_file():
            try:
                os.link(self.target, self.backup)
            except OSError:  # a file system without links
                shutil.copy2(self.target, self.backup)

    def take_back(self) -> None:
        """Put back what stood there; what others have put there since is left alone."""
        if not self.target.exists() or _identity(self.target) != self.made:
            self.backup.unlink(missing_ok=True)
        elif self.backup.exists():
            self.backup.replace(self.target)
        elif self.target.is_dir():
            shutil.rmtree(self.target)
            if self.was_folder:
                self.target.mkdir()
        else:
            self.target.unlink()

    def let_stand(self) -> None:
        """Forget what stood there."""
        self.backup.unlink(missing_ok=True)


@dataclass(frozen=True, slots=True)
class _MadeFolder:
    """A folder that was made to put an output into."""

    path: Path

    def take_back(self) -> None:
        """Remove it, if nothing of others is in it."""
        self.path.rmdir()

    def let_stand(self) -> None:
        """Do nothing: it is there."""


def _identity(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_dev, status.st_ino


_STEPS: ContextVar[list[_Step | _MadeFolder] | None] = ContextVar("steps", default=None)


def make_folders(path: Path) -> None:
    """Make a folder and those above it where they are missing; see `replace`."""
    if not path.exists():
        make_folders(path.parent)
        path.mkdir(exist_ok=True)
        if (steps := _STEPS.get()) is not None:
            steps.append(_MadeFolder(path))


def replace(temporary: Path, target: Path) -> None:
    """Put a file or folder in its place, from which a command that fails takes it back."""
    steps = _STEPS.get()
    if steps is not None:
        backup = temporary_sibling(target)
        step = _Step(target, _identity(temporary), backup, was_folder=target.is_dir())
        steps.append(step)
        step.keep()
    temporary.replace(target)


def keep_outputs() -> None:
    """Let what was written until now stand, whatever comes."""
    steps = _STEPS.get() or []
    while steps:
        steps.pop().let_stand()


@contextmanager
def taken_back_on_failure() -> Iterator[None]:
    """Take back at the end of the block what was written in it, if an exception ends it.

    An exit that a command asks for is no failure, nor is a reader of stdout that leaves (`| head`):
    what it was told to be written stands.
    """
    steps: list[_Step | _MadeFolder] = []
    token = _STEPS.set(steps)
    try:
        with _ended_in_order():
            yield
        keep_outputs()
    except (click.exceptions.Exit, BrokenPipeError):
        keep_outputs()
        raise
    except BaseException:
        while steps:
            with suppress(OSError):
                steps[-1].take_back()
            steps.pop()
        raise
    finally:
        _STEPS.reset(token)


@contextmanager
def _ended_in_order() -> Iterator[None]:
    """Turn SIGTERM into an exception, so that no temporary file is left.

    DuckDB puts a RuntimeError in place of what a signal's handler raises while a query runs. So
    that is noted, and raised in the end.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked: list[SystemExit | KeyboardInterrupt] = []

    def end(number: int, _: object) -> NoReturn:
        is_terminated = number == signal.SIGTERM
        asked.append(SystemExit(TERMINATED) if is_terminated else KeyboardInterrupt())
        raise asked[-1]

    before = {signal.SIGTERM: signal.signal(signal.SIGTERM, end)}
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        before[signal.SIGINT] = signal.signal(signal.SIGINT, end)
    try:
        yield
    except RuntimeError as error:
        if asked and type(error) is RuntimeError:  # an exit that a command asks for is one, too
            raise asked[-1] from error
        raise
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def temporary_sibling(target: Path) -> Path:
    """Give a name that nothing has, beside the target; old leftovers there are removed."""
    oldest_s = time.time() - LEFTOVER_S
    for leftover in target.parent.glob(".skiplatch-*.tmp"):
        with suppress(OSError):
            if leftover.lstat().st_ctime < oldest_s:
                shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink()
    return target.with_name(f".skiplatch-{secrets.token_hex(8)}.tmp")
