"""The columns of touches.csv: the one table that reading, writing, checking and documents use."""

from collections.abc import Mapping
from enum import IntEnum

from skiplatch.campaign.column_kinds import ChoiceColumn, Column, NumberColumn, SerialColumn
from skiplatch.campaign.constraints import (
    ANY_NUMBER,
    ELEVATION,
    NOT_NEGATIVE,
    POSITIVE,
    SENSE,
    TEMPERATURE,
)


class InputPath(IntEnum):
    """Which input path latched."""

    SKIP = 0
    PLC = 1


class Axis(IntEnum):
    """The axis that mostly moves."""

    X = 0
    Y = 1
    Z = 2


class Status(IntEnum):
    """What came of a touch."""

    OK = 0
    MISSED = 1
    FALSE = 2


# In the order in which they are written.
COLUMNS: Mapping[str, Column] = {
    "touch": SerialColumn(
        required=True,
        meaning="serial number, unique in the campaign, any order",
    ),
    "time_s": NumberColumn(
        required=True,
        unit="s",
        constraint=NOT_NEGATIVE,
        decimals=6,
        meaning="start of the measuring move, master clock, since the campaign began",
    ),
    "path": ChoiceColumn(
        required=True,
        codes={"skip": InputPath.SKIP, "plc": InputPath.PLC},
        meaning="which input path latched",
    ),
    "axis": ChoiceColumn(
        codes={"X": Axis.X, "Y": Axis.Y, "Z": Axis.Z},
        meaning="the axis that mostly moves",
    ),
    "sign": NumberColumn(
        constraint=SENSE,
        decimals=0,
        meaning="the sense in which that axis moves",
    ),
    "alpha_deg": NumberColumn(
        unit="deg",
        constraint=ANY_NUMBER,
        decimals=3,
        meaning="probing direction in the plane normal to the probe axis",
    ),
    "beta_deg": NumberColumn(
        unit="deg",
        constraint=ELEVATION,
        decimals=3,
        meaning="angle of the probing direction to that plane",
    ),
    "feed_mm_min": NumberColumn(
        required=True,
        unit="mm/min",
        constraint=POSITIVE,
        decimals=6,
        meaning="programmed measuring feed",
    ),
    "approach_mm": NumberColumn(
        required=True,
        unit="mm",
        constraint=POSITIVE,
        decimals=6,
        meaning="from the start of the move to the nominal surface",
    ),
    "position_mm": NumberColumn(
        unit="mm",
        constraint=ANY_NUMBER,
        decimals=3,
        meaning="axis coordinate of the nominal surface",
    ),
    "rotary_deg": NumberColumn(
        unit="deg",
        constraint=ANY_NUMBER,
        decimals=3,
        meaning="rotary table position",
    ),
    "temp_c": NumberColumn(
        unit="°C",
        constraint=TEMPERATURE,
        decimals=3,
        meaning="machine temperature; the calibration was done at 20 °C",
    ),
    "edge_us": NumberColumn(
        unit="µs",
        constraint=ANY_NUMBER,
        decimals=3,
        trimmed=False,
        meaning="when the reference instrument saw the edge at the connector, master clock",
    ),
    "latch_us": NumberColumn(
        is_outcome=True,
        unit="µs",
        constraint=ANY_NUMBER,
        decimals=3,
        trimmed=False,
        meaning="the firmware's own time stamp of the latch, device clock",
    ),
    "report_us": NumberColumn(
        is_outcome=True,
        unit="µs",
        constraint=ANY_NUMBER,
        decimals=3,
        trimmed=False,
        meaning="when the report frame arrived, master clock",
    ),
    "deviation_um": NumberColumn(
        is_outcome=True,
        unit="µm",
        constraint=ANY_NUMBER,
        decimals=3,
        trimmed=False,
        meaning="latched minus nominal position along the approach: positive is overtravel",
    ),
    "status": ChoiceColumn(
        is_outcome=True,
        codes={"ok": Status.OK, "missed": Status.MISSED, "false": Status.FALSE},
        meaning="what came of the touch: latched, no latch, latched with no contact",
    ),
}

REQUIRED = tuple(name for name, column in COLUMNS.items() if column.required)
CONDITIONS = tuple(name for name, column in COLUMNS.items() if not column.is_outcome)
MEASURED_OUTCOMES = ("latch_us", "report_us", "deviation_um")  # none of them in a missed touch
