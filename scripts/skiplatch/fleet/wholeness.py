"""What tells a store that has lost bits: digests in its index, of the touches and of the index.

Parquet as DuckDB writes it has no checksums, and a flipped bit is another number.
"""

import hashlib
from collections.abc import Iterable
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.files import failures_named
from skiplatch.fleet import layout
from skiplatch.fleet.contents import digest_of
from skiplatch.fleet.engine import Connection, failures_told
from skiplatch.fleet.tables import CAMPAIGNS

DAMAGED = "damaged: its contents are not those that were written"

Place = tuple[str, str, str, str | None, str]
"""Rig, month and key of a campaign, the digest of its file of touches, and its folder's name."""


def load_index(path: Path, engine: Connection) -> None:
    """Make the table `campaigns` of the index of a store.

    A store of skiplatch 0.2.0 has no digests until something is added, and its touches have none.

    Raises:
        InputError: It is damaged.
    """
    index = path / layout.INDEX_FILE
    columns = ", ".join(f'"{name}" {kind}' for name, kind in CAMPAIGNS.items())
    engine.execute(f"CREATE TABLE campaigns ({columns})")
    if not index.exists():  # an add was killed before anything was in
        return
    with failures_told(index):
        # By name: a store of an older version has fewer columns.
        engine.execute("INSERT INTO campaigns BY NAME FROM read_parquet(?)", [str(index)])
    kept = engine.execute("SELECT index_sha256, touches_sha256 FROM campaigns").fetchall()
    if any(any(digests) for digests in kept):
        expected = index_digest(engine)
        if any(digest != expected for digest, _ in kept):
            raise InputError(index, None, None, f"{DAMAGED}, or by a skiplatch that is older")


def index_digest(engine: Connection) -> str:
    """Give SHA-256 of all that the table `campaigns` says, but for this digest."""
    asked = engine.execute("SELECT * EXCLUDE (index_sha256) FROM campaigns ORDER BY campaign")
    names = [column[0] for column in asked.description]
    digest = hashlib.sha256()
    for row in asked.fetchall():
        said = {name: value for name, value in zip(names, row, strict=True) if value is not None}
        digest.update(repr(sorted(said.items())).encode())
    return digest.hexdigest()


def whole_touches(path: Path, places: Iterable[Place]) -> list[str]:
    """Give the files of touches of campaigns.

    Raises:
        InputError: One is damaged or gone.
    """
    files = []
    for rig, month, campaign, digest, folder in places:
        file = layout.place(path, layout.TOUCHES, rig, month, campaign)
        try:
            refuse_other(file, digest)
        except InputError as error:
            of = f"touches of {quoted(folder)} ({campaign[:12]}) of rig {quoted(rig)}"
            raise InputError(file, None, None, f"{error.message}; {of}") from error
        files.append(str(file))
    return files


def refuse_other(file: Path, digest: str | None) -> None:
    """Raise InputError unless a file of touches is there, with this digest if that is known."""
    with failures_named(file, "read"):
        found = digest_of(file).hex()
        if found != (digest or found):
            raise InputError(file, None, None, DAMAGED)
