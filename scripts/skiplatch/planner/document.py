"""The machine of the reference document on probing strategies, as its cycle times are modelled."""

from skiplatch.campaign import InputPath
from skiplatch.latch.reference_figures.cycles import ONE_TOUCH, STAND_OFF_MM
from skiplatch.latch.reference_figures.model import FAST_MM_MIN, IDEAL
from skiplatch.planner.model import Limits

DOCUMENT_LIMITS = Limits(
    nominal=IDEAL,
    path=InputPath.PLC,
    stand_off_mm=STAND_OFF_MM,
    reaction_us=ONE_TOUCH.reaction_us,
    overtravel_mm=ONE_TOUCH.overtravel_mm,
    least_feed_mm_min=3.0,
    greatest_feed_mm_min=FAST_MM_MIN,
    least_back_off_mm=0.05,
    margin_mm=0.02,
)
