"""One campaign's way into a store: what is known of it, and the files that keep it."""

import hashlib
from dataclasses import asdict, dataclass
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE, Campaign, read_campaign
from skiplatch.files import failures_named
from skiplatch.fleet.contents import Contents, digest_of, look_at
from skiplatch.fleet.diagnosed import Diagnosed, diagnosed
from skiplatch.fleet.kept import Kept
from skiplatch.fleet.origin import recorded_at, rig_of, told_time
from skiplatch.ways import Ways

PLAINLY = "kept"
"""What is said of a campaign that is new."""


@dataclass(frozen=True, slots=True)
class Intake:
    """A campaign that was read.

    Attributes:
        key: What the same campaign always has: SHA-256 of its rig, nominal.toml and touches.csv.
        rig: Where it comes from.
        time: When it was recorded, UTC.
        recorded: The campaign.
        contents: All files of its folder.
        found: Its diagnosis.
        says_time: Whether the campaign itself says when it was recorded, and not its file alone.
        is_known: Whether it was kept before, with other files.
        older: Keys of its older versions, which it replaces.
        spares_diagnosis: Whether its diagnosis is the one that was kept before.
        mends: Whether files of it in the store were missing or damaged.
    """

    key: str
    rig: str
    time: datetime
    recorded: Campaign
    contents: Contents
    found: Diagnosed
    says_time: bool = True
    is_known: bool = False
    older: tuple[str, ...] = ()
    spares_diagnosis: bool = False
    mends: bool = False

    @property
    def folder(self) -> str:
        """The name of its folder."""
        return self.recorded.path.resolve().name

    @property
    def month(self) -> str:
        """As in 2026-03."""
        return f"{self.time.year:04}-{self.time.month:02}"

    @property
    def told(self) -> str:
        """Say that it is kept, and what became of what was kept before."""
        notes = {
            "replaces an older version": self.older,
            "mends what was missing or damaged in the store": self.mends,
            "has no diagnosis, so the kept one stays": self.spares_diagnosis,
        }
        return ", ".join([PLAINLY, *(words for words, holds in notes.items() if holds)])

    def kept(self, touches_sha256: str | None) -> Kept:
        """Give it as a store has it, with the digest of the file of its touches."""
        return Kept(
            *(self.key, self.rig, self.month, self.time, self.folder, self.contents.digest),
            touches_sha256=touches_sha256,
            is_diagnosed=self.found.verdict is not None,
        )

    def row(self) -> dict[str, Any]:
        """Give its row of the index."""
        touches, folder = self.recorded.touches, self.recorded.path
        return {
            "campaign": self.key,
            "rig": self.rig,
            "month": self.month,
            "recorded_at": self.time,
            "folder": self.folder,
            "kind": str(self.recorded.nominal.kind),
            "touches": len(touches),
            "sessions": [name for name in touches.session_names if name],
            "nominal": digest_of(folder / NOMINAL_FILE).hex(),
            "tool": version("skiplatch"),
            "content": self.contents.digest,
            "axes": Ways.of(touches).value,
            **asdict(self.found),
        }


def key_of(folder: Path, rig: str) -> str:
    """Tell a campaign from all others; the diagnosis in its folder may change."""
    digest = hashlib.sha256(f"{len(rig.encode())} {rig} ".encode())
    for name in (NOMINAL_FILE, TOUCHES_FILE):
        with failures_named(folder / name, "read"):
            digest.update(digest_of(folder / name))
    return digest.hexdigest()


def refuse_unfit(folder: Path, rig: str | None) -> None:
    """Raise InputError for what no store keeps, whatever its diagnosis says; for early warning."""
    look_at(folder)
    rig_of(folder, rig)
    recorded_at(folder)


def read_intake(
    folder: Path, rig: str, contents: Contents, spared: Diagnosed | None = None
) -> Intake:
    """Read a campaign and its diagnosis.

    Args:
        folder: The campaign.
        rig: Where it comes from.
        contents: All files of its folder.
        spared: A diagnosis of these touches, in place of one that the folder lacks.

    Raises:
        InputError: They cannot be read, or have changed since the folder was looked at.
    """
    recorded, told = read_campaign(folder), told_time(folder)
    intake = Intake(
        key=key_of(folder, rig),
        rig=rig,
        time=told or recorded_at(folder),
        recorded=recorded,
        contents=contents,
        found=spared or diagnosed(folder, recorded.touches),
        says_time=told is not None,
        spares_diagnosis=spared is not None,
    )
    contents.refuse_changed()
    return intake
