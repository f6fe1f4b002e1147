"""The touches of a campaign in memory: one array a column."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign.column_kinds import NOT_RECORDED, Values
from skiplatch.campaign.columns import COLUMNS, MEASURED_OUTCOMES, InputPath, Status

CodeArray = NDArray[np.int8]
SerialArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Touches:
    """The rows of touches.csv, or of a selection of them, in the order of the file.

    Every array has the shape (n,). A number that was not recorded is NaN, a choice that was not
    recorded is `NOT_RECORDED`. What each column means and which values it admits stands in
    `COLUMNS`.

    `status` is kept as it was recorded. Where it was not, a touch with any measured outcome
    counts as ok, and one without is neither ok nor missed; so ask `ok`, `missed` and `false`
    rather than compare `status`.
    """

    touch: SerialArray
    time_s: FloatArray
    path: CodeArray
    """Codes of `InputPath`; see `on_skip` and `on_plc`."""
    axis: CodeArray
    """Codes of `Axis`."""
    sign: FloatArray
    """1 or -1, to multiply with."""
    alpha_deg: FloatArray
    beta_deg: FloatArray
    feed_mm_min: FloatArray
    approach_mm: FloatArray
    position_mm: FloatArray
    rotary_deg: FloatArray
    temp_c: FloatArray
    edge_us: FloatArray
    latch_us: FloatArray
    report_us: FloatArray
    deviation_um: FloatArray
    status: CodeArray
    """Codes of `Status`; see `ok`, `missed` and `false`."""

    def __post_init__(self) -> None:
        shapes = {getattr(self, field.name).shape for field in fields(self)}
        if shapes != {self.touch.shape} or self.touch.ndim != 1:
            raise ValueError(f"columns of shapes {sorted(shapes)}, not all of one (n,)")

    @classmethod
    def from_columns(cls, **columns: Values) -> Self:
        """Build from the columns that were recorded, each of shape (n,); the rest are empty."""
        rows = len(columns["touch"])
        absent = {name: COLUMNS[name].absent(rows) for name in COLUMNS.keys() - columns.keys()}
        given = {
            name: np.asarray(values, dtype=COLUMNS[name].empty.dtype)
            for name, values in columns.items()
        }
        return cls(**given, **absent)

    def __len__(self) -> int:
        return len(self.touch)

    def columns(self) -> dict[str, Values]:
        """Give the arrays by name, in the order of the table."""
        return {name: getattr(self, name) for name in COLUMNS}

    def select(self, rows: BoolArray | NDArray[np.intp] | slice) -> Self:
        """Give the rows of a mask, shape (n,), or of indices, shape (m,), or of a slice."""
        return type(self)(**{name: values[rows] for name, values in self.columns().items()})

    def in_order_of_time(self) -> Self:
        """Sort by the start of the measuring move; equal ones stay in the order of the file."""
        return self.select(np.argsort(self.time_s, kind="stable"))

    @property
    def on_skip(self) -> BoolArray:
        """Latched by the skip input; shape (n,)."""
        return _mask(self.path == InputPath.SKIP)

    @property
    def on_plc(self) -> BoolArray:
        """Latched by the PLC task; shape (n,)."""
        return _mask(self.path == InputPath.PLC)

    @property
    def measured(self) -> BoolArray:
        """Has a latch, a report or a deviation; shape (n,)."""
        empty = [np.isnan(getattr(self, name)) for name in MEASURED_OUTCOMES]
        return _mask(~np.logical_and.reduce(empty))

    @property
    def ok(self) -> BoolArray:
        """Touched and latched, as far as was recorded; shape (n,)."""
        unsaid = self.status == NOT_RECORDED
        return _mask((self.status == Status.OK) | (unsaid & self.measured))

    @property
    def missed(self) -> BoolArray:
        """Recorded as missed: no latch; shape (n,)."""
        return _mask(self.status == Status.MISSED)

    @property
    def false(self) -> BoolArray:
        """Recorded as latched with no contact; shape (n,)."""
        return _mask(self.status == Status.FALSE)


def _mask(comparison: BoolArray) -> BoolArray:
    """Give numpy's comparisons, which the type checker knows nothing of, their type."""
    return comparison
