"""The columns of touches.csv: the one table that reading, writing, checking and documents use."""

import re
from collections.abc import Mapping
from dataclasses import replace
from enum import IntEnum

from skiplatch.campaign.column_kinds import (
    ChoiceColumn,
    Column,
    LabelColumn,
    NumberColumn,
    SerialColumn,
)
from skiplatch.campaign.constraints import (
    ANGLE,
    ELEVATION,
    FEED,
    INSTANT_S,
    INSTANT_US,
    LENGTH_UM,
    PLACE_MM,
    SENSE,
    TEMPERATURE,
    WAY_MM,
)


class InputPath(IntEnum):
    """Which input path latched."""

    SKIP = 0
    PLC = 1


class Axis(IntEnum):
    """The axis that mostly moves; A, B and C turn."""

    X = 0
    Y = 1
    Z = 2
    A = 3
    B = 4
    C = 5


LINEAR_AXES = (Axis.X, Axis.Y, Axis.Z)
PLACE_DECIMALS = 6
"""Of `position_mm`: deviations are counted from a place as it is written."""


class Status(IntEnum):
    """What came of a touch."""

    OK = 0
    MISSED = 1
    FALSE = 2


# In the order in which they are written.
COLUMNS: Mapping[str, Column] = {
    "touch": SerialColumn(
        meaning="serial number, unique in the campaign, any order",
        example="17",
        lost="it has to be there",
    ),
    "time_s": NumberColumn(
        unit="s",
        constraint=INSTANT_S,
        decimals=6,
        meaning="start of the measuring move, master clock, since the campaign began",
        example="14.212755",
        lost="drifts, and whether the move began when it was meant to",
    ),
    "path": ChoiceColumn(
        codes={"skip": InputPath.SKIP, "plc": InputPath.PLC},
        meaning="which input path latched; skip where nothing tells",
        example="skip",
        lost="the two paths apart",
    ),
    "axis": ChoiceColumn(
        codes={axis.name: axis for axis in Axis},
        meaning="the axis that mostly moves",
        example="X",
        lost="what differs from axis to axis",
    ),
    "sign": NumberColumn(
        constraint=SENSE,
        decimals=0,
        meaning="the sense in which that axis moves",
        example="-1",
        lost="what turns with the sense of motion, as backlash does",
    ),
    "alpha_deg": NumberColumn(
        unit="deg",
        constraint=ANGLE,
        decimals=3,
        meaning="probing direction in the plane normal to the probe axis",
        example="42.58",
        lost="the probe's lobes",
    ),
    "beta_deg": NumberColumn(
        unit="deg",
        constraint=ELEVATION,
        decimals=3,
        meaning="angle of the probing direction to that plane",
        example="30",
        lost="how lobes change with the elevation",
    ),
    "feed_mm_min": NumberColumn(
        unit="mm/min",
        constraint=FEED,
        decimals=6,
        meaning="programmed measuring feed of the axis; of a rotary axis deg/min",
        example="100",
        lost="a delay from a length",
    ),
    "approach_mm": NumberColumn(
        unit="mm",
        constraint=WAY_MM,
        decimals=6,
        meaning="from the start of the move to the nominal surface; of a rotary axis deg",
        example="2.3494",
        lost="what a short ramp does, and when the surface is met",
    ),
    "position_mm": NumberColumn(
        unit="mm",
        constraint=PLACE_MM,
        decimals=PLACE_DECIMALS,
        meaning="axis coordinate of the nominal surface",
        example="-171.757",
        lost="errors along the axis: scale, screw, encoder",
    ),
    "rotary_deg": NumberColumn(
        unit="deg",
        constraint=ANGLE,
        decimals=3,
        meaning="rotary table position",
        example="90",
        lost="what turns with the table",
    ),
    "temp_c": NumberColumn(
        unit="°C",
        constraint=TEMPERATURE,
        decimals=3,
        meaning="machine temperature; any more thermometers stand in columns temp_NAME_c",
        example="20.022",
        lost="what grows with the temperature from what drifts with time",
    ),
    "edge_us": NumberColumn(
        unit="µs",
        constraint=INSTANT_US,
        decimals=3,
        trimmed=False,
        meaning="when the reference instrument saw the edge at the connector, master clock",
        example="16563155.060",
        lost="the latch's own delay from all that comes before it",
    ),
    "latch_us": NumberColumn(
        is_outcome=True,
        unit="µs",
        constraint=INSTANT_US,
        decimals=3,
        trimmed=False,
        meaning="the firmware's own time stamp of the latch, device clock",
        example="16563204.000",
        lost="when it was latched, and what its clock does",
    ),
    "report_us": NumberColumn(
        is_outcome=True,
        unit="µs",
        constraint=INSTANT_US,
        decimals=3,
        trimmed=False,
        meaning="when the report frame arrived, master clock",
        example="16563751.774",
        lost="what the reports do",
    ),
    "deviation_um": NumberColumn(
        is_outcome=True,
        unit="µm",
        constraint=LENGTH_UM,
        decimals=3,
        trimmed=False,
        meaning="latched minus nominal position along the approach: positive is overtravel",
        example="0.050",
        lost="where it was latched",
    ),
    "status": ChoiceColumn(
        is_outcome=True,
        codes={"ok": Status.OK, "missed": Status.MISSED, "false": Status.FALSE},
        meaning="what came of the touch: latched, no latch, latched with no contact",
        example="ok",
        lost="missed touches from those that were not recorded",
    ),
    "session": LabelColumn(
        since=2,
        meaning="what was homed, restarted or clamped anew begins another one",
        example="after lunch",
        lost="a step between sessions from a drift",
    ),
    "position_deg": NumberColumn(
        since=2,
        unit="deg",
        constraint=ANGLE,
        decimals=6,
        meaning="coordinate of the nominal surface on a rotary axis",
        example="45",
        lost="errors along a rotary axis",
    ),
    "deviation_arcsec": NumberColumn(
        since=2,
        is_outcome=True,
        unit="arcsec",
        constraint=ANGLE,
        decimals=3,
        trimmed=False,
        meaning="latched minus nominal angle along the approach, of touches by a rotary axis",
        example="1.250",
        lost="where a rotary axis was latched",
    ),
}

THERMOMETER = replace(
    COLUMNS["temp_c"],
    since=2,
    meaning="temperature at the place NAME",
    lost="which part of the machine it is that grows",
)
"""Any column temp_NAME_c."""

TIME = LabelColumn(
    since=2,
    meaning="in place of time_s: ISO 8601; the first of the campaign counts as 0",
    example="2026-03-01T14:05:12.250",
    lost=COLUMNS["time_s"].lost,
)
"""A column that is read, and written as time_s."""

REQUIRED_IN_VERSION_1 = ("touch", "time_s", "path", "feed_mm_min", "approach_mm")
REQUIRED = ("touch",)
CONDITIONS = tuple(name for name, column in COLUMNS.items() if not column.is_outcome)
# None of them stands in a missed touch.
MEASURED_OUTCOMES = ("latch_us", "report_us", "deviation_um", "deviation_arcsec")

_THERMOMETER_NAME = re.compile(r"temp_([a-z0-9_.-]{1,60})_c")


def is_thermometer(name: str) -> bool:
    """Tell whether a column is one temp_NAME_c."""
    return bool(_THERMOMETER_NAME.fullmatch(name))


def place_of(thermometer: str) -> str:
    """Give NAME of a column temp_NAME_c."""
    return thermometer.removeprefix("temp_").removesuffix("_c")
