"""Campaigns that appear below a folder, each once it is whole."""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE
from skiplatch.errors import InputError
from skiplatch.files import failures_named
from skiplatch.fleet.diagnosed import DIAGNOSIS_FILE

MISSING = "not installed; pip install 'skiplatch[fleet]' brings it"
READING = ("opened", "closed_no_write")
"""Events that come from looking at a file."""
State = dict[str, tuple[int, int]]
"""Size in bytes and time of change in ns of each file of a folder, but for the diagnosis."""


@dataclass(slots=True)
class Arrivals:
    """The campaigns below a folder, and how each stood when it was last dealt with.

    Attributes:
        folder: Where they appear.
        settle_s: How long nothing in a campaign's folder has changed once it is whole.
        dealt_with: By the path of the campaign's folder.
    """

    folder: Path
    settle_s: float
    dealt_with: dict[Path, State] = field(default_factory=dict)

    def look(self) -> tuple[dict[Path, State], list[Path]]:
        """Give what is whole and new, in the order of the names, and what is not whole yet.

        Raises:
            InputError: The folder cannot be read.
        """
        with failures_named(self.folder, "read"):
            if not self.folder.is_dir():
                raise InputError(self.folder, None, None, "no such folder")
            begun = {folder: _state(folder) for folder in sorted(_campaigns(self.folder))}
        new = {
            folder: state for folder, state in begun.items() if self.dealt_with.get(folder) != state
        }
        whole = {folder: state for folder, state in new.items() if self._is_whole(state)}
        return whole, [folder for folder in new if folder not in whole]

    def _is_whole(self, state: State) -> bool:
        settled_ns = time.time_ns() - int(self.settle_s * 1e9)
        has_both = NOMINAL_FILE in state and TOUCHES_FILE in state
        return has_both and max(changed_ns for _, changed_ns in state.values()) <= settled_ns


def _campaigns(folder: Path) -> Iterator[Path]:
    """Give each folder with one of the files of a campaign; what lies in it is part of it."""
    for parent, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".")]
        if NOMINAL_FILE in files or TOUCHES_FILE in files:
            folders.clear()
            yield Path(parent)


def _state(folder: Path) -> State:
    """Take stock; a file that goes meanwhile is seen the next time."""
    found: State = {}
    for parent, _, files in os.walk(folder):
        for name in files:
            path = Path(parent, name)
            if path == folder / DIAGNOSIS_FILE:
                continue  # written by the watch itself
            try:
                status = path.lstat()
            except OSError:
                continue
            changed_ns = max(status.st_mtime_ns, status.st_ctime_ns)
            found[path.relative_to(folder).as_posix()] = status.st_size, changed_ns
    return found


@contextmanager
def noticed(folder: Path) -> Iterator[threading.Event]:
    """Give an event that is set whenever something below a folder changes.

    Raises:
        InputError: watchdog is not installed, or the folder cannot be watched.
    """
    try:
        from watchdog.events import FileSystemEvent, FileSystemEventHandler  # noqa: PLC0415
        from watchdog.observers import Observer  # noqa: PLC0415 - an optional extra
    except ImportError as error:
        raise InputError("watchdog", None, None, MISSING) from error
    event = threading.Event()

    class Notice(FileSystemEventHandler):
        def on_any_event(self, event_: FileSystemEvent) -> None:
            if event_.event_type not in READING:
                event.set()

    observer = Observer()
    with failures_named(folder, "watch"):
        observer.schedule(Notice(), str(folder), recursive=True)
        observer.start()
    try:
        yield event
    finally:
        observer.stop()
        observer.join()
