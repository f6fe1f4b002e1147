"""A recorded campaign held against the nominal simulation of the same conditions."""

from skiplatch.comparison.compare import compare
from skiplatch.comparison.model import DEFAULT_ALPHA, Cell, CellGap, Comparison, Missed
from skiplatch.comparison.text import as_json, as_text

__all__ = [
    "DEFAULT_ALPHA",
    "Cell",
    "CellGap",
    "Comparison",
    "Missed",
    "as_json",
    "as_text",
    "compare",
]
