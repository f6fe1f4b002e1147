"""Reading all that a store has: which campaigns lost something of what was kept."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.fleet.contents import refuse_damaged
from skiplatch.fleet.engine import Connection, failures_told
from skiplatch.fleet.kept import Kept
from skiplatch.fleet.wholeness import refuse_other

READ = "SELECT bit_xor(hash(touches)) FROM read_parquet(?, hive_partitioning = false) AS touches"


@dataclass(frozen=True, slots=True)
class Damage:
    """A file of a campaign that is missing or damaged.

    Attributes:
        campaign: Its key.
        rig: Where it comes from.
        folder: The name of its folder.
        path: The file.
        why: What is wrong with it.
    """

    campaign: str
    rig: str
    folder: str
    path: Path
    why: str


def damages(store: Path, engine: Connection, campaigns: Iterable[Kept]) -> Iterable[Damage]:
    """Read the files of campaigns, and give what is missing or damaged."""
    for kept in campaigns:
        archive, table = kept.archive(store), kept.table(store)
        checks: dict[Path, Callable[[], None]] = {
            archive: partial(refuse_damaged, archive, kept.content),
            table: partial(_refuse_table, engine, table, kept.touches_sha256),
        }
        for path, check in checks.items():
            try:
                check()
            except InputError as error:
                yield Damage(kept.key, kept.rig, kept.folder, path, error.message)


def _refuse_table(engine: Connection, path: Path, digest: str | None) -> None:
    """Raise InputError for touches that are not whole; without a digest it is seen by reading."""
    refuse_other(path, digest)
    with failures_told(path):
        engine.execute(READ, [str(path)]).fetchall()
