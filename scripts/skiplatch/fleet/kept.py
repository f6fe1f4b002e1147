"""The campaigns that a store has, as its writer asks for them."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from skiplatch.fleet import clock, layout
from skiplatch.fleet.engine import Connection

KEPT = """
SELECT campaign, rig, month, recorded_at, folder, content, touches_sha256, verdict IS NOT NULL
FROM campaigns ORDER BY rig, recorded_at, campaign
"""
Start = tuple[str, str, datetime]
"""Rig, name of the folder and time: two that have the same are versions of one campaign."""


@dataclass(frozen=True, slots=True)
class Kept:
    """A campaign of a store.

    Attributes:
        key: Of the campaign.
        rig: Where it comes from.
        month: That it is filed under.
        time: When it was recorded, UTC.
        folder: The name of its folder.
        content: Digest of all files of its folder.
        touches_sha256: Digest of the file of its touches; None of skiplatch 0.2.0.
        is_diagnosed: Whether it has a diagnosis.
    """

    key: str
    rig: str
    month: str
    time: datetime
    folder: str
    content: str
    touches_sha256: str | None
    is_diagnosed: bool

    @property
    def start(self) -> Start:
        """What all versions of it share."""
        return self.rig, self.folder, self.time

    def archive(self, store: Path) -> Path:
        """Give the path of the archive of its folder."""
        return layout.place(store, layout.FOLDERS, self.rig, self.month, self.content)

    def table(self, store: Path) -> Path:
        """Give the path of its touches."""
        return layout.place(store, layout.TOUCHES, self.rig, self.month, self.key)


@dataclass(slots=True)
class Shelf:
    """Campaigns by their keys and by their starts.

    Attributes:
        by_key: The campaigns.
        newest: The newest time of each rig that is not later than the clock of this machine.
        rigs: All rigs that have been there.
        rigs_by_case: One of them for each name without its case.
    """

    by_key: dict[str, Kept] = field(default_factory=dict)
    newest: dict[str, datetime] = field(default_factory=dict)
    rigs: set[str] = field(default_factory=set)
    rigs_by_case: dict[str, str] = field(default_factory=dict)
    _by_start: defaultdict[Start, set[str]] = field(default_factory=lambda: defaultdict(set))

    def put(self, kept: Kept) -> None:
        """Add a campaign, or replace the one of its key."""
        self.by_key[kept.key] = kept
        self._by_start[kept.start].add(kept.key)
        self.rigs.add(kept.rig)
        self.rigs_by_case.setdefault(kept.rig.casefold(), kept.rig)
        if kept.time <= clock.now() + clock.EASTERNMOST:
            self.newest[kept.rig] = max(kept.time, self.newest.get(kept.rig, kept.time))

    def take(self, key: str) -> Kept:
        """Take out the campaign of a key."""
        kept = self.by_key.pop(key)
        self._by_start[kept.start].discard(key)
        return kept

    def others(self, kept: Kept) -> list[Kept]:
        """Give the other versions of a campaign."""
        return [self.by_key[key] for key in sorted(self._by_start[kept.start] - {kept.key})]


def read_kept(engine: Connection) -> Iterable[Kept]:
    """Give the campaigns of an index."""
    return (Kept(*row) for row in engine.execute(KEPT).fetchall())
