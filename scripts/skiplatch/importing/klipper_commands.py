"""Commands of Klipper, and what says that one moved Z or the bed."""

import re

from skiplatch.campaign.session_names import HOMING
from skiplatch.importing.console import ADJUSTING, TURNING
from skiplatch.numbers import NUMBER

PROBE_SPEED = re.compile(rf"\bPROBE_SPEED\s*=\s*({NUMBER})", re.IGNORECASE)
COMMAND = re.compile(
    r"^(?:N\d+\s*)?(?:G\d+\b.*|(?:PROBE|[A-Z]\w*_\w+)(?:\s+\w+=\S+)*\s*(?:[;#*].*)?)$",
    re.IGNORECASE,
)
MOVED = {
    HOMING: re.compile(
        r"^(?:(?:N\d+\s*)?G28|Start printer at|Klipper state: Ready|Touch home at)\b",
        re.IGNORECASE,
    ),
    ADJUSTING: re.compile(
        r"Making the following (?:Z|Z tilt|gantry) adjustments|Probed points range", re.IGNORECASE
    ),
    TURNING: re.compile(r"\(base\)\s*:|Then run ACCEPT, ADJUSTED", re.IGNORECASE),
}
"""What begins a session: a homing or restart; what QUAD_GANTRY_LEVEL and Z_TILT_ADJUST print as
they move Z; what SCREWS_TILT_CALCULATE and BED_SCREWS_ADJUST print before somebody turns screws."""
TOOL = re.compile(r"^(?:N\d+\s*)?(T\d+|M6|ACTIVATE_EXTRUDER)\b([^:/]*)$", re.IGNORECASE)
