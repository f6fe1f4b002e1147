"""Writing touches.csv."""

import hashlib
import os
from collections.abc import Collection

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign.column_kinds import Column, NumberColumn, Values
from skiplatch.campaign.columns import (
    COLUMNS,
    MEASURED_OUTCOMES,
    REQUIRED,
    REQUIRED_IN_VERSION_1,
    THERMOMETER,
    Axis,
    is_thermometer,
)
from skiplatch.campaign.touches import Touches
from skiplatch.files import atomic_write_text

CHUNK_ROWS = 2_000


class InadmissibleError(ValueError):
    """A value is none that the format admits.

    Attributes:
        row: Of the touch, from 0.
        column: Its name.
        message: What was expected and what is there.
    """

    def __init__(self, row: int, column: str, message: str) -> None:
        super().__init__(f"{column}: {message}")
        self.row = row
        self.column = column
        self.message = message


def write_touches(path: str | os.PathLike[str], touches: Touches) -> None:
    """Write recorded touches, all columns, rounded to the decimals of the format.

    Raises:
        InputError: The file cannot be written.
        ValueError: There are no touches.
        InadmissibleError: Some value is none that the format admits.
    """
    atomic_write_text(path, format_touches(touches))


def format_touches(touches: Touches, names: Collection[str] = tuple(COLUMNS)) -> str:
    """Give the text of touches.csv, or of the named columns of it.

    Columns that only version 2 has are left out where nothing stands in them.
    """
    _refuse_inadmissible(touches)
    written = {name: values for name, values in _written(touches).items() if name in names}
    parts = [",".join((*written, *_thermometers(touches))) + "\n"]
    for start in range(0, len(touches), CHUNK_ROWS):
        rows = slice(start, start + CHUNK_ROWS)
        cells = [COLUMNS[name].format(values[rows]) for name, values in written.items()]
        cells += [THERMOMETER.format(t[rows]) for t in _thermometers(touches).values()]
        parts += [",".join(row) + "\n" for row in zip(*cells, strict=True)]
    return "".join(parts)


def fingerprint(touches: Touches) -> str:
    """Give a digest of all that would be written, by which the same touches are known again."""
    digest = hashlib.sha256()
    for name, values in (_written(touches) | _thermometers(touches)).items():
        column = COLUMNS.get(name, THERMOMETER)
        digest.update(f"{name} ".encode())
        if isinstance(column, NumberColumn):
            rounded = np.round(values.astype(float), column.decimals) + 0.0  # no -0
            digest.update(np.where(np.isnan(rounded), np.nan, rounded).tobytes())
        else:
            digest.update("\n".join(column.format(values)).encode())
    return digest.hexdigest()


def needs_version_2(touches: Touches) -> bool:
    """Tell whether version 1 of the format cannot hold these touches."""
    if touches.thermometers or (touches.axis > Axis.Z).any():
        return True
    written = _written(touches)
    return any(COLUMNS[name].since > 1 for name in written) or not all(
        COLUMNS[name].recorded(written[name]).all() for name in REQUIRED_IN_VERSION_1
    )


def _written(touches: Touches) -> dict[str, Values]:
    """Give the columns that are written, sessions by their names."""
    columns = touches.columns()
    columns["session"] = np.array(touches.session_names, dtype=object)[touches.session]
    return {
        name: values
        for name, values in columns.items()
        if COLUMNS[name].since == 1 or COLUMNS[name].recorded(values).any()
    }


def _thermometers(touches: Touches) -> dict[str, FloatArray]:
    return {f"temp_{name}_c": values for name, values in touches.thermometers.items()}


def _refuse_inadmissible(touches: Touches) -> None:
    if not len(touches):
        raise ValueError("a campaign has at least one touch")
    for name, values in _written(touches).items():
        _refuse_first(name, COLUMNS[name], values, required=name in REQUIRED)
    for name, values in _thermometers(touches).items():
        if not is_thermometer(name):
            row = int(np.argmax(THERMOMETER.recorded(values)))
            raise InadmissibleError(row, name, "expected temp_NAME_c, NAME of a-z, 0-9, _, . and -")
        _refuse_first(name, THERMOMETER, values, required=False)
    _refuse_unreadable(touches)


def _refuse_unreadable(touches: Touches) -> None:
    """Refuse what each touch may hold and all of them together may not: no reader would take it."""
    first = np.unique(touches.touch, return_index=True)[1]
    again = np.setdiff1d(np.arange(len(touches)), first)
    if len(again):
        row = int(again[0])
        raise InadmissibleError(row, "touch", f"serial number {touches.touch[row]} stands twice")
    wrong = np.flatnonzero(touches.missed & touches.measured)
    if len(wrong):
        row = int(wrong[0])
        name = next(n for n in MEASURED_OUTCOMES if not np.isnan(getattr(touches, n)[row]))
        raise InadmissibleError(row, name, "expected an empty cell in a missed touch")


def _refuse_first(name: str, column: Column, values: Values, *, required: bool) -> None:
    wrong = np.flatnonzero(~column.admits(values, required=required))
    if len(wrong):
        row = int(wrong[0])
        value = values[row]
        message = column.complaint(f"{value:g}" if isinstance(value, float) else str(value))
        raise InadmissibleError(row, name, message)
