"""What a logic analyser saw, and how its files say their sample rate."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign.constraints import INSTANT_S
from skiplatch.errors import InputError
from skiplatch.numbers import PLAIN

RATE = rf"(?<![\w.])({PLAIN})\s*([kMG]?)Hz"
"""Two groups, for `hertz`; in any case of letters."""
MOST_HZ = 1e12
_TIMES = {"": 1.0, "k": 1e3, "m": 1e6, "g": 1e9}


@dataclass(frozen=True, slots=True, eq=False)
class Capture:
    """What a logic analyser saw.

    Attributes:
        changes: For each channel by name: times in s of its changes, and the levels after them.
        step_s: Distance of two samples; None where the file does not say it.
        assumed: What was assumed of the times.
        noise: Channels of voltages that do not swing between two levels.
    """

    changes: Mapping[str, tuple[FloatArray, FloatArray]]
    step_s: float | None
    assumed: tuple[str, ...] = ()
    noise: tuple[str, ...] = ()

    def edges(self, name: str, *, falling: bool) -> FloatArray:
        """Give the times in s of a channel's edges, without its state at first."""
        times, levels = self.changes[name]
        found: FloatArray = times[1:][levels[1:] == (0.0 if falling else 1.0)]
        return found


def only_changes(times: FloatArray, levels: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give the state at first and each change of a channel, both shape (n,)."""
    kept = np.concatenate([[True], np.diff(levels) != 0])
    return times[kept], levels[kept]


def refuse_times(path: Path, times_s: FloatArray, lines: Sequence[int] | None = None) -> None:
    """Refuse the first time, shape (n,), that goes back or that no clock reads.

    Args:
        path: The capture.
        times_s: In the order of the file.
        lines: Of each time; None where the file has none.

    Raises:
        InputError: There is one.
    """
    longest = INSTANT_S.high
    beyond = ~(np.abs(times_s) <= longest)
    wrong = np.flatnonzero(beyond | (np.diff(times_s, prepend=-np.inf) < 0.0))
    if not len(wrong):
        return
    first = int(wrong[0])
    found = f"{times_s[first]:.9g} s"
    message = (
        f"expected a time of at most {longest:g} s, got {found}"
        if beyond[first]
        else f"time goes back from {times_s[first - 1]:.9g} s to {found}"
    )
    raise InputError(path, lines[first] if lines else None, None, message)


def hertz(path: Path, match: re.Match[str]) -> float:
    """Give the sample rate that `RATE` has found.

    Raises:
        InputError: No analyser has that rate.
    """
    try:
        found = float(match[1]) * _TIMES[match[2].lower()]
    except ValueError:
        found = 0.0
    if not 0.0 < found <= MOST_HZ:
        most = f"{MOST_HZ / 1e9:g} GHz"
        message = f"expected a sample rate above 0 and up to {most}, got {match[0]}"
        raise InputError(path, None, None, message)
    return found
