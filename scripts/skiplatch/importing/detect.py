"""Which kind of log a file is, by what stands in it."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from skiplatch.errors import InputError
from skiplatch.files import failures_named
from skiplatch.importing.dialects import advice
from skiplatch.importing.grbl import read_grbl
from skiplatch.importing.kinds import HOLDS, TABLE, is_scope, kind_of
from skiplatch.importing.klipper import read_klipper
from skiplatch.importing.linuxcnc import read_linuxcnc
from skiplatch.importing.log_lines import read_text
from skiplatch.importing.marlin import read_marlin
from skiplatch.importing.model import Imported

LINUXCNC = "linuxcnc"
KINDS: Mapping[str, Callable[[Path], Imported]] = {
    "grbl": lambda path: read_grbl(path, None),
    "klipper": lambda path: read_klipper(path, None),
    "marlin": lambda path: read_marlin(path, None),
    LINUXCNC: lambda path: read_linuxcnc(path, None, None, None, inch=None),
}
WITHOUT_TOUCHES: Mapping[str, re.Pattern[str]] = {
    "klipper": re.compile(
        r"probe accuracy results|\bPROBE_ACCURACY\b|=== Config file ===|\bKlipper state:",
        re.IGNORECASE,
    ),
    "marlin": re.compile(r"M48 Z-Probe Repeatability Test", re.IGNORECASE),
    "grbl": re.compile(r"\bGrbl \d|^ALARM:|^.*\bG38\.[2-5](?!\d)", re.IGNORECASE | re.MULTILINE),
}
"""What is clearly of a kind, though no touch shows; its reader says what is missing."""

HOLDOFF_S = 1e-3


def read_any(path: Path, *, inch: bool | None = None) -> tuple[str, Imported]:
    """Read a log of whatever kind and give the name of that.

    Args:
        path: The log.
        inch: Whether one of LinuxCNC begins in inches, where that is told.

    Raises:
        InputError: It cannot be read, is of no kind that can be told, or of one that has no other
            unit.
    """
    if inch is not None:
        _refuse_unit_of_others(path)
        return LINUXCNC, read_linuxcnc(path, None, None, None, inch=inch)
    if path.suffix.lower() in (".vcd", ".sr"):
        return "a logic analyser", _capture(path)
    if path.suffix.lower() in (".asc", ".blf"):
        return "CAN traffic", _can(path)
    with failures_named(path, "read"):
        kind = kind_of(path)
    if kind == "can":
        return "CAN traffic", _can(path)
    text = read_text(path)
    if kind == "edges":
        return "an oscilloscope" if is_scope(text) else "a logic analyser", _capture(path)
    if kind in KINDS:
        return kind, KINDS[kind](path)
    if said := advice(text):
        raise InputError(path, None, None, said)
    for name, sign in WITHOUT_TOUCHES.items():
        if sign.search(text):
            return name, KINDS[name](path)
    kinds = ", ".join(KINDS)
    readers = {"": "see skiplatch import", TABLE: "skiplatch import csv or iso230 reads it"}
    others = readers.get(kind, f"skiplatch import {kind} reads it")
    message = f"expected a campaign or a log of {kinds}; for others {others}"
    raise InputError(path, None, None, message)


def _refuse_unit_of_others(path: Path) -> None:
    """Refuse a unit for a file that is clearly none of LinuxCNC."""
    with failures_named(path, "read"):
        kind = kind_of(path)
    if kind not in ("", LINUXCNC, TABLE):
        message = f"{HOLDS[kind]}, which tell their unit themselves: leave out --units"
        if kind == "grbl":
            message = "touches of grbl: skiplatch import grbl has --inch for them, not --units"
        raise InputError(path, None, None, message)


def _capture(path: Path) -> Imported:
    # The libraries for such files take time to load, which the other logs do not need.
    from skiplatch.importing.captures import read_capture  # noqa: PLC0415
    from skiplatch.importing.edge_channels import Channels  # noqa: PLC0415
    from skiplatch.importing.edges import read_edges  # noqa: PLC0415

    capture = read_capture(path)
    return read_edges(path, capture, Channels(), falling=False, holdoff_s=HOLDOFF_S)


def _can(path: Path) -> Imported:
    from skiplatch.importing.can_frames import read_can  # noqa: PLC0415

    return read_can(path)
