"""Writing into a store: each campaign in files of its own, and an index that makes them count.

The files are written first, under names that nothing refers to yet. Then the index is replaced, all
at once: what a killed writer leaves are files that nobody sees.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from skiplatch import undo
from skiplatch.campaign import refuse_no_campaign
from skiplatch.errors import InputError
from skiplatch.files import failures_named
from skiplatch.fleet import layout
from skiplatch.fleet.contents import Contents, digest_of, look_at, pack, packed_file, refuse_damaged
from skiplatch.fleet.diagnosed import DIAGNOSIS_FILE, Diagnosed
from skiplatch.fleet.doubts import warn_of
from skiplatch.fleet.engine import Connection, connect, failures_told
from skiplatch.fleet.intake import Intake, key_of, read_intake
from skiplatch.fleet.kept import Kept, Shelf, read_kept
from skiplatch.fleet.lock import written_alone
from skiplatch.fleet.named import Named, named
from skiplatch.fleet.origin import rig_of
from skiplatch.fleet.tables import CAMPAIGNS, write_touches
from skiplatch.fleet.wholeness import index_digest, load_index, refuse_other

DIAGNOSED = "verdict, seed, gap_um, gap_arcsec, stage, gaps, effects"
FOUND = f"SELECT {DIAGNOSED} FROM (FROM fresh UNION ALL FROM campaigns) WHERE campaign = ? LIMIT 1"  # noqa: S608 - names of the product's own
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
        shelf: What it has, and what was added.
        superseded: Files that no row refers to after the next `commit`.
    """

    path: Path
    engine: Connection
    shelf: Shelf = field(default_factory=Shelf)
    superseded: set[Path] = field(default_factory=set)
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
            kept = self.shelf.by_key.get(key_of(folder, name))
            spared = self._lacks_diagnosis(kept, contents)
            if kept and spared:
                contents = look_at(folder, _diagnosis_file(kept.archive(self.path)))
            mends = kept is not None and self._is_damaged(kept)
            if kept and kept.content == contents.digest and not mends:
                return None
            intake = read_intake(folder, name, contents, spared)
        if kept is None:
            warn_of(intake, self.shelf)
            older = self._older_versions(intake)
            intake = replace(intake, older=tuple(one.key for one in older))
            self._keep(intake)
            self._take_out(older)
        else:  # it stays in the month that it was filed under
            intake = replace(intake, time=kept.time, is_known=True, mends=mends)
            self._keep(intake)
            if kept.content != contents.digest:
                self.superseded.add(kept.archive(self.path))
        return intake

    def _lacks_diagnosis(self, kept: Kept | None, contents: Contents) -> Diagnosed | None:
        """Give the diagnosis that is kept of a campaign whose folder has none."""
        if kept is None or not kept.is_diagnosed or DIAGNOSIS_FILE in contents.states:
            return None
        row = self.engine.execute(FOUND, [kept.key]).fetchone()
        return Diagnosed(*row)

    def _is_damaged(self, kept: Kept) -> bool:
        try:
            refuse_damaged(kept.archive(self.path), kept.content)
            refuse_other(kept.table(self.path), kept.touches_sha256)
        except InputError:
            return True
        return False

    def _older_versions(self, intake: Intake) -> list[Kept]:
        """Give what is kept of the same rig, folder and start: it was written on since.

        The time of a file is no start: many folders that are copied at once have the same.
        """
        return self.shelf.others(intake.kept(None)) if intake.says_time else []

    def _take_out(self, campaigns: Iterable[Kept]) -> None:
        """Let campaigns no longer count from the next `commit` on."""
        for kept in campaigns:
            for table in ("campaigns", "fresh"):
                self.engine.execute(f"DELETE FROM {table} WHERE campaign = ?", [kept.key])  # noqa: S608 - names of tables
            self.shelf.take(kept.key)
            self.superseded |= {kept.archive(self.path), kept.table(self.path)}

    def remove(self, name: str) -> Named:
        """Take out a campaign, which no longer counts from the next `commit` on.

        Args:
            name: The beginning of its key, or the name of its folder, if only one has that.

        Raises:
            InputError: None or several are called that.
        """
        found = named(self.path, self.engine, name)
        self._take_out([self.shelf.by_key[found.key]])
        self._waits = True
        return found

    def begin(self) -> None:
        """Read the index, or make an empty one, so that one that is missing later is seen."""
        load_index(self.path, self.engine)
        self.engine.execute("CREATE TABLE fresh AS FROM campaigns LIMIT 0")
        if not (self.path / layout.INDEX_FILE).exists():
            self._write_index()
        for kept in read_kept(self.engine):
            self.shelf.put(kept)

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
        digest = self._keep_touches(intake)
        row = {**intake.row(), "touches_sha256": digest, "index_sha256": None}
        marks = ", ".join("?" for _ in CAMPAIGNS)
        self.engine.execute("DELETE FROM fresh WHERE campaign = ?", [intake.key])
        self.engine.execute(
            f"INSERT INTO fresh VALUES ({marks})",  # noqa: S608 - nothing but marks
            [row[name] for name in CAMPAIGNS],
        )
        self.shelf.put(intake.kept(digest))
        self._waits = True

    def _keep_touches(self, intake: Intake) -> str | None:
        """Write the touches unless they are there, whole; gives their digest."""
        kept = self.shelf.by_key.get(intake.key)
        if kept and not intake.mends:
            return kept.touches_sha256
        touches = self._place(layout.TOUCHES, intake, intake.key)
        self._write(
            touches,
            lambda target: write_touches(self.engine, intake.key, intake.recorded.touches, target),
        )
        return digest_of(touches).hex()

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
                self.superseded.discard(target)
            except BaseException:
                temporary.unlink(missing_ok=True)
                raise
            _sync(target.parent)


def _diagnosis_file(archive: Path) -> dict[str, bytes]:
    data = packed_file(archive, DIAGNOSIS_FILE)
    return {} if data is None else {DIAGNOSIS_FILE: data}


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def refuse_unusable(path: Path) -> None:
    """Raise InputError for what is neither a store nor can become one; for early warning."""
    path = Path(os.path.realpath(path))
    if _is_new(path):
        layout.refuse_inside(path)
    else:
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
        layout.refuse_inside(path)
        layout.create(path)
    layout.refuse_foreign(path)
    with written_alone(path), failures_told(path / layout.INDEX_FILE), engine:
        layout.remove_leftovers(path)
        writer = Writer(path, engine)
        writer.begin()
        yield writer
