"""Writing into a store: each campaign in files of its own, and an index that makes them count.

The files are written first, under names that nothing refers to yet. Then the index is replaced, all
at once: what a killed writer leaves are files that nobody sees.
"""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path

from skiplatch import undo
from skiplatch.campaign import refuse_no_campaign
from skiplatch.files import failures_named
from skiplatch.fleet import layout
from skiplatch.fleet.contents import digest_of, look_at, pack
from skiplatch.fleet.engine import Connection, connect, failures_told
from skiplatch.fleet.intake import Intake, key_of, read_intake
from skiplatch.fleet.lock import written_alone
from skiplatch.fleet.named import Named, named
from skiplatch.fleet.origin import rig_of
from skiplatch.fleet.tables import CAMPAIGNS, write_touches
from skiplatch.fleet.wholeness import index_digest, load_index

KNOWN = "SELECT campaign, content, recorded_at, touches_sha256 FROM campaigns"
MERGE = """
DELETE FROM campaigns WHERE campaign IN (SELECT campaign FROM fresh);
INSERT INTO campaigns FROM fresh;
"""


@dataclass(slots=True)
class Writer:
    """A store that this process alone writes to.

    Attributes:
        path: The store.
        engine: With tables `campaigns`, the index, and `fresh`, rows that it does not have yet.
        known: Digest of the contents, time, and digest of the touches of each campaign, by its key.
        superseded: Files that no row refers to after the next `commit`.
    """

    path: Path
    engine: Connection
    known: dict[str, tuple[str, datetime, str | None]] = field(default_factory=dict)
    superseded: list[Path] = field(default_factory=list)
    _waits: bool = False

    def add(self, folder: Path, rig: str | None = None) -> Intake | None:
        """Take in a campaign, which counts from the next `commit` on.

        Args:
            folder: The campaign.
            rig: Where it comes from, unless its folder is to say that.

        Returns:
            What was taken in; None if nothing of it is new.

        Raises:
            InputError: The campaign cannot be read, or the store cannot be written.
        """
        refuse_no_campaign(folder)
        contents = look_at(folder)
        name = rig_of(folder, rig)
        with failures_named(folder, "read"):
            key = key_of(folder, name)
            digest, time, _ = self.known.get(key, (None, None, None))
            if digest == contents.digest:
                return None
            intake = read_intake(folder, name, contents)
        if time is not None:  # it stays in the month that it was filed under
            intake = replace(intake, time=time, is_known=True)
            self.superseded.append(self._place(layout.FOLDERS, intake, digest or ""))
        self._keep(intake)
        return intake

    def remove(self, name: str) -> Named:
        """Take out a campaign, which no longer counts from the next `commit` on.

        Args:
            name: The beginning of its key, or the name of its folder, if only one has that.

        Raises:
            InputError: None or several are called that.
        """
        found = named(self.path, self.engine, name)
        self.engine.execute("DELETE FROM campaigns WHERE campaign = ?", [found.key])
        del self.known[found.key]
        self.superseded += [found.folder, found.touches]
        self._waits = True
        return found

    def begin(self) -> None:
        """Read the index, or make an empty one, so that one that is missing later is seen."""
        load_index(self.path, self.engine)
        self.engine.execute("CREATE TABLE fresh AS FROM campaigns LIMIT 0")
        if not (self.path / layout.INDEX_FILE).exists():
            self._write_index()
        rows = self.engine.execute(KNOWN).fetchall()
        self.known = {key: (content, time, touches) for key, content, time, touches in rows}

    def commit(self) -> None:
        """Let what was added or taken out count, and stand whatever comes."""
        if not self._waits:
            return
        self._write_index()
        undo.keep_outputs()
        self.engine.execute("DELETE FROM fresh")
        for path in self.superseded:
            path.unlink(missing_ok=True)
        self.superseded.clear()
        self._waits = False

    def _write_index(self) -> None:
        self.engine.execute(MERGE)
        digest = index_digest(self.engine)
        self.engine.execute("UPDATE campaigns SET index_sha256 = ?", [digest])
        rows = self.engine.table("campaigns").order("rig, recorded_at, campaign")
        self._write(
            self.path / layout.INDEX_FILE,
            lambda target: rows.write_parquet(str(target), compression="zstd"),
        )

    def _keep(self, intake: Intake) -> None:
        folder = self._place(layout.FOLDERS, intake, intake.contents.digest)
        self._write(folder, lambda target: pack(intake.contents, target))
        intake.contents.refuse_changed()
        if intake.key in self.known:
            *_, digest = self.known[intake.key]
        else:
            touches = self._place(layout.TOUCHES, intake, intake.key)
            self._write(
                touches,
                lambda target: write_touches(
                    self.engine, intake.key, intake.recorded.touches, target
                ),
            )
            digest = digest_of(touches).hex()
        row = {**intake.row(), "touches_sha256": digest, "index_sha256": None}
        marks = ", ".join("?" for _ in CAMPAIGNS)
        self.engine.execute("DELETE FROM fresh WHERE campaign = ?", [intake.key])
        self.engine.execute(
            f"INSERT INTO fresh VALUES ({marks})",  # noqa: S608 - nothing but marks
            [row[name] for name in CAMPAIGNS],
        )
        self.known[intake.key] = intake.contents.digest, intake.time, digest
        self._waits = True

    def _place(self, table: str, intake: Intake, name: str) -> Path:
        return layout.place(self.path, table, intake.rig, intake.month, name)

    def _write(self, target: Path, write: Callable[[Path], None]) -> None:
        """Put a file in its place once it is on the disk, whole."""
        with failures_named(target, "write"), failures_told(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            temporary = undo.temporary_sibling(target)
            try:
                write(temporary)
                _sync(temporary)
                undo.replace(temporary, target)
            except BaseException:
                temporary.unlink(missing_ok=True)
                raise
            _sync(target.parent)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def refuse_unusable(path: Path) -> None:
    """Raise InputError for what is neither a store nor can become one; for early warning."""
    path = Path(os.path.realpath(path))
    if not _is_new(path):
        layout.refuse_foreign(path)


def _is_new(path: Path) -> bool:
    with failures_named(path, "read"):
        return not os.path.lexists(path) or (path.is_dir() and not any(path.iterdir()))


@contextmanager
def opened_for_writing(path: Path, *, may_be_new: bool = True) -> Iterator[Writer]:
    """Open a store, or make it, and hold it against other writers.

    Args:
        path: The store.
        may_be_new: Whether one that is not there is made; else it is refused.

    Raises:
        InputError: It is no store, or one of another version; something foreign is in it; another
            one writes to it; or it cannot be written.
    """
    path = Path(os.path.realpath(path))
    engine = connect(path)
    if may_be_new and _is_new(path):
        layout.create(path)
    layout.refuse_foreign(path)
    with written_alone(path), failures_told(path / layout.INDEX_FILE), engine:
        writer = Writer(path, engine)
        writer.begin()
        yield writer
