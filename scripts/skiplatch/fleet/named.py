"""Which campaign of a store a user means."""

from dataclasses import dataclass
from pathlib import Path

from skiplatch.errors import InputError, quoted
from skiplatch.fleet import layout
from skiplatch.fleet.engine import Connection
from skiplatch.tables import counted

FOUND = """
SELECT campaign, rig, month, content, folder = $name AS is_folder FROM campaigns
WHERE starts_with(campaign, $name) OR folder = $name
"""


@dataclass(frozen=True, slots=True)
class Named:
    """A campaign that a store keeps.

    Attributes:
        key: Of the campaign.
        content: Digest of all files of its folder.
        folder: The archive of its folder.
        touches: The file of its touches.
    """

    key: str
    content: str
    folder: Path
    touches: Path


def named(store: Path, engine: Connection, name: str) -> Named:
    """Find a campaign.

    Args:
        store: Where it is kept.
        engine: With the index of the store.
        name: The beginning of its key, or the name of its folder, if only one has that.

    Raises:
        InputError: None or several are called that.
    """
    found = engine.execute(FOUND, {"name": name}).fetchall() if name else []
    if len(found) != 1:
        raise InputError(store, None, None, _not_one(name, [row[-1] for row in found]))
    key, rig, month, content, _ = found[0]
    folder = layout.place(store, layout.FOLDERS, rig, month, content)
    return Named(key, content, folder, layout.place(store, layout.TOUCHES, rig, month, key))


def _not_one(name: str, are_folders: list[bool]) -> str:
    """Say how many campaigns are meant, by their folders and by their keys."""
    called, begin = sum(are_folders), len(are_folders) - sum(are_folders)
    keys = f"{counted(begin, 'key')} {'begins' if begin == 1 else 'begin'} so"
    if not called:
        return f"{keys}: {quoted(name)}" if begin else f"no campaign is called {quoted(name)}"
    words = f"{counted(called, 'campaign')} {'is' if called == 1 else 'are'} called {quoted(name)}"
    return f"{words}, and {keys}" if begin else words
