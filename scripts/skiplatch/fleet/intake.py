"""One campaign's way into a store: what is known of it, and the files that keep it."""

import hashlib
from dataclasses import asdict, dataclass
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from skiplatch.campaign import NOMINAL_FILE, TOUCHES_FILE, Campaign, read_campaign
from skiplatch.fleet.contents import Contents, digest_of, look_at
from skiplatch.fleet.diagnosed import Diagnosed, diagnosed
from skiplatch.fleet.origin import recorded_at, rig_of
from skiplatch.ways import Ways


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
        is_known: Whether it was kept before, with other files.
    """

    key: str
    rig: str
    time: datetime
    recorded: Campaign
    contents: Contents
    found: Diagnosed
    is_known: bool = False

    @property
    def folder(self) -> str:
        """The name of its folder."""
        return self.recorded.path.resolve().name

    @property
    def month(self) -> str:
        """As in 2026-03."""
        return self.time.strftime("%Y-%m")

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
        digest.update(digest_of(folder / name))
    return digest.hexdigest()


def refuse_unfit(folder: Path, rig: str | None) -> None:
    """Raise InputError for what no store keeps, whatever its diagnosis says; for early warning."""
    look_at(folder)
    rig_of(folder, rig)
    recorded_at(folder)


def read_intake(folder: Path, rig: str, contents: Contents) -> Intake:
    """Read a campaign and its diagnosis.

    Raises:
        InputError: They cannot be read, or have changed since the folder was looked at.
    """
    recorded = read_campaign(folder)
    intake = Intake(
        key=key_of(folder, rig),
        rig=rig,
        time=recorded_at(folder),
        recorded=recorded,
        contents=contents,
        found=diagnosed(folder, recorded.touches),
    )
    contents.refuse_changed()
    return intake
