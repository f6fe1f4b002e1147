"""The speed table as files: TABLE.csv, a header for the target, the variables of a controller."""

from dataclasses import dataclass
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import FloatArray
from skiplatch.compensation.columns_csv import ALPHA, BETA, FEED, read_columns
from skiplatch.compensation.firmware import PretravelError
from skiplatch.compensation.probe_map import ProbeMap
from skiplatch.compensation.radius_map import Lookup
from skiplatch.errors import InputError

COLUMNS = {"alpha_deg": ALPHA, "beta_deg": BETA, "feed_mm_min": FEED}

NC_RANGES = ((500, 999), (10_000, 10_999))
"""Common variables that keep their values when the control is switched off (Fanuc, Haas)."""

NM_PER_MM = 1e6
PER_LINE = 12
VECTOR_LENGTH = 16_000.0


def rounded(feed_mm_min: FloatArray) -> FloatArray:
    """Give the feeds, shape (n,), as they will stand in the table."""
    return np.round(feed_mm_min, FEED.decimals)


def table_csv(probe_map: ProbeMap, feed_mm_min: FloatArray) -> str:
    """Give the text of TABLE.csv: every direction as it was written in the file of radii.

    Args:
        probe_map: The n directions.
        feed_mm_min: Shape (n,).
    """
    shown = probe_map.listed
    readings = probe_map.readings
    cells = (
        ALPHA.format(readings.alpha_deg[shown]),
        BETA.format(readings.beta_deg[shown]),
        FEED.format(feed_mm_min[probe_map.cell_of[shown]]),
    )
    lines = [",".join(COLUMNS), *(",".join(row) for row in zip(*cells, strict=True))]
    return "\n".join(lines) + "\n"


def read_table(path: Path, probe_map: ProbeMap) -> FloatArray:
    """Read the feeds of an earlier TABLE.csv for the n directions of a map; shape (n,).

    Raises:
        InputError: The file is wrong, or its directions are not those of the map.
    """
    rows = read_columns(path, COLUMNS)
    table: dict[tuple[float, float], int] = {}
    keys = zip(rows.values["alpha_deg"].tolist(), rows.values["beta_deg"].tolist(), strict=True)
    for row, key in enumerate(keys):
        if key in table:
            line = int(rows.lines[table[key]])
            raise rows.fault(row, "alpha_deg", f"this direction stands already in line {line}")
        table[key] = row
    feed_mm_min = np.empty(len(probe_map))
    for reading in probe_map.listed:
        key = _key(probe_map, int(reading))
        if key not in table:
            message = f"no feed for {probe_map.readings.named(int(reading))}, which the map has"
            raise InputError(path, None, None, message)
        feed_mm_min[probe_map.cell_of[reading]] = rows.values["feed_mm_min"][table[key]]
    return feed_mm_min


def _key(probe_map: ProbeMap, reading: int) -> tuple[float, float]:
    """Name a direction as it comes back from a table that was written."""
    readings = probe_map.readings
    alpha_deg, beta_deg = float(readings.alpha_deg[reading]), float(readings.beta_deg[reading])
    return round(alpha_deg, ALPHA.decimals), round(beta_deg, BETA.decimals)


@dataclass(frozen=True, slots=True, eq=False)
class Header:
    """A lookup table for the target.

    Attributes:
        divisions: How fine its grid is; see ``firmware/comp/pretravel_lookup.h``.
        unit_nm_min: What a looked-up speed is counted in.
        vertices: Speeds in 128 of that unit.
        error_mm_min: By how much a looked-up feed leaves that of the table, at the worst of its
            directions: vertices are bytes, and lie between directions.
        rms_error_mm_min: The same, root mean square.
    """

    divisions: int
    unit_nm_min: int
    vertices: NDArray[np.uint8]
    error_mm_min: float
    rms_error_mm_min: float


def header_of(probe_map: ProbeMap, feed_mm_min: FloatArray, divisions: int) -> Header:
    """Lay the feeds, shape (n,), out for the firmware's lookup, in the finest unit that holds them.

    Raises:
        ValueError: They do not fit into its numbers, or there is no such division.
    """
    finest_mm_min = Lookup.finest_unit_mm_min(feed_mm_min)
    unit_nm_min = ceil(finest_mm_min * NM_PER_MM)
    try:
        found = probe_map.cells.lookup(
            feed_mm_min, divisions=divisions, unit_mm_min=unit_nm_min / NM_PER_MM
        )
    except PretravelError as error:
        raise ValueError(str(error)) from error
    looked_up = found.speed_mm_min(_vectors(probe_map))
    off_mm_min = looked_up - feed_mm_min
    worst, rms = float(np.abs(off_mm_min).max()), float(np.sqrt(np.mean(off_mm_min**2)))
    return Header(divisions, unit_nm_min, found.vertices, worst, rms)


def _vectors(probe_map: ProbeMap) -> NDArray[np.int16]:
    """Give the directions as a controller does, shape (n, 3)."""
    alpha, beta = np.radians(probe_map.cells.alpha_deg), np.radians(probe_map.cells.beta_deg)
    unit = [np.cos(beta) * np.cos(alpha), np.cos(beta) * np.sin(alpha), np.sin(beta)]
    return np.round(VECTOR_LENGTH * np.column_stack(unit)).astype(np.int16)


def c_header(header: Header, *, name: str, note: str) -> str:
    """Give the text of a header that a target includes.

    Args:
        header: The table.
        name: Of its variables, a C identifier in lower case.
        note: A line of comment.
    """
    upper = name.upper()
    cells = [str(vertex) for vertex in header.vertices.tolist()]
    body = [
        "    " + ", ".join(cells[start : start + PER_LINE]) + ","
        for start in range(0, len(cells), PER_LINE)
    ]
    note = note.replace("*/", "* /")
    return "\n".join(
        [
            "/*",
            " * Probing feeds over directions, for pretravel_lookup(). Generated by",
            " * skiplatch compensate; do not edit.",
            f" * {note}",
            " */",
            f"#ifndef {upper}_H",
            f"#define {upper}_H",
            "",
            "#include <stdint.h>",
            "",
            '#include "comp/pretravel_lookup.h"',
            "",
            "/* What pretravel_lookup() counts in, in nm/min. */",
            f"#define {upper}_UNIT_NM_MIN {header.unit_nm_min}u",
            "",
            f"static const uint8_t {name}_vertices[{len(cells)}] = {{",
            *body,
            "};",
            "",
            f"static const pretravel_lookup_t {name} = {{",
            f"    {name}_vertices + {len(cells) // 2}, {header.divisions}u}};",
            "",
            "#endif",
            "",
        ]
    )


def nc_program(
    probe_map: ProbeMap, feed_mm_min: FloatArray, *, first_variable: int, note: str
) -> str:
    """Give a program that sets a common variable to the feed of each direction.

    Args:
        probe_map: The n directions.
        feed_mm_min: Shape (n,).
        first_variable: Where the table begins.
        note: A line of comment; what controls do not know is left out.

    Raises:
        ValueError: The table does not fit in where it begins.
    """
    last = first_variable + len(probe_map) - 1
    if not any(low <= first_variable and last <= high for low, high in NC_RANGES):
        spans = " or ".join(f"#{low} to #{high}" for low, high in NC_RANGES)
        message = (
            f"{len(probe_map)} directions from #{first_variable} on do not fit in {spans}, "
            "the variables that a control keeps"
        )
        raise ValueError(message)
    words = "".join(c for c in note.upper() if c.isascii() and (c.isalnum() or c in " .,-+=/"))
    lines = ["%", "O9800 (SKIPLATCH PROBING FEEDS)", f"({words})", "(FEEDS IN MM/MIN)"]
    for i, feed in enumerate(feed_mm_min):
        alpha_deg, beta_deg = probe_map.cells.alpha_deg[i], probe_map.cells.beta_deg[i]
        place = f"(ALPHA {alpha_deg:.3f} BETA {beta_deg:.3f})"
        lines.append(f"#{first_variable + i}={feed:.{FEED.decimals}f} {place}")
    return "\n".join([*lines, "M99", "%"]) + "\n"
