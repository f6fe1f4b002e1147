"""ASAM MDF: recordings of measuring instruments and loggers, by asammdf where it is installed."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.errors import InputError
from skiplatch.files import foreign_reader
from skiplatch.importing.analyser import Capture, refuse_times
from skiplatch.importing.apart import read_apart
from skiplatch.importing.captures import MOST_BYTES


def read_mdf(path: Path) -> Capture:
    """Read a recording: each channel of numbers is high above the middle of its range.

    Raises:
        InputError: It cannot be read, or asammdf is not installed.
    """
    if find_spec("asammdf") is None:
        message = "MDF is read by asammdf, which is not installed: pip install asammdf"
        raise InputError(path, None, None, message)
    return read_apart(_read, path)


def _read(path: Path) -> Capture:
    from asammdf import MDF  # noqa: PLC0415 - an extra

    changes: dict[str, tuple[FloatArray, FloatArray]] = {}
    steps_s: list[float] = []
    with foreign_reader(path, MOST_BYTES, "MDF recording"), MDF(path) as recording:
        for signal in recording.iter_channels():
            samples = np.asarray(signal.samples)
            if samples.ndim == 1 and samples.dtype.kind in "biuf" and len(samples) > 1:
                times_s = np.asarray(signal.timestamps, dtype=float)
                refuse_times(path, times_s)
                changes.setdefault(signal.name, _changes(times_s, samples.astype(float)))
                steps_s.append(float(np.median(np.diff(times_s))))
    return Capture(changes, max(steps_s, default=0.0) or None)


def _changes(times_s: FloatArray, samples: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give when the channel crosses the middle of its range, its state at first before."""
    middle = (np.nanmin(samples) + np.nanmax(samples)) / 2.0
    levels = (samples > middle).astype(float)
    kept = np.diff(levels, prepend=np.nan) != 0.0
    return times_s[kept], levels[kept]
