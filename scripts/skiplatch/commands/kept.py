"""Answers kept beside the document that they are for: a command goes on where it was cut."""

import hashlib
import json
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from skiplatch import undo
from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE
from skiplatch.commands.outputs import STDOUT
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text, failures_named, read_json

ENDING = ".part"
ANSWER = re.compile(r"[0-9a-f]{64}|\.skiplatch-[0-9a-f]{16}\.tmp")


@dataclass(frozen=True, slots=True)
class Kept:
    """A folder of answers, a file each; none where no document is asked for.

    Attributes:
        folder: OUT.part, beside the document OUT.
    """

    folder: Path | None

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
        if self.folder is None:
            return
        with failures_named(self.folder, "write"):
            self.folder.mkdir(exist_ok=True)
        atomic_write_text(self.folder / key, json.dumps(answer, allow_nan=False))
        undo.keep_outputs()

    def drop(self) -> None:
        """Take the answers away once the document is written, and their folder if it is empty."""
        if self.folder is None:
            return
        with suppress(OSError):
            for answer in filter(_is_answer, self.folder.iterdir()):
                answer.unlink()
            self.folder.rmdir()


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
