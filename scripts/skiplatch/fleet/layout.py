"""Where what stands in a store, and which stores and names are refused."""

import json
import os
import re
import shutil
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from urllib.parse import quote

from skiplatch.errors import InputError, quoted
from skiplatch.files import atomic_write_folder, failures_named, read_json

FORMAT = "skiplatch-fleet/1"
STORE_FILE, LOCK_FILE, INDEX_FILE = "store.json", "lock", "campaigns.parquet"
TOUCHES, FOLDERS = "touches", "folders"
ENDINGS = {TOUCHES: ".parquet", FOLDERS: ".zip"}
KEY_DIGITS = 12
"""Of a campaign's key, as people see it; 1 in 10⁶ that two of 24,000 campaigns share them."""
LONGEST_RIG = 60
MOST_RIG_BYTES = 240  # with "rig=" what a file system takes as a name
_TEMPORARY = re.compile(r"\.skiplatch-[0-9a-f]{16}\.tmp")
_PARTITIONS = (re.compile(r"rig=.+"), re.compile(r"month=[0-9]{4}-[0-9]{2}"))
_FILE = re.compile(r"[0-9a-f]{64}")
_PATTERN_CHARACTERS = "*?[]"
_IGNORED = {"lost+found", ".snapshot", ".DS_Store", "Thumbs.db"}
"""What file systems and their viewers put into any folder."""
LEFT_S = 60.0
"""Age of a temporary file that nobody is at work with. A writer that fails takes back what it wrote
after it has let go of the lock, from such files; that takes no minute."""


def create(path: Path) -> None:
    """Make an empty store, with the folders above it.

    Raises:
        InputError: Something stands there, or it cannot be written.
    """
    text = json.dumps({"format": FORMAT}) + "\n"
    atomic_write_folder(path, {STORE_FILE: text, LOCK_FILE: ""})


def refuse_inside(path: Path) -> None:
    """Raise InputError for a new store that would lie in another one, where it is foreign."""
    for parent in path.parents:
        if (parent / STORE_FILE).is_file() and (parent / LOCK_FILE).is_file():
            raise InputError(path, None, None, f"lies in the store {parent}; put it elsewhere")


def remove_leftovers(path: Path) -> None:
    """Remove what killed writers have left; only for the one that holds the lock."""
    latest_s = time.time() - LEFT_S
    for parent, folders, files in os.walk(path):
        for name in filter(_TEMPORARY.fullmatch, (*folders, *files)):
            leftover = Path(parent, name)
            with suppress(OSError):
                if leftover.lstat().st_ctime <= latest_s:
                    shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink()
        folders[:] = [name for name in folders if name not in _IGNORED]


def refuse_foreign(path: Path) -> None:
    """Raise InputError unless this is a store of this version that is whole and all its own."""
    if not path.is_dir():
        reason = "not a folder" if path.exists() else "no such store; skiplatch fleet add makes one"
        raise InputError(path, None, None, reason)
    if set(_PATTERN_CHARACTERS) & set(os.fspath(path)):
        message = f"the name of a store has none of the characters {_PATTERN_CHARACTERS}"
        raise InputError(path, None, None, message)
    with failures_named(path, "read"):
        if not (path / STORE_FILE).exists():
            raise InputError(path, None, None, f"no store: it has no {STORE_FILE}")
        _refuse_version(path / STORE_FILE)
        if not (path / INDEX_FILE).exists() and any((path / table).exists() for table in ENDINGS):
            raise InputError(path / INDEX_FILE, None, None, "gone, though the store has campaigns")
        for foreign in _foreign(path):
            message = "a foreign file in the store; move it away, nothing was changed"
            raise InputError(foreign, None, None, message)


def _refuse_version(path: Path) -> None:
    document = read_json(path)
    found = document.get("format") if isinstance(document, dict) else None
    if found != FORMAT:
        message = f"expected a store of the format {quoted(FORMAT)}, got {quoted(str(found))}"
        raise InputError(path, None, None, f"{message}; a newer skiplatch may have written it")


def _foreign(path: Path) -> Iterator[str]:
    """Give what no skiplatch has put there."""
    for entry in _entries(path):
        if entry.name in ENDINGS and entry.is_dir(follow_symlinks=False):
            yield from _foreign_below(Path(entry.path), ENDINGS[entry.name], 0)
        elif not _TEMPORARY.fullmatch(entry.name) and (
            entry.name not in (STORE_FILE, LOCK_FILE, INDEX_FILE)
            or not entry.is_file(follow_symlinks=False)
        ):
            yield entry.path


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    return [entry for entry in os.scandir(folder) if entry.name not in _IGNORED]


def _foreign_below(folder: Path, ending: str, depth: int) -> Iterator[str]:
    for entry in _entries(folder):
        if depth < len(_PARTITIONS):
            if entry.is_dir(follow_symlinks=False) and _PARTITIONS[depth].fullmatch(entry.name):
                yield from _foreign_below(Path(entry.path), ending, depth + 1)
            elif not _TEMPORARY.fullmatch(entry.name):
                yield entry.path
        elif not _TEMPORARY.fullmatch(entry.name) and not (
            entry.is_file(follow_symlinks=False)
            and entry.name.endswith(ending)
            and _FILE.fullmatch(entry.name.removesuffix(ending))
        ):
            yield entry.path


def place(store: Path, table: str, rig: str, month: str, name: str) -> Path:
    """Give the path of a file, partitioned as Hive does it.

    Args:
        store: The store.
        table: `TOUCHES` or `FOLDERS`.
        rig: See `refuse_rig`.
        month: As in 2026-03.
        name: 64 hexadecimal digits.
    """
    partition = store / table / f"rig={quote(rig, safe='')}" / f"month={month}"
    return partition / f"{name}{ENDINGS[table]}"


def refuse_rig(path: Path, rig: object) -> str:
    """Give the name of a rig, or raise InputError for one that is none."""
    expected = f"expected the name of a rig, 1 to {LONGEST_RIG} printable characters"
    if not isinstance(rig, str) or not 0 < len(rig) <= LONGEST_RIG or not rig.isprintable():
        raise InputError(path, None, "rig", f"{expected}, got {quoted(str(rig))}")
    taken = len(quote(rig, safe="", errors="replace"))
    if taken > MOST_RIG_BYTES:
        most = f"of at most {MOST_RIG_BYTES} bytes as the name of a folder"
        why = "where each byte that is not of an ASCII letter or digit takes three"
        raise InputError(path, None, "rig", f"expected a name {most}, got {taken}, {why}")
    return rig
