"""Parameters of effects that were called otherwise before 0.2.0; their old names are still read."""

from collections.abc import Mapping
from typing import TypeVar

from skiplatch.files import Json

Value = TypeVar("Value")

PRESENT = {
    "y_more": "y_excess_ratio",
    "z_more": "z_excess_ratio",
    "again": "retry_excess",
    "direct": "unqueued_share",
    "cold": "starts_at_calibration",
    "unset": "set_on_believed_centre",
    "punctual": "on_time_share",
}
"""Present names by the former ones, of which none is another effect's present name."""
BY_PARAMETER = ("params", "intervals")
"""Objects in the document of a diagnosis whose keys are parameters."""
BY_BELIEF = "beliefs"
"""The one whose keys are an effect and a parameter, with a point between."""


def present_name(name: str) -> str:
    """Give what a parameter is called now."""
    return PRESENT.get(name, name)


def present_names(values: Mapping[str, Value]) -> dict[str, Value]:
    """Give values by the present names of their parameters.

    Raises:
        ValueError: A parameter is given by its former name and by its present one.
    """
    for name in values.keys() & PRESENT.keys():
        if PRESENT[name] in values:
            raise ValueError(f"{name} is the former name of {PRESENT[name]}: expected one of them")
    return {present_name(name): value for name, value in values.items()}


def renewed(document: Json) -> Json:
    """Give the document of a diagnosis with the present names of parameters.

    Raises:
        ValueError: A parameter is given by its former name and by its present one.
    """
    if isinstance(document, list):
        return [renewed(entry) for entry in document]
    if not isinstance(document, dict):
        return document
    return {key: _by_present_names(key, renewed(value)) for key, value in document.items()}


def _by_present_names(key: str, value: Json) -> Json:
    if not isinstance(value, dict):
        return value
    if key in BY_PARAMETER:
        return present_names(value)
    if key == BY_BELIEF:
        parts = ((name.rpartition("."), inner) for name, inner in value.items())
        return {f"{head}{dot}{present_name(name)}": inner for (head, dot, name), inner in parts}
    return value
