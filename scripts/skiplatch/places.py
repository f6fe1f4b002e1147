"""Where the package finds what is not Python: library, headers, samples, bus frames."""

from pathlib import Path

_PACKED = Path(__file__).parent / "tree"
_CHECKOUT = Path(__file__).parents[2]

ROOT = _PACKED if _PACKED.is_dir() else _CHECKOUT
"""The checkout, or the same tree as the wheel brings it: both have the same paths below this."""
SAMPLES = ROOT / "scripts" / "samples"
"""Campaigns to try the program on."""
