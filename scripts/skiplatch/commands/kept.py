"""Answers kept beside the document that they are for: a command goes on where it was cut."""

import hashlib
import io
import json
import pickle
import re
import sys
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

from skiplatch import undo
from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE
from skiplatch.commands.outputs import STDOUT
from skiplatch.errors import InputError
from skiplatch.executors import software
from skiplatch.files import atomic_write_bytes, failures_named, read_json
from skiplatch.workers import Keeper

ENDING = ".part"
ARRAYS = {
    ("numpy._core.numeric", "_frombuffer"),
    ("numpy._core.multiarray", "_reconstruct"),
    ("numpy._core.multiarray", "scalar"),
    ("numpy", "ndarray"),
    ("numpy", "dtype"),
}
"""What a pickled array is read by."""
ANSWER = re.compile(r"[0-9a-f]{64}|\.skiplatch-[0-9a-f]{16}\.tmp")


@dataclass(frozen=True, slots=True)
class Kept(Keeper):
    """A folder of answers, a file each; none where no document is asked for.

    Attributes:
        folder: OUT.part, beside the document OUT.
    """

    folder: Path | None = None

    @classmethod
    def beside(cls, document: Path | None) -> "Kept":
        """Give the folder of a document.

        Raises:
            InputError: Something lies there that is no such folder, or holds other files.
        """
        if document is None or document == STDOUT:
            return cls(None)
        folder = document.with_name(document.name + ENDING)
        with failures_named(folder, "read"):
            is_own = not folder.exists() or all(map(_is_answer, folder.iterdir()))
        if folder.is_symlink() or not is_own:
            message = "expected nothing, or answers of an earlier diagnosis and no other file"
            raise InputError(folder, None, None, message)
        return cls(folder)

    def get(self, key: str) -> Mapping[str, Any] | None:
        """Give an answer; None if it is not there."""
        if self.folder is None or not (self.folder / key).exists():
            return None
        with suppress(InputError):  # damaged, so it is made anew
            answer = read_json(self.folder / key)
            return answer if isinstance(answer, dict) else None
        return None

    def put(self, key: str, answer: Mapping[str, Any]) -> None:
        """Keep an answer, whatever comes."""
        self._write(key, lambda: json.dumps(answer, allow_nan=False).encode())

    def key(self, task: Callable[..., object], arguments: Sequence[object]) -> str:
        """Tell what comes of a task from all else: by its arguments, and by who does it."""
        if self.folder is None:
            return ""
        source = sys.modules[task.__module__].__file__
        by = f"{software()} {_sources(Path(source).parent) if source else None} {task.__qualname__}"
        return hashlib.sha256(by.encode() + pickle.dumps(arguments)).hexdigest()

    def keep(self, key: str, result: object) -> None:
        """Keep what came of a task, whatever comes."""
        self._write(key, lambda: zlib.compress(pickle.dumps((result,)), 1))

    def recall(self, key: str) -> tuple[Any] | None:
        """Give what came of a task; None if it is not there."""
        if self.folder is None or not (self.folder / key).is_file():
            return None
        try:  # whatever a damaged one fails by, it is made anew
            packed = (self.folder / key).read_bytes()
            result = _Plain(io.BytesIO(zlib.decompress(packed))).load()
        except Exception:  # noqa: BLE001
            return None
        return result if isinstance(result, tuple) else None

    def _write(self, key: str, data: Callable[[], bytes]) -> None:
        if self.folder is None:
            return
        with failures_named(self.folder, "write"):
            self.folder.mkdir(exist_ok=True)
        atomic_write_bytes(self.folder / key, data())
        undo.keep_outputs()

    def drop(self) -> None:
        """Take the answers away once the document is written, and their folder if it is empty."""
        if self.folder is None:
            return
        with suppress(OSError):
            for answer in filter(_is_answer, self.folder.iterdir()):
                answer.unlink()
            self.folder.rmdir()


class _Plain(pickle.Unpickler):
    """Reads results, and runs nothing: a folder of answers may come from anywhere."""

    def find_class(self, module: str, name: str) -> Any:  # noqa: ANN401
        """See `pickle.Unpickler.find_class`."""
        if (module, name) in ARRAYS:
            return super().find_class(module, name)
        found = getattr(sys.modules.get(module), name, None)
        if isinstance(found, type) and (is_dataclass(found) or issubclass(found, Enum)):
            return found
        raise pickle.UnpicklingError(f"{module}.{name} is no plain result")


@cache
def _sources(folder: Path) -> str:
    """Tell the programs of a folder apart from those that they become."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _is_answer(path: Path) -> bool:
    """Tell an answer, or what a kill left of one, from a file of others."""
    return ANSWER.fullmatch(path.name) is not None and path.is_file()


def key_of(campaign: Path, asked: object, software: str) -> str:
    """Tell an answer from all others: by what is asked, of which bytes, and who answers."""
    digest = hashlib.sha256(f"{software} {asked!r}".encode())
    for name in (NOMINAL_FILE, TOUCHES_FILE):
        data = (campaign / name).read_bytes()
        digest.update(f" {len(data)} ".encode() + data)
    return digest.hexdigest()
