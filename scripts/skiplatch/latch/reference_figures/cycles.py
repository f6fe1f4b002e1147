"""The document's cycle times, and what two touches win.

The document prints two cycle times and no model. A trapezoid yields both: stand-off 5 mm, 3 m/s²,
2 ms of reaction. The back-off was then fitted to the second time, and is shorter than usual.
"""

from dataclasses import replace

import numpy as np

from skiplatch import statistics
from skiplatch.campaign import InputPath
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import latch_errors
from skiplatch.latch.probing import Probing
from skiplatch.latch.reference_figures.model import (
    FAST_MM_MIN,
    IDEAL,
    SLOW_MM_MIN,
    ReferenceFigure,
    Remark,
    certain,
    range_um,
)
from skiplatch.simulator.rig import Controller
from skiplatch.statistics import Interval, proportion

STAND_OFF_MM = 5.0
FITTED_BACK_OFF_MM = 0.0849
TYPICAL_BACK_OFF_MM = 0.25
# The model knows no bounces to be waited for.
ONE_TOUCH = Controller(overtravel_mm=2.0, reaction_us=2000.0, holdoff_us=0.0)


def cycle(path: InputPath, feed_mm_min: float, back_off_mm: float | None = None) -> Probing:
    """Probe as the model behind the cycle times does; two touches if there is a back-off."""
    controller = ONE_TOUCH
    if back_off_mm is not None:
        controller = replace(
            ONE_TOUCH, two_touches=True, back_off_mm=back_off_mm, fast_feed_mm_min=FAST_MM_MIN
        )
    return Probing(
        nominal=IDEAL,
        controller=controller,
        path=path,
        feed_mm_min=feed_mm_min,
        approach_mm=STAND_OFF_MM,
    )


def cycle_s(probing: Probing) -> float:
    """Play one cycle and give its time."""
    return float(probing.play(probing.at(np.zeros(1)), seed=0).cycle_s[0, 0])


def cycle_figures() -> list[ReferenceFigure]:
    """Give the cycle times of one touch and of two."""
    one = cycle_s(cycle(InputPath.SKIP, FAST_MM_MIN))
    two = cycle_s(cycle(InputPath.SKIP, SLOW_MM_MIN, FITTED_BACK_OFF_MM))
    model = "model, not unique: no delay at the input, stand-off 5 mm, 3 m/s², reaction 2 ms"
    fitted = f"the same; back-off {FITTED_BACK_OFF_MM} mm, fitted to this figure"
    return [
        ReferenceFigure(
            name=name,
            unit="s",
            document=document,
            last_place=0.0005,
            simulated=certain(simulated),
            note=note,
        )
        for name, document, simulated, note in (
            ("cycle, one touch at 3000 mm/min", 0.254, one, model),
            ("cycle, two touches, 3000 then 30 mm/min", 0.444, two, fitted),
            ("cost of the second touch", 0.19, two - one, fitted),
        )
    ]


def two_touch_figures(one_touch_um: Interval, effort: Effort) -> list[ReferenceFigure]:
    """Give the range of two touches on the polled input, and how much smaller it is."""
    errors = latch_errors(cycle(InputPath.PLC, SLOW_MM_MIN, TYPICAL_BACK_OFF_MM), effort)
    small = range_um(errors)
    factor = Interval(
        one_touch_um.value / small.value,
        one_touch_um.low / small.high,
        one_touch_um.high / small.low,
    )
    return [
        ReferenceFigure(
            name=name,
            unit=unit,
            document=document,
            simulated=simulated,
            note=f"back-off {TYPICAL_BACK_OFF_MM} mm",
        )
        for name, unit, document, simulated in (
            ("range, two touches, 4 ms PLC scan, 3000 then 30 mm/min", "µm", 2.0, small),
            ("one touch at 3000 mm/min has a larger range by a factor of", "", 100.0, factor),
        )
    ]


def typical_back_off() -> Remark:
    """Tell what a back-off that was not fitted would cost."""
    simulated = cycle_s(cycle(InputPath.SKIP, SLOW_MM_MIN, TYPICAL_BACK_OFF_MM))
    return Remark(
        f"cycle, two touches, typical back-off of {TYPICAL_BACK_OFF_MM} mm",
        "s",
        certain(simulated),
        "0.444 s needs a short back-off",
    )


def short_back_off(effort: Effort) -> Remark:
    """Tell how often the fitted back-off is too short for the polled input."""
    probing = cycle(InputPath.PLC, SLOW_MM_MIN, FITTED_BACK_OFF_MM)
    played = probing.outcomes(effort)
    failed = sum(int(np.count_nonzero(outcomes.error)) for outcomes in played)
    return Remark(
        f"failing cycles, two touches, 4 ms PLC scan, back-off {FITTED_BACK_OFF_MM} mm",
        "%",
        proportion(failed, effort.touches).scaled(100.0),
        "the first latch is up to 0.2 mm late, so the probe stays deflected",
    )


def polled_cycle(effort: Effort) -> Remark:
    """Tell what two touches take where every step waits for a scan."""
    probing = cycle(InputPath.PLC, SLOW_MM_MIN, TYPICAL_BACK_OFF_MM)
    played = probing.latched(effort)
    times_s = np.concatenate([outcomes.cycle_s[0] for outcomes in played])
    return Remark(
        f"mean cycle, two touches, 4 ms PLC scan, back-off {TYPICAL_BACK_OFF_MM} mm",
        "s",
        statistics.mean(float(times_s.mean()), float(times_s.std()), len(times_s)),
        "steps wait for scans, but the late first latch shortens the slow way",
    )
