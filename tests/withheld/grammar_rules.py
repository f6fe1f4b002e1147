"""What is no stranger, by its words: forms that are in effect one of the catalogue's.

What these rules do not hold, the figures of `grammar_apart` do: a rule is here if the catalogue's
effect has that form by what it is (or by one of the forms in this folder), so that whoever names it
is right, however well a straight line or a wave fits.
"""

from collections.abc import Set
from dataclasses import dataclass

from tests.withheld.grammar_places import LATE
from tests.withheld.grammar_shapes import Carrier

SHIFT, SCATTER, NOW_AND_THEN = Carrier.SHIFT, Carrier.SCATTER, Carrier.NOW_AND_THEN
ALL = frozenset(Carrier)
TIMED = frozenset({"time", "number", "walk", "cycle", "two states"})
DELAYS = LATE | {"pretravel"}
LENGTHS = frozenset({"position", "coordinate", "pretravel"})
TRENDS = frozenset({"straight", "threshold", "saturating", "power", "hat"})


@dataclass(frozen=True)
class Rule:
    """A set of forms that are no strangers.

    Attributes:
        places: Where.
        causes: Going with one of these.
        carriers: In one of these ways.
        reason: Which effect of the catalogue they are, and why.
        courses: Over one of these courses; None for any.
    """

    places: Set[str]
    causes: Set[str]
    carriers: Set[Carrier]
    reason: str
    courses: Set[str] | None = None

    def holds(self, place: str, cause: str, carrier: Carrier, course: str) -> bool:
        """Tell whether it excludes a form."""
        return (
            place in self.places
            and cause in self.causes
            and carrier in self.carriers
            and (self.courses is None or course in self.courses)
        )


RULES = (
    Rule(LATE, {"feed"}, {NOW_AND_THEN}, "contact_bounce: slow touches bounce more often"),
    Rule(
        LATE | {"scan", "image", "report"},
        TIMED,
        {SCATTER, NOW_AND_THEN},
        "retries, bounces, masked interrupts, overruns and busy buses come in spells",
    ),
    Rule(
        LATE | {"scan", "image", "report"},
        {"two states"},
        {SHIFT},
        "link_retry, isr_blocking, scan_overrun, report_delay: in spells, nearly every touch",
    ),
    Rule(
        LATE,
        {"time", "number"},
        {SHIFT},
        "trigger_delay of a battery that sags, or a delay that begins or ends",
        TRENDS,
    ),
    Rule(
        {"scan"},
        TIMED,
        {SHIFT},
        "scan_period: scans run ahead and lag again; or a period that begins or ends",
    ),
    Rule({"image"}, TIMED, {SHIFT}, "input_image_delay that comes and goes"),
    Rule({"report"}, TIMED, {SHIFT}, "report_delay: what else is on the bus has its own times"),
    Rule(
        {"feed", "acceleration"},
        {"feed", "approach", "axis", "sign", *TIMED},
        ALL,
        "feed_error: an override that is turned, a limit, an offset; unfinished_acceleration",
    ),
    Rule(
        LENGTHS,
        {"position"},
        {SHIFT},
        "scale_error, bent a little; transmission_error of some period",
        frozenset({"straight", "power", "wave"}),
    ),
    Rule(
        LENGTHS,
        {"temperature"},
        {SHIFT},
        "thermal_drift, of the axis or of the probe on it",
        frozenset({"straight"}),
    ),
    Rule(LENGTHS, {"sign"}, {SHIFT}, "backlash"),
    Rule(LENGTHS, {"axis"}, {SHIFT}, "the datum of an axis, which is unknown"),
    Rule(LATE, {"axis"}, {SHIFT}, "following_error, which every axis has of its own"),
    Rule(
        LATE,
        {"feed"},
        {SHIFT},
        "following_error that feed-forward bends",
        frozenset({"straight", "power", "saturating"}),
    ),
    Rule(
        LENGTHS,
        {"feed"},
        {SHIFT},
        "trigger_delay, input_filter, following_error: an error with the feed",
        frozenset({"straight"}),
    ),
    Rule(
        {"start", "clock"},
        {"time", "number"},
        {SHIFT},
        "timer_drift, which may age",
        frozenset({"straight", "power", "saturating"}),
    ),
)


def excluded(place: str, cause: str, carrier: Carrier, course: str) -> str | None:
    """Give the reason why a form is no stranger, or None if it is one by its words."""
    return next((r.reason for r in RULES if r.holds(place, cause, carrier, course)), None)
