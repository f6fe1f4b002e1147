"""The table of the catalogue's effects, each with its forms."""

from collections.abc import Mapping
from dataclasses import dataclass

from tests.withheld import geometry, inputs, latch, motion, position, probe, scan
from tests.withheld.forms import Draw, Form, Maker

BOTH = frozenset({"skip", "plc"})
SKIP = frozenset({"skip"})
PLC = frozenset({"plc"})


@dataclass(frozen=True)
class Effect:
    """One effect of the catalogue.

    Attributes:
        stage: Where in the chain.
        paths: Which input paths it touches.
        forms: Its forms by name.
        on_bench: Whether a bench has what it needs; a machine always does.
        needs: Columns without which it cannot be told from noise.
    """

    stage: str
    paths: frozenset[str]
    forms: Mapping[str, Maker]
    on_bench: bool = False
    needs: frozenset[str] = frozenset()


SENSE = frozenset({"axis", "sign"})
PLACE = frozenset({"axis", "sign", "position_mm"})
WARMTH = frozenset({"axis", "sign", "temp_c"})
TABLE = frozenset({"rotary_deg"})
STAMPS = frozenset({"latch_us"})
REPORTS = frozenset({"latch_us", "report_us"})

# In the order of the chain.
EFFECTS: Mapping[str, Effect] = {
    "feed_error": Effect("motion", BOTH, motion.FEED_ERROR),
    "unfinished_acceleration": Effect("motion", BOTH, motion.UNFINISHED_ACCELERATION),
    "pretravel_lobing": Effect("probe", BOTH, probe.PRETRAVEL_LOBING),
    "trigger_delay": Effect("probe", BOTH, probe.TRIGGER_DELAY),
    "link_slotting": Effect("link", BOTH, probe.LINK_SLOTTING),
    "link_retry": Effect("link", BOTH, probe.LINK_RETRY),
    "input_filter": Effect("input", BOTH, inputs.INPUT_FILTER, on_bench=True),
    "contact_bounce": Effect("input", BOTH, inputs.CONTACT_BOUNCE, on_bench=True),
    "lost_trigger": Effect("input", BOTH, inputs.LOST_TRIGGER, on_bench=True),
    "isr_latency": Effect("latch", SKIP, latch.ISR_LATENCY, on_bench=True),
    "isr_blocking": Effect("latch", SKIP, latch.ISR_BLOCKING, on_bench=True),
    "timer_quantisation": Effect(
        "latch", BOTH, latch.TIMER_QUANTISATION, on_bench=True, needs=STAMPS
    ),
    "timer_drift": Effect("latch", BOTH, latch.TIMER_DRIFT, on_bench=True, needs=STAMPS),
    "scan_period": Effect("scan", PLC, scan.SCAN_PERIOD, on_bench=True),
    "scan_jitter": Effect("scan", PLC, scan.SCAN_JITTER, on_bench=True),
    "scan_overrun": Effect("scan", PLC, scan.SCAN_OVERRUN, on_bench=True),
    "input_image_delay": Effect("scan", PLC, scan.INPUT_IMAGE_DELAY, on_bench=True),
    "scan_phase_lock": Effect("scan", PLC, scan.SCAN_PHASE_LOCK, on_bench=True),
    "servo_hold": Effect("position", BOTH, position.SERVO_HOLD, on_bench=True),
    "following_error": Effect("position", BOTH, position.FOLLOWING_ERROR, on_bench=True),
    "backlash": Effect("position", BOTH, geometry.BACKLASH, needs=SENSE),
    "transmission_error": Effect("position", BOTH, geometry.TRANSMISSION_ERROR, needs=PLACE),
    "scale_error": Effect("position", BOTH, geometry.SCALE_ERROR, needs=PLACE),
    "encoder_quantisation": Effect("position", BOTH, position.ENCODER_QUANTISATION, on_bench=True),
    "thermal_drift": Effect("position", BOTH, geometry.THERMAL_DRIFT, needs=WARMTH),
    "rotary_pivot": Effect("position", BOTH, geometry.ROTARY_PIVOT, needs=TABLE),
    "report_delay": Effect("report", BOTH, inputs.REPORT_DELAY, on_bench=True, needs=REPORTS),
}


def draw_form(effect: str, draw: Draw) -> tuple[str, Form]:
    """Draw one of an effect's forms and its parameters."""
    forms = EFFECTS[effect].forms
    name = list(forms)[int(draw.rng.integers(len(forms)))]
    return name, forms[name](draw)
