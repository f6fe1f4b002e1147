"""Numbers that options of any command take: commands and options are found by themselves."""

import click
import pytest
from click.testing import CliRunner, Result

from hostile import commands
from skiplatch.cli import group
from skiplatch.commands.numbers import CountType, NumberType

NO_NUMBERS = ["nan", "inf", "-inf", "1e300", "1_0", "\u0661\u0662", "\uff11"]
"""To Python's float() each is a number; the last ones are digits of other scripts."""
WORDS = (click.Path, click.Choice, type(click.STRING), type(click.BOOL))
"""Types of what is no number."""

NUMBERS = [
    (*words, max(option.opts, key=len))
    for words, command in commands()
    for option in command.params
    if isinstance(option, click.Option) and not isinstance(option.type, WORDS)
]


def call(*words: str) -> Result:
    return CliRunner().invoke(group, words)


@pytest.mark.parametrize("text", NO_NUMBERS)
@pytest.mark.parametrize("option", NUMBERS, ids=" ".join)
def test_what_is_no_finite_number_in_plain_digits_is_refused(
    option: tuple[str, ...], text: str
) -> None:
    result = call(*option[:-1], f"{option[-1]}={text}")

    assert result.exit_code == 2, repr(result.exception)
    assert result.stderr.startswith(f"Error: Invalid value for '{option[-1]}'")
    assert result.stderr.count("\n") == 1
    assert not result.stdout


def test_every_number_has_a_range() -> None:
    types = [
        (words, option.name, option.type)
        for words, command in commands()
        for option in command.params
    ]
    numbers = (type(click.FLOAT), type(click.INT))

    loose = [
        place
        for place in types
        if isinstance(place[2], numbers) and not isinstance(place[2], NumberType | CountType)
    ]

    assert not loose
    assert len([place for place in types if isinstance(place[2], NumberType)]) > 30


@pytest.mark.parametrize(
    "text", ["isr_latency:latency_us=1,latency_us=2", "backlash:y_more=1,y_more=1"]
)
def test_a_parameter_that_is_given_twice_is_refused(text: str) -> None:
    result = call("diagnose", f"--truth={text}")

    assert result.exit_code == 2
    assert "is given twice" in result.stderr


@pytest.mark.parametrize(
    ("option", "text"), [("--feed-error", "1000"), ("--tau", "1e300"), ("--v0", "1e150")]
)
def test_a_figure_that_no_probe_has_is_told_with_its_range(option: str, text: str) -> None:
    result = call("compensate", option, text)

    assert "expected a number from " in result.stderr
    assert result.exit_code == 2
