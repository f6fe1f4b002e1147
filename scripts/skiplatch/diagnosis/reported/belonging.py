"""Whether the document of a diagnosis is of the touches that it is used with."""

from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.files import Json, read_json


def is_of(document: Json, known_as: str) -> bool:
    """Tell whether it is of touches with this fingerprint; an older one does not say so."""
    return document.get("fingerprint", known_as) in (known_as, "")


def refuse_of_others(path: Path, campaign: Path, known_as: str) -> None:
    """Refuse a diagnosis of other touches than those of a campaign.

    Args:
        path: Of the document, which can be read.
        campaign: Folder of the campaign.
        known_as: Fingerprint of its touches.

    Raises:
        InputError: It is one.
    """
    if not is_of(read_json(path), known_as):
        message = (
            f"a diagnosis of other touches than those of {campaign}; of an earlier campaign of the "
            "same rig it is taken with --other-touches"
        )
        raise InputError(path, None, None, message)
