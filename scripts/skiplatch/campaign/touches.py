"""The touches of a campaign in memory: one array a column."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign.column_kinds import NOT_RECORDED, ChoiceColumn, Values
from skiplatch.campaign.columns import COLUMNS, MEASURED_OUTCOMES, Axis, InputPath, Status
from skiplatch.dataframes import DataFrame, Library, dataframe

CodeArray = NDArray[np.int8]
SerialArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Touches:
    """The rows of touches.csv, or of a selection of them, in the order of the file.

    Every array has the shape (n,). A number that was not recorded is NaN, a choice that was not
    recorded is -1. ``skiplatch columns`` prints what each column means and which values it admits.

    `status` is kept as it was recorded. Where it was not, a touch with any measured outcome
    counts as ok, and one without is neither ok nor missed; so ask `ok`, `missed` and `false`
    rather than compare `status`.

    Attributes:
        touch: Serial number.
        time_s: Start of the measuring move.
        path: 0 for skip, 1 for plc; see `on_skip` and `on_plc`.
        axis: 0 to 5 for X, Y, Z, A, B, C.
        sign: 1 or -1, the sense of the move, to multiply with.
        alpha_deg, beta_deg: Direction of the approach.
        feed_mm_min, approach_mm, position_mm, rotary_deg, temp_c: As in touches.csv.
        edge_us, latch_us, report_us, deviation_um: What came of it.
        status: 0 for ok, 1 for missed, 2 for false; see `ok`, `missed` and `false`.
        session: Number of its name in `session_names`.
        position_deg, deviation_arcsec: Those of an axis that turns.
        session_names: Texts, in the order of the file.
        thermometers: Further temperatures in °C, by the names of their places.
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
    session: SerialArray
    """Numbers of `session_names`."""
    position_deg: FloatArray
    deviation_arcsec: FloatArray
    # Of no type, so that columns by name can be given to replace().
    session_names: Any = ("",)
    """tuple[str, ...], in the order of the file; one that is empty where none was recorded."""
    thermometers: Any = field(default_factory=dict)
    """Mapping[str, FloatArray]: further temperatures in °C by the names of their places."""

    def __post_init__(self) -> None:
        arrays = [*self.columns().values(), *self.thermometers.values()]
        shapes = {array.shape for array in arrays}
        if shapes != {self.touch.shape} or self.touch.ndim != 1:
            raise ValueError(f"columns of shapes {sorted(shapes)}, not all of one (n,)")
        if len(self) and not 0 <= self.session.min() <= self.session.max() < len(
            self.session_names
        ):
            raise ValueError(f"sessions beyond the {len(self.session_names)} that have a name")

    @classmethod
    def from_columns(
        cls,
        *,
        session: Any = None,  # noqa: ANN401
        session_names: Any = None,  # noqa: ANN401
        thermometers: Any = None,  # noqa: ANN401
        **columns: Values,
    ) -> Self:
        """Build from the columns that were recorded, each of shape (n,); the rest are empty.

        A path that was not recorded counts as skip.

        Args:
            session: Texts, or numbers of `session_names`.
            session_names: tuple[str, ...]; without it all sessions that are numbers are 0.
            thermometers: Mapping[str, FloatArray].
            **columns: By name.
        """
        rows = len(columns["touch"])
        absent = {name: COLUMNS[name].absent(rows) for name in COLUMNS.keys() - columns.keys()}
        given = {
            name: np.asarray(values, dtype=COLUMNS[name].empty.dtype)
            for name, values in columns.items()
        }
        all_columns: dict[str, Any] = {**given, **absent}
        path = all_columns["path"]
        all_columns["path"] = np.where(path == NOT_RECORDED, np.int8(InputPath.SKIP), path)
        if session is None:
            session = np.zeros(rows, dtype=np.int64)
        if np.asarray(session).dtype.kind in "OU":
            session, session_names = _numbered(session)
        all_columns["session"] = np.asarray(session, dtype=np.int64)
        return cls(
            **all_columns,
            session_names=session_names or ("",),
            thermometers=thermometers or {},
        )

    def __len__(self) -> int:
        return len(self.touch)

    def columns(self) -> dict[str, Values]:
        """Give the arrays by name, in the order of the table."""
        return {name: getattr(self, name) for name in COLUMNS}

    def to_dataframe(self, library: Library | None = None) -> DataFrame:
        """Give the columns of touches.csv, choices and sessions as text, None or NaN where empty.

        Raises:
            ImportError: Neither pandas nor polars is installed, or not the one wanted.
        """
        table: dict[str, Any] = {
            name: _texts(column, values)
            if isinstance(column := COLUMNS[name], ChoiceColumn)
            else values
            for name, values in self.columns().items()
        }
        table["session"] = [self.session_names[number] or None for number in self.session]
        warmth = {f"temp_{place}_c": values for place, values in self.thermometers.items()}
        return dataframe(table | warmth, library)

    def select(self, rows: BoolArray | NDArray[np.intp] | slice) -> Self:
        """Give the rows of a mask, shape (n,), or of indices, shape (m,), or of a slice."""
        chosen: dict[str, Any] = {name: values[rows] for name, values in self.columns().items()}
        warmth = {name: values[rows] for name, values in self.thermometers.items()}
        return replace(self, **chosen, thermometers=warmth)

    def in_order_of_time(self) -> Self:
        """Sort by the start of the measuring move; equal ones stay in the order of the file.

        A touch whose time was not recorded stays behind the touch before it in the file.
        """
        last = last_known(self.time_s)
        times_s = np.where(last < 0, -np.inf, self.time_s[last])
        return self.select(np.argsort(times_s, kind="stable"))

    @property
    def on_skip(self) -> BoolArray:
        """Latched by the skip input; shape (n,)."""
        return _mask(self.path == InputPath.SKIP)

    @property
    def on_plc(self) -> BoolArray:
        """Latched by the PLC task; shape (n,)."""
        return _mask(self.path == InputPath.PLC)

    @property
    def start_delay_us(self) -> FloatArray:
        """By which moves began later than `time_s`; none is known; shape (n,)."""
        return np.zeros(len(self))

    @property
    def turns(self) -> BoolArray:
        """Made by a rotary axis; shape (n,)."""
        return _mask(self.axis >= Axis.A)

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


def last_known(values: FloatArray) -> NDArray[np.intp]:
    """Give of each row the last one up to it with a value, -1 where there is none; shape (n,)."""
    rows = np.where(np.isnan(values), -1, np.arange(len(values)))
    return np.asarray(np.maximum.accumulate(rows))


def _mask(comparison: BoolArray) -> BoolArray:
    """Give numpy's comparisons, which the type checker knows nothing of, their type."""
    return comparison


def _texts(column: ChoiceColumn, codes: CodeArray) -> list[str | None]:
    return [text or None for text in column.format(codes)]


def _numbered(sessions: Sequence[str]) -> tuple[SerialArray, tuple[str, ...]]:
    """Number texts in the order in which they come."""
    names = tuple(dict.fromkeys(sessions))
    number_of = {name: number for number, name in enumerate(names)}
    return np.array([number_of[name] for name in sessions], dtype=np.int64), names
