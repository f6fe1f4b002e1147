"""A campaign: a folder of two files."""

import os
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.campaign.columns import REQUIRED, REQUIRED_IN_VERSION_1
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.nominal import Nominal, in_version
from skiplatch.campaign.nominal_text import format_nominal
from skiplatch.campaign.nominal_toml import read_nominal
from skiplatch.campaign.reading import read_touches
from skiplatch.campaign.touches import Touches
from skiplatch.campaign.writing import format_touches, needs_version_2
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.files import atomic_write_folder, failures_named

NOMINAL_FILE = "nominal.toml"
TOUCHES_FILE = "touches.csv"
NOT_A_FOLDER = "not a folder; skiplatch import makes a campaign of a log, skiplatch repeat reads it"
MOST_NAMED = 8


@dataclass(frozen=True, eq=False)
class Campaign:
    """What a rig is believed to be and what was recorded of it.

    Attributes:
        nominal: What the engineer believes of the rig.
        touches: The recorded touches.
        path: The folder, as it was named.
        stood_in: Columns with values that nobody recorded, so that the touches can be played.
        fingerprint: Of the touches as they were recorded, where they may not be that any more.
    """

    nominal: Nominal
    touches: Touches
    path: Path
    stood_in: frozenset[str] = frozenset()
    fingerprint: str = ""


def read_campaign(path: str | os.PathLike[str]) -> Campaign:
    """Read a campaign folder.

    Raises:
        InputError: The folder or one of its two files cannot be read or is wrong.
    """
    folder = Path(path)
    refuse_no_campaign(folder)
    try:
        nominal = read_nominal(folder / NOMINAL_FILE)
    except InputError as error:
        error.further = (*error.further, *_faults_of_touches(folder))
        raise
    required = REQUIRED_IN_VERSION_1 if nominal.version == 1 else REQUIRED
    touches = read_touches(folder / TOUCHES_FILE, required, nominal)
    if nominal.kind is Kind.MACHINE and not np.isnan(touches.edge_us).all():
        message = "recorded on a machine, though only a bench knows the true edge time"
        warning = CampaignWarning(folder / TOUCHES_FILE, None, "edge_us", message)
        warnings.warn(warning, stacklevel=2)
    return Campaign(nominal, touches, folder)


def _faults_of_touches(folder: Path) -> list[InputError]:
    """Give what is wrong with touches.csv, if there is one, whatever nominal.toml says."""
    if not (folder / TOUCHES_FILE).exists():
        return []
    try:
        read_touches(folder / TOUCHES_FILE, REQUIRED)
    except InputError as error:
        return [error]
    return []


def refuse_no_campaign(folder: Path) -> None:
    """Raise InputError for what is no folder, or one of campaigns; for early warning."""
    if not folder.is_dir():
        reason = NOT_A_FOLDER if folder.exists() else "no such folder"
        raise InputError(folder, None, None, reason)
    if not (folder / NOMINAL_FILE).exists() and (inner := _campaigns_in(folder)):
        message = f"no campaign, but a folder of some: {', '.join(inner[:MOST_NAMED])}"
        raise InputError(folder, None, None, message)


def _campaigns_in(folder: Path) -> list[str]:
    with failures_named(folder, "read"):
        return sorted(entry.parent.name for entry in folder.glob(f"*/{NOMINAL_FILE}"))


def write_campaign(path: str | os.PathLike[str], nominal: Nominal, touches: Touches) -> None:
    """Write a campaign folder, all of it or nothing.

    Raises:
        InputError: Something other than an empty folder stands there already, or the folder
            cannot be written.
        ValueError: Some value is none that the format admits.
    """
    if needs_version_2(touches):
        nominal = in_version(nominal, 2)
    texts = {NOMINAL_FILE: format_nominal(nominal), TOUCHES_FILE: format_touches(touches)}
    atomic_write_folder(path, texts)
