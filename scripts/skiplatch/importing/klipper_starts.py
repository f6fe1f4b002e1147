"""Where a touch of Klipper begins, so that the way to it is known.

PROBE_ACCURACY says where the toolhead stands. Newer versions print of a touch where the nozzle
would contact the bed: that is z_offset below the toolhead at the trigger, so the two differ by it.
"""

import re

from skiplatch.importing.klipper_config import Config
from skiplatch.importing.model import Imported

_OF_BED = re.compile(r"bed will contact at z=", re.IGNORECASE)


class Starts:
    """Follows where PROBE_ACCURACY begins, and where the touch before was."""

    def __init__(self) -> None:
        self._toolhead: float | None = None
        self._last: float | None = None
        self._untold = 0

    def test_begins(self, z: float) -> None:
        """Take where the toolhead stands."""
        self._toolhead = z

    def command_ends(self) -> None:
        """Forget it."""
        self._toolhead = None

    def failed(self) -> None:
        """Take that the attempt before had no touch."""
        self._last = None

    def touched(self, text: str, z: float, retract: float | None, config: Config) -> float | None:
        """Take a touch, and give where its move began, in the z of touches.

        Args:
            text: What the log says of it.
            z: Of it.
            retract: How far above the touch before the next one begins; a tap says 0.
            config: Tells the offset, where the log has it.
        """
        toolhead, last = self._toolhead, self._last
        self._toolhead, self._last = None, z
        if toolhead is None:
            return last + retract if last is not None and retract else None
        if not _OF_BED.search(text):
            return toolhead
        offset = config.z_offset()
        self._untold += offset is None
        return None if offset is None else toolhead - offset

    def say(self, found: Imported) -> None:
        """Say which ways are not known."""
        if self._untold:
            found.assumed.append(
                "the way to the first touch of a PROBE_ACCURACY is not known without the probe's "
                f"z_offset, which klippy.log has: {self._untold}"
            )
