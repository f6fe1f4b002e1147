"""Few digits, and still on the safe side."""

from decimal import ROUND_CEILING, ROUND_FLOOR, Context

DIGITS = 3


def rounded_down(value: float) -> float:
    """Give the next lower number of three significant digits; `value` > 0."""
    return float(Context(DIGITS, ROUND_FLOOR).create_decimal_from_float(value))


def rounded_up(value: float) -> float:
    """Give the next higher number of three significant digits; `value` > 0."""
    return float(Context(DIGITS, ROUND_CEILING).create_decimal_from_float(value))
