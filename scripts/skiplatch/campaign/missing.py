"""The warning that something was not recorded, in its one wording."""

import warnings
from pathlib import Path

from skiplatch.arrays import BoolArray
from skiplatch.errors import CampaignWarning


def warn_missing(path: Path, name: str, missing: BoolArray, what: str) -> None:
    """Warn that a column was not recorded, and of what comes of that."""
    if missing.any():
        how_often = "not recorded" if missing.all() else f"not recorded in {missing.sum()} touches"
        warnings.warn(CampaignWarning(path, None, name, f"{how_often}; {what}"), stacklevel=4)
