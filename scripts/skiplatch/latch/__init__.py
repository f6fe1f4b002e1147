"""How well each input path latches: error distributions, pulses, the figures of the seed."""

from skiplatch.latch.effort import Effort
from skiplatch.latch.paths import PathResult, Results, examine
from skiplatch.latch.text import as_json, as_text

__all__ = ["Effort", "PathResult", "Results", "as_json", "as_text", "examine"]
