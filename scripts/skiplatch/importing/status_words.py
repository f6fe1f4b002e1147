"""What came of a touch, in the words of tables: ``FOUND``, ``not found``, ``no contact``."""

import re
from collections.abc import Mapping, Sequence

from skiplatch.campaign.column_kinds import tidy
from skiplatch.errors import quoted
from skiplatch.importing.model import Imported

_OK, _MISSED, _FALSE = "ok", "missed", "false"
_BETWEEN = re.compile(r"[\W_]+")
_WORDS: Mapping[str, str] = {
    **dict.fromkeys(
        ("found", "hit", "touched", "touch", "contact", "triggered", "latched", "tripped"), _OK
    ),
    **dict.fromkeys(("pass", "passed", "success", "successful", "good", "done", "yes"), _OK),
    **dict.fromkeys(("miss", "no", "failed", "fail", "failure", "timeout", "timed out"), _MISSED),
    **dict.fromkeys(("no hit", "no touch", "no contact", "no trigger", "no latch"), _MISSED),
    **dict.fromkeys(
        ("not found", "not touched", "not triggered", "not latched", "not tripped"), _MISSED
    ),
    **dict.fromkeys(("false trigger", "false touch", "already triggered", "pretriggered"), _FALSE),
}
_TWO_ANSWERS: Mapping[str, Mapping[str, str]] = {
    "true": {"true": _OK, "false": _MISSED},
    "1": {"1": _OK, "0": _MISSED},
    "0": {"1": _OK, "0": _MISSED},
}
"""Of columns that say whether there was a touch; `false` is no false trigger beside `true`."""


def as_status(cells: Sequence[str], found: Imported) -> list[str]:
    """Give cells in the words of a campaign, and say which were put in its words.

    What is no known word stays as it is.
    """
    words = [" ".join(_BETWEEN.sub(" ", tidy(cell)).lower().split()) for cell in cells]
    known = next((_TWO_ANSWERS[word] for word in words if word in _TWO_ANSWERS), _WORDS)
    read = {
        cell: known[word]
        for cell, word in zip(cells, words, strict=True)
        if word in known and word != known[word]
    }
    if read:
        found.assumed.append(
            "status: " + ", ".join(f"{quoted(c.strip())} counts as {s}" for c, s in read.items())
        )
    return [read.get(cell, cell) for cell in cells]
