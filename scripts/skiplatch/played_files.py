"""Files of what is to be played; all that is wrong with them is told in one go.

What cannot be read hides nothing of what could be read and cannot be simulated.
"""

import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from skiplatch.campaign import (
    NOMINAL_FILE,
    TOUCHES_FILE,
    Campaign,
    Kind,
    Nominal,
    Touches,
    read_campaign,
    read_conditions,
    read_nominal,
)
from skiplatch.campaign.columns import REQUIRED
from skiplatch.campaign.missing import warn_missing
from skiplatch.campaign.nominal_toml import NominalError
from skiplatch.campaign.reading import read_touches
from skiplatch.errors import InputError
from skiplatch.stand_ins import (
    PLAYED_TOUCHES,
    playable,
    refuse_unplayable,
    refuse_unplayable_touches,
    stood_in,
)

Read = Callable[[Path], Touches]


def read_playable(path: str | os.PathLike[str]) -> Campaign:
    """Read a campaign and make it playable.

    Raises:
        InputError: It cannot be read, or something is missing for which nothing can stand in.
    """
    folder = Path(path)
    with all_faults_told(folder / NOMINAL_FILE, folder / TOUCHES_FILE, recorded):
        return playable(read_campaign(folder))


def read_played(path: Path, nominal: Nominal) -> Touches:
    """Read conditions that are to be played; those of an imported log may lack times and ways.

    What is missing has a stand-in, of which it warns.

    Raises:
        InputError: They cannot be read, lack a feed on a machine, or cannot be simulated.
    """
    conditions = conditions_of(nominal.kind)(path)
    refuse_unplayable_touches(path, conditions)
    for name in PLAYED_TOUCHES:
        warn_missing(path, name, np.isnan(getattr(conditions, name)), "a stand-in is played")
    if any(np.isnan(getattr(conditions, name)).any() for name in PLAYED_TOUCHES):
        conditions = stood_in(nominal, conditions)
    return conditions


def conditions_of(kind: Kind) -> Read:
    """Give how conditions are read for a rig of a kind: a machine's have a feed."""
    required = ("touch", "feed_mm_min") if kind is Kind.MACHINE else ("touch",)
    return lambda path: read_conditions(path, required)


@contextmanager
def all_faults_told(
    nominal_path: Path,
    touches_path: Path | None = None,
    read: Read | None = None,
    as_played: Callable[[Nominal], Nominal] = lambda nominal: nominal,
) -> Iterator[None]:
    """Where something is refused, tell what else is wrong with these files as well.

    Args:
        nominal_path: Of nominal.toml.
        touches_path: Of what is to be played on that rig, if that is read.
        read: How; None for conditions, as the kind of the rig has them.
        as_played: What becomes of the rig before it is played.
    """
    try:
        yield
    except InputError as error:
        if not nominal_path.is_file():
            raise
        told = {str(one) for one in error.apart}
        # A table that cannot be read is told as whoever asked wants it read.
        is_told = any(one.path == touches_path for one in error.apart)
        with warnings.catch_warnings(action="ignore"):  # they were given when it was read
            faults = _faults(nominal_path, None if is_told else touches_path, read, as_played)
        error.further = (*error.further, *(one for one in faults if str(one) not in told))
        raise


def _faults(
    nominal_path: Path,
    touches_path: Path | None,
    read: Read | None,
    as_played: Callable[[Nominal], Nominal],
) -> list[InputError]:
    nominal, found = _nominal(nominal_path)
    if nominal is not None:
        found += _of(refuse_unplayable, nominal_path, as_played(nominal))
    if touches_path is not None and touches_path.exists():
        found += _faults_of_touches(touches_path, read or conditions_of(_kind(nominal)))
    return found


def _kind(nominal: Nominal | None) -> Kind:
    return Kind.BENCH if nominal is None else nominal.kind


def _nominal(path: Path) -> tuple[Nominal | None, list[InputError]]:
    """Give the rig as far as it could be read, and what could not."""
    try:
        return read_nominal(path), []
    except InputError as error:
        so_far = error.so_far if isinstance(error, NominalError) else None
        return so_far, list(error.apart)


def _faults_of_touches(path: Path, read: Read) -> list[InputError]:
    try:
        touches = read(path)
    except InputError as error:
        return list(error.apart)
    return _of(refuse_unplayable_touches, path, touches)


def _of(refuse: Callable[..., None], *refused: object) -> list[InputError]:
    try:
        refuse(*refused)
    except InputError as error:
        return list(error.apart)
    return []


def recorded(path: Path) -> Touches:
    """Read touches as a campaign of format 2 has them."""
    return read_touches(path, REQUIRED)
