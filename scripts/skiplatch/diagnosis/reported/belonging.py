"""Whether the document of a diagnosis is of the touches that it is used with."""

import warnings
from pathlib import Path
from typing import Any

from skiplatch.errors import CampaignWarning
from skiplatch.files import read_json

Json = Any


def is_of(document: Json, known_as: str) -> bool:
    """Tell whether it is of touches with this fingerprint; an older one does not say so."""
    return document.get("fingerprint", known_as) in (known_as, "")


def warn_if_of_others(path: Path, campaign: Path, known_as: str) -> None:
    """Warn of a diagnosis of other touches than those of a campaign.

    Args:
        path: Of the document, which can be read.
        campaign: Folder of the campaign.
        known_as: Fingerprint of its touches.
    """
    if not is_of(read_json(path), known_as):
        message = f"a diagnosis of other touches than those of {campaign}"
        warnings.warn(CampaignWarning(path, None, None, message), stacklevel=3)
