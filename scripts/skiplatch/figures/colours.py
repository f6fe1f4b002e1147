"""The colours of pictures and pages, in a light and a dark scheme.

They stand apart from what draws, which takes long to load: a page without pictures does without.
"""

PAPER = "#fffffe"
INK = "#1f2328"
MUTED = "#59636e"
GRID = "#dfe3e8"
SKIP = "#0a64c8"
SKIP_LIGHT = "#a9cdf5"
PLC = "#b84a00"
PLC_LIGHT = "#f6c59d"
THIRD = "#6f42c1"
FOURTH = "#1a7f37"
RED = "#c9252d"

DARK = {
    PAPER: "#0d1117",
    INK: "#e6edf3",
    MUTED: "#9aa4af",
    GRID: "#262c34",
    SKIP: "#6cb2ff",
    SKIP_LIGHT: "#1d4470",
    PLC: "#ff9f4a",
    PLC_LIGHT: "#6b3a12",
    THIRD: "#c4a5ff",
    FOURTH: "#56d364",
    RED: "#ff7b72",
}

VARIABLES = {
    "paper": PAPER,
    "ink": INK,
    "muted": MUTED,
    "grid": GRID,
    "skip": SKIP,
    "skip-light": SKIP_LIGHT,
    "plc": PLC,
    "plc-light": PLC_LIGHT,
    "third": THIRD,
    "fourth": FOURTH,
    "red": RED,
}
"""The page's variables of style, and the colours of the light scheme that they stand for."""
