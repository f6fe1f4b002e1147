"""What the sequence of touches makes of each, on a list with gaps in its numbers."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, InputPath, Touches, read_campaign
from skiplatch.diagnosis.scene.covariates import (
    Order,
    before,
    conditions,
    in_words,
    sequence,
    varying,
)
from skiplatch.diagnosis.scene.scene import Scene

NAN = np.nan
SERIAL = [10, 11, 13, 14, 17]


def scene(**columns: object) -> Scene:
    """Five touches, of which the third and the last follow one that is not in the record."""
    given = {
        "touch": np.array(SERIAL),
        "time_s": np.array([0.0, 8.0, 30.0, 75.0, 100.0]),
        "path": np.array([InputPath.SKIP, InputPath.PLC, InputPath.PLC, InputPath.SKIP, 0]),
        "axis": np.array([Axis.X, Axis.X, Axis.Y, Axis.Y, Axis.Y]),
        "sign": np.array([1.0, 1.0, -1.0, -1.0, 1.0]),
        "alpha_deg": np.array([0.0, 90.0, 180.0, 180.0, 0.0]),
        "beta_deg": np.zeros(5),
        "feed_mm_min": np.array([100.0, 300.0, 100.0, 300.0, 100.0]),
        "approach_mm": np.full(5, 3.0),
        "position_mm": np.array([0.0, 10.0, 5.0, -5.0, 0.0]),
        "temp_c": np.array([20.0, 20.5, 21.0, 20.0, 20.0]),
    }
    touches = Touches.from_columns(**{**given, **columns})  # type: ignore[arg-type]
    return Scene(read_campaign(MACHINE).nominal, touches)


def test_a_named_thermometer_is_a_condition_by_its_column() -> None:
    bed_c = np.array([20.0, 40.0, 60.0, NAN, 60.0])

    known = conditions(scene(thermometers={"heater_bed": bed_c}))

    np.testing.assert_array_equal(known["temp_heater_bed_c"], bed_c)
    assert "temp_heater_bed_c" not in conditions(scene())


def made(name: str) -> FloatArray:
    return sequence(scene())[name]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("serial number", [0, 1, 3, 4, 7]),
        ("serial number in a cycle of 3", [0, 1, 0, 1, 1]),
        ("rest before", [NAN, 8.0, NAN, 45.0, NAN]),
        ("way since the touch before", [NAN, 10.0, NAN, 10.0, NAN]),
        ("signed way since the touch before", [NAN, 10.0, NAN, -10.0, NAN]),
        ("turn since the touch before", [NAN, 0.0, NAN, 1.0, NAN]),
        ("direction of the touch before", [NAN, 0.0, NAN, 180.0, NAN]),
        ("sense of the touch before", [NAN, 1.0, NAN, -1.0, NAN]),
        ("feed of the touch before", [NAN, 100.0, NAN, 100.0, NAN]),
        ("axis of the touch before", [NAN, Axis.X, NAN, Axis.Y, NAN]),
        ("path of the touch before", [NAN, InputPath.SKIP, NAN, InputPath.PLC, NAN]),
        ("change of temperature", [NAN, 0.5, NAN, -1.0, NAN]),
        ("touches since a change of axis", [0, 1, 0, 1, 4]),
        ("touches since a change of sense", [0, 1, 0, 1, 0]),
        ("rest since a touch of the same axis", [NAN, 8.0, NAN, 45.0, 25.0]),
        ("rest since a touch of the same path", [NAN, NAN, 22.0, 75.0, 25.0]),
        ("touches in the 10 s before", [0, 1, 0, 0, 0]),
        ("touches in the 60 s before", [0, 1, 2, 1, 1]),
    ],
)
def test_the_sequence_tells_of_a_touch(name: str, expected: list[float]) -> None:
    np.testing.assert_allclose(made(name), expected, atol=1e-12)


def test_numbers_that_do_not_ascend_with_time_give_way_to_the_order_itself() -> None:
    turned = scene(touch=np.array([4, 3, 2, 1, 0]))

    np.testing.assert_array_equal(Order.of(turned).serial, np.arange(5))


def test_scores_before_a_touch_are_those_of_its_numbers_and_not_its_own() -> None:
    order = Order.of(scene())
    scores = np.array([1.0, 2.0, 4.0, 8.0, 16.0])

    around = before(order, scores)

    np.testing.assert_array_equal(
        around["what is left 1 touches before"], [NAN, 1.0, NAN, 4.0, NAN]
    )
    np.testing.assert_array_equal(
        around["what is left 3 touches before"], [NAN, NAN, 1.0, 2.0, 8.0]
    )


def test_the_score_of_a_touch_tells_nothing_of_itself_nor_of_those_before() -> None:
    order, rng = Order(np.arange(50)), np.random.default_rng(1)
    scores = rng.normal(size=50)
    other = scores.copy()
    other[20] += 100.0

    for name, values in before(order, scores).items():
        told = before(order, other)[name][: 20 + 1]
        assert told == pytest.approx(values[: 20 + 1], nan_ok=True), name


def test_what_does_not_vary_or_was_not_recorded_is_left_out() -> None:
    columns = {
        "constant": np.full(5, 3.0),
        "unknown": np.full(5, NAN),
        "partly known": np.array([1.0, NAN, 2.0, NAN, NAN]),
        "varies elsewhere": np.array([1.0, 1.0, 1.0, 2.0, 2.0]),
    }
    rows = np.array([True, True, True, False, False])

    kept = varying(columns, rows)

    assert kept.keys() == {"partly known"}
    np.testing.assert_array_equal(kept["partly known"], [1.0, NAN, 2.0])


def test_missing_conditions_stay_missing() -> None:
    plain = scene()
    unknown = Scene(plain.nominal, replace(plain.touches, temp_c=np.full(5, NAN)))

    assert np.isnan(conditions(unknown)["temperature"]).all()
    assert np.isnan(sequence(unknown)["change of temperature"]).all()


def test_scores_of_other_touches_have_one_word() -> None:
    order = Order.of(scene())
    words = {in_words(name) for name in before(order, np.arange(5.0))}

    assert words == {"the touches around it"}
    assert in_words("rest before") == "rest before"
