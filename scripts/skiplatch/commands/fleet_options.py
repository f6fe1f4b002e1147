"""What the commands of a fleet share: the store, and answers as text and JSON."""

import math
from collections.abc import Iterable
from datetime import date, datetime, timedelta
from decimal import Decimal
from pathlib import Path
from typing import Any

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import NumberType
from skiplatch.commands.options import Decorator
from skiplatch.errors import InputError, as_told
from skiplatch.fleet.budget import ALARMS_A_MONTH
from skiplatch.fleet.reading import Answer
from skiplatch.tables import NOTHING, number, table

REFUSED = 2
"""Exit status if a campaign was refused."""

store_option: Decorator = click.option(
    "--store",
    type=Source(is_whole=True),
    required=True,
    help="The folder of the store.",
)

days_option: Decorator = click.option(
    "--days",
    type=NumberType(1e-3, 36_525.0),
    default=31.0,
    show_default=True,
    help="How long before the newest diagnosed campaign a change was seen at most.",
)
rate_option: Decorator = click.option(
    "--false-alarms-per-month",
    "alarms_a_month",
    type=NumberType(1e-6, 1e6),
    default=ALARMS_A_MONTH,
    show_default=True,
    help="How many false alarms of the whole fleet may be expected in a month.",
)


def tell_refused(refused: Iterable[tuple[Path, InputError]]) -> None:
    """Say which campaigns were refused, a line each."""
    for _, error in refused:
        click.echo(as_told(error), err=True)


def refused_json(refused: Iterable[tuple[Path, InputError]]) -> list[dict[str, str]]:
    """Give them with their reasons."""
    return [{"path": str(folder), "why": str(error)} for folder, error in refused]


def in_own_units(answer: Answer) -> Answer:
    """Leave out columns of angles, or those of lengths beside them, that nothing stands in."""
    known = {
        name
        for place, name in enumerate(answer.columns)
        if any(r[place] is not None for r in answer.rows)
    }

    def is_shown(name: str) -> bool:
        quantity, _, unit = name.rpartition("_")
        is_length = unit == "um" and f"{quantity}_arcsec" in known
        return name in known or not (unit == "arcsec" or is_length)

    kept = [place for place, name in enumerate(answer.columns) if is_shown(name)]
    rows = [tuple(row[place] for place in kept) for row in answer.rows]
    return Answer([answer.columns[place] for place in kept], rows)


def answer_text(columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Lay an answer out as a table."""
    return table(list(columns), [[_cell(value) for value in row] for row in rows])


def _cell(value: object) -> str:
    if value is None:
        return NOTHING
    if isinstance(value, float) and math.isfinite(value):
        return number(value)
    return str(value)


def plain(value: Any) -> Any:  # noqa: ANN401
    """Give a value of an answer as JSON has it; what is no number is null there."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    if isinstance(value, Decimal | timedelta):
        return plain(float(value) if isinstance(value, Decimal) else value.total_seconds())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, date | datetime):
        return value.isoformat()
    return value if value is None or isinstance(value, bool | int | str) else str(value)
