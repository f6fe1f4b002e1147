"""What is written is read back: for any campaign, not only for the samples."""

import tempfile
from dataclasses import replace
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
    BelievedEffect,
    Datum,
    DatumFreedom,
    Kind,
    Nominal,
    Touches,
    format_nominal,
    format_touches,
    read_conditions,
    read_nominal,
    read_touches,
)
from skiplatch.campaign.column_kinds import ChoiceColumn, Column, LabelColumn, NumberColumn
from skiplatch.campaign.columns import MEASURED_OUTCOMES, REQUIRED_IN_VERSION_1
from skiplatch.campaign.constraints import Constraint, OneOf, Range
from skiplatch.campaign.nominal import SECTIONS

NOTHING = {"nan", "na", "n/a", "null", "none"}


def numbers(constraint: Constraint) -> st.SearchStrategy[float]:
    match constraint:
        case OneOf(values=values):
            return st.sampled_from(values)
        case Range(low=low, high=high):
            return st.floats(low, high)
    raise TypeError(constraint)


def labels() -> st.SearchStrategy[str]:
    printable = st.characters(categories=["L", "M", "N", "P", "S", "Zs"]).filter(str.isprintable)
    return st.text(printable, max_size=8).map(str.strip).filter(lambda s: s.lower() not in NOTHING)


def values_of(name: str, column: Column) -> st.SearchStrategy[Any]:
    required = name in REQUIRED_IN_VERSION_1
    if isinstance(column, LabelColumn):
        return labels()
    if isinstance(column, ChoiceColumn):
        kind = st.sampled_from(list(column.codes.values()))
        return kind if required else kind | st.just(NOT_RECORDED)
    assert isinstance(column, NumberColumn)
    recorded = numbers(column.constraint)
    return recorded if required else recorded | st.just(np.nan)


@st.composite
def touches_of_any_kind(draw: st.DrawFn) -> Touches:
    serials = draw(st.lists(st.integers(0, 2**53 - 1), min_size=1, max_size=8, unique=True))
    columns: dict[str, Any] = {"touch": np.array(serials)}
    size = len(serials)
    for name, column in COLUMNS.items():
        if name != "touch":
            values = draw(st.lists(values_of(name, column), min_size=size, max_size=size))
            columns[name] = values if name == "session" else np.array(values)
    places = draw(st.lists(st.sampled_from(["spindle", "bed", "nut_x"]), unique=True))
    warmth = [
        np.array(draw(st.lists(st.floats(-50, 90), min_size=size, max_size=size))) for _ in places
    ]
    thermometers = dict(zip(places, warmth, strict=True))
    touches = Touches.from_columns(**columns, thermometers=thermometers)
    for name in MEASURED_OUTCOMES:
        getattr(touches, name)[touches.missed] = np.nan
    return touches


@st.composite
def nominals_of_any_kind(draw: st.DrawFn) -> Nominal:
    sections: dict[str, dict[str, float]] = {section: {} for section in SECTIONS}
    for (section, name), key in KEYS.items():
        sections[section][name] = draw(numbers(key.constraint))
    unknown = draw(st.frozensets(st.sampled_from(list(KEYS)), max_size=5))
    for section, name in unknown:
        sections[section][name] = KEYS[section, name].default
    reach = sections["axis"]
    reach["min_mm"], reach["max_mm"] = sorted((reach["min_mm"], reach["max_mm"]))
    tables: dict[str, Any] = {name: SECTIONS[name](**table) for name, table in sections.items()}
    known = st.sampled_from(sorted(KEYS.keys() - unknown))
    u = st.floats(0, 1e15)
    # A key of version 2 that stands at its default is not written, and so unknown when read.
    silent = {
        key
        for key, about in KEYS.items()
        if about.since > 1 and sections[key[0]][key[1]] == about.default
    }
    u_um = st.none() | st.floats(0, 1e7)
    nominal = Nominal(
        kind=draw(st.sampled_from(Kind)),
        **tables,
        uncertainty=draw(st.dictionaries(known, u, max_size=3)),
        datum=Datum(draw(st.sampled_from(DatumFreedom)), draw(u_um)),
        believed_effects=tuple(draw(st.lists(believed_effects(), max_size=2))),
        unknown=unknown,
    )
    return replace(nominal, unknown=unknown | (silent - nominal.uncertainty.keys()), version=2)


@st.composite
def believed_effects(draw: st.DrawFn) -> BelievedEffect:
    values = draw(st.dictionaries(st.sampled_from(["a_um", "b_us"]), st.floats(-1e15, 1e15)))
    u = draw(st.dictionaries(st.sampled_from(sorted(values)), st.floats(0, 9))) if values else {}
    return BelievedEffect(draw(st.sampled_from(["backlash", "isr_latency"])), values, u)


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
    again = read_back_touches(format_touches(touches))

    for name, values in touches.columns().items():
        column = COLUMNS[name]
        if name == "session":
            assert sessions(again) == sessions(touches)
        elif isinstance(column, NumberColumn):
            half_a_digit = 0.5 * 10.0**-column.decimals
            np.testing.assert_allclose(
                getattr(again, name), values, rtol=1e-15, atol=1.01 * half_a_digit
            )
        else:
            np.testing.assert_array_equal(getattr(again, name), values)
    for name, values in touches.thermometers.items():
        np.testing.assert_allclose(again.thermometers[name], values, atol=0.000501)


def sessions(touches: Touches) -> list[str]:
    return [touches.session_names[number] for number in touches.session]


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
