"""The tables of a store: which columns there are, and touches on their way into one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign import COLUMNS, NOT_RECORDED, Touches
from skiplatch.campaign.column_kinds import ChoiceColumn, LabelColumn, NumberColumn
from skiplatch.fleet.engine import Connection

CAMPAIGNS: Mapping[str, str] = {
    "campaign": "VARCHAR",
    "rig": "VARCHAR",
    "month": "VARCHAR",
    "recorded_at": "TIMESTAMP",
    "folder": "VARCHAR",
    "kind": "VARCHAR",
    "touches": "BIGINT",
    "sessions": "VARCHAR[]",
    "nominal": "VARCHAR",
    "tool": "VARCHAR",
    "content": "VARCHAR",
    "verdict": "VARCHAR",
    "seed": "BIGINT",
    "gap_um": "DOUBLE",
    "gap_arcsec": "DOUBLE",
    "axes": "VARCHAR",
    "stage": "VARCHAR",
    "gaps": "STRUCT(observable VARCHAR, unit VARCHAR, before DOUBLE, after DOUBLE,"
    " noise_floor DOUBLE)[]",
    "effects": "STRUCT(effect VARCHAR, stage VARCHAR, confidence DOUBLE, parameter VARCHAR,"
    ' "value" DOUBLE, low DOUBLE, high DOUBLE)[]',
    "touches_sha256": "VARCHAR",
    "index_sha256": "VARCHAR",
}
"""Columns of the index, one row a campaign, and their types; docs/FLEET.md says what they mean."""

TEXTS = tuple(
    name for name, column in COLUMNS.items() if isinstance(column, ChoiceColumn | LabelColumn)
)
"""Columns of touches that hold texts: of one without any, the engine cannot guess that."""


def kept_touches(files: str) -> str:
    """Give SQL for touches of campaigns, whatever each of them has recorded.

    Files of skiplatch 0.2.0 have a column without texts as one of another type, so neither the
    type of the first file holds for all, nor is that of all together a text.

    Args:
        files: What `read_parquet` is given, in SQL.
    """
    texts = ", ".join(f"{name}::VARCHAR AS {name}" for name in TEXTS)
    return f"SELECT * REPLACE ({texts}) FROM read_parquet({files}, union_by_name = true)"  # noqa: S608 - names of the product's own


def write_touches(engine: Connection, campaign: str, touches: Touches, target: Path) -> None:
    """Write the touches of a campaign as Parquet, in the order of the file.

    What was not recorded is NULL; choices are their names; all files have the same columns.
    """
    from duckdb import ConstantExpression  # noqa: PLC0415 - see `engine.connect`

    recorded = {name: _values(touches, name) for name in COLUMNS}
    warmth = {f"at {name}": values for name, values in touches.thermometers.items()}
    engine.register("recorded", {**recorded, **warmth})
    try:
        engine.table("recorded").project(
            ConstantExpression(campaign).alias("campaign"),
            *(_column(name) for name in COLUMNS),
            _thermometers(list(touches.thermometers)),
        ).write_parquet(str(target), compression="zstd")
    finally:
        engine.unregister("recorded")


def _values(touches: Touches, name: str) -> Any:  # noqa: ANN401
    """Give a column as the engine takes it: numbers with NaN, or texts with None."""
    values = getattr(touches, name)
    column = COLUMNS[name]
    if name == "session":
        return np.array([text or None for text in touches.session_names], dtype=object)[values]
    if isinstance(column, ChoiceColumn):
        names = np.full(len(column.codes) + 1, None, dtype=object)
        for text, code in column.codes.items():
            names[code] = text
        names[NOT_RECORDED] = None
        return names[values]
    return values


def _column(name: str) -> Any:  # noqa: ANN401
    from duckdb import ColumnExpression  # noqa: PLC0415 - see `engine.connect`

    column = ColumnExpression(name)
    if isinstance(COLUMNS[name], NumberColumn):
        return _nan_is_null(column).alias(name)
    return column.cast("VARCHAR").alias(name) if name in TEXTS else column


def _nan_is_null(column: Any) -> Any:  # noqa: ANN401
    from duckdb import ConstantExpression, FunctionExpression  # noqa: PLC0415 - see `connect`

    return FunctionExpression("nullif", column, ConstantExpression(float("nan")))


def _thermometers(places: list[str]) -> Any:  # noqa: ANN401
    """Give the further temperatures as one map of place to °C."""
    from duckdb import (  # noqa: PLC0415 - see `engine.connect`
        ColumnExpression,
        ConstantExpression,
        FunctionExpression,
    )

    keys = FunctionExpression("list_value", *(ConstantExpression(place) for place in places))
    values = [_nan_is_null(ColumnExpression(f"at {place}")) for place in places]
    temperatures = FunctionExpression("list_value", *values)
    mapped = FunctionExpression("map", keys, temperatures)
    return mapped.cast("MAP(VARCHAR, DOUBLE)").alias("thermometers_c")
