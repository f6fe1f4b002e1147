"""Numbers in texts of others: read whole or not at all.

Python takes digits of any script for numbers, and `1_0` for 10; a pattern that ends too early takes
`1e300` for 1. Neither is what the text says.
"""

import re

PLAIN = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?![\d_.])"
"""A number without sign or exponent, as in G-code, where a letter begins the next word."""
NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?(?!\w|\.\w)"
"""A number as programs print it, with nothing behind it that would be a part of it."""

_WHOLE = re.compile(NUMBER)


def number(text: str) -> float:
    """Give the number that a text is, but for blanks around it.

    Raises:
        ValueError: It is none.
    """
    if not _WHOLE.fullmatch(text.strip()):
        raise ValueError(text)
    return float(text)
