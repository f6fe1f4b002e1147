"""What is odd of a campaign beside those that a store has: kept all the same, but warned of."""

import warnings
from datetime import timedelta

from skiplatch.errors import CampaignWarning, quoted
from skiplatch.fleet.intake import Intake
from skiplatch.fleet.kept import Shelf

LONG_BEFORE_YEARS = 2
LONG_BEFORE = timedelta(days=365.25 * LONG_BEFORE_YEARS)
"""Before the newest of a rig: a clock without power falls back to a date of its maker, which is
years ago, while archives of years rarely come after what is newer."""


def warn_of(intake: Intake, shelf: Shelf) -> None:
    """Warn of a campaign that is new, if its time or the name of its rig is odd."""
    newest = shelf.newest.get(intake.rig)
    if newest and intake.time < newest - LONG_BEFORE:
        times = f"{intake.time.isoformat()} is over {LONG_BEFORE_YEARS} years before the newest"
        _warn(
            intake, f"{times} campaign of its rig, {newest.isoformat()}; did its clock fall back?"
        )
    if intake.rig not in shelf.rigs and (like := shelf.rigs_by_case.get(intake.rig.casefold())):
        _warn(intake, f"rig {quoted(intake.rig)} differs from {quoted(like)} in case only")


def _warn(intake: Intake, words: str) -> None:
    warnings.warn(CampaignWarning(intake.contents.folder, None, None, words), stacklevel=3)
