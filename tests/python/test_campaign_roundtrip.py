"""What is written is read back: for any campaign, not only for the samples."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from skiplatch.campaign import (
    COLUMNS,
    CONDITIONS,
    KEYS,
    NOT_RECORDED,
    Kind,
    Nominal,
    Touches,
    format_nominal,
    format_touches,
    read_conditions,
    read_nominal,
    read_touches,
)
from skiplatch.campaign.column_kinds import ChoiceColumn, Column, NumberColumn
from skiplatch.campaign.columns import MEASURED_OUTCOMES
from skiplatch.campaign.constraints import Constraint, OneOf, Range
from skiplatch.campaign.nominal import SECTIONS


def numbers(constraint: Constraint) -> st.SearchStrategy[float]:
    match constraint:
        case OneOf(values=values):
            return st.sampled_from(values)
        case Range(low=low, high=high):
            return st.floats(low, high)
    raise TypeError(constraint)


def values_of(column: Column) -> st.SearchStrategy[float]:
    if isinstance(column, ChoiceColumn):
        kind = st.sampled_from(list(column.codes.values()))
        return kind if column.required else kind | st.just(NOT_RECORDED)
    assert isinstance(column, NumberColumn)
    recorded = numbers(column.constraint)
    return recorded if column.required else recorded | st.just(np.nan)


@st.composite
def touches_of_any_kind(draw: st.DrawFn) -> Touches:
    serials = draw(st.lists(st.integers(0, 2**53 - 1), min_size=1, max_size=8, unique=True))
    columns: dict[str, Any] = {"touch": np.array(serials)}
    for name, column in COLUMNS.items():
        if name != "touch":
            size = len(serials)
            columns[name] = np.array(
                draw(st.lists(values_of(column), min_size=size, max_size=size))
            )
    touches = Touches.from_columns(**columns)
    for name in MEASURED_OUTCOMES:
        getattr(touches, name)[touches.missed] = np.nan
    return touches


@st.composite
def nominals_of_any_kind(draw: st.DrawFn) -> Nominal:
    sections: dict[str, dict[str, float]] = {section: {} for section in SECTIONS}
    for (section, name), key in KEYS.items():
        sections[section][name] = draw(numbers(key.constraint))
    tables: dict[str, Any] = {name: SECTIONS[name](**table) for name, table in sections.items()}
    return Nominal(kind=draw(st.sampled_from(Kind)), **tables)


def stored(text: str) -> Path:
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", delete=False) as file:
        file.write(text)
    return Path(file.name)


def read_back_touches(text: str) -> Touches:
    path = stored(text)
    try:
        return read_touches(path)
    finally:
        path.unlink()


@given(nominals_of_any_kind())
def test_nominal_is_read_back_exactly(nominal: Nominal) -> None:
    path = stored(format_nominal(nominal))
    try:
        assert read_nominal(path) == nominal
    finally:
        path.unlink()


@given(touches_of_any_kind())
def test_touches_are_read_back_to_the_decimals_written(touches: Touches) -> None:
    again = read_back_touches(format_touches(touches)).columns()

    for name, values in touches.columns().items():
        column = COLUMNS[name]
        if isinstance(column, NumberColumn):
            half_a_digit = 0.5 * 10.0**-column.decimals
            np.testing.assert_allclose(again[name], values, rtol=1e-15, atol=1.01 * half_a_digit)
        else:
            np.testing.assert_array_equal(again[name], values)


@given(touches_of_any_kind())
def test_text_once_written_is_written_the_same_ever_after(touches: Touches) -> None:
    text = format_touches(touches)

    assert format_touches(read_back_touches(text)) == text


@given(touches_of_any_kind())
def test_conditions_are_read_back(touches: Touches) -> None:
    text = format_touches(touches, CONDITIONS)
    path = stored(text)
    try:
        assert format_touches(read_conditions(path), CONDITIONS) == text
    finally:
        path.unlink()
