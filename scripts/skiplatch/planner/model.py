"""What a probing strategy costs in time and wins in certainty: the trapezoid model.

Every motion accelerates to its feed and decelerates from it at one acceleration; that of a touch
starts from rest, meets the surface at its feed, and stops after latency and reaction. With
D the stand-off and l what lies between contact and deceleration, one touch at v takes
T = 2·D/v + 2·l + 3·v/a.
"""

import math
from dataclasses import dataclass, replace

from skiplatch.campaign import InputPath, Nominal
from skiplatch.latch.probing import Probing
from skiplatch.latch.reaction import Reaction, reaction_of
from skiplatch.simulator.rig import Controller
from skiplatch.units import S_PER_MIN, UM_PER_MM, US_PER_S

ROUNDING = 1.0 + 1e-9  # of the computer: what exceeds a limit by no more does not exceed it


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """A machine, and what may be asked of it."""

    nominal: Nominal
    path: InputPath
    stand_off_mm: float
    reaction_us: float
    """Latch to the start of the deceleration."""
    overtravel_mm: float
    """How far the probe may be driven past the surface."""
    least_feed_mm_min: float
    greatest_feed_mm_min: float
    least_back_off_mm: float
    margin_mm: float
    """Between the end of the back-off and where the second touch may begin to be triggered."""

    @property
    def input(self) -> Reaction:
        """How late the latch may be."""
        return reaction_of(self.nominal, self.path)

    @property
    def accel_mm_s2(self) -> float:
        """Acceleration, and deceleration, of every motion."""
        return self.nominal.axis.accel_mm_s2

    @property
    def wait_s(self) -> float:
        """Mean wait of a step for its turn: half a scan of a PLC, none where a task is woken."""
        return self.nominal.plc.scan_us / US_PER_S / 2.0 if self.path == InputPath.PLC else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Strategy:
    """How to probe: with one touch, or with a fast one before the measuring touch."""

    measuring_feed_mm_min: float
    fast_feed_mm_min: float | None = None
    """Of the first of two touches, of back-off and return; None for one touch."""
    back_off_mm: float | None = None
    """From the first latch back; None for one touch."""

    def probing(self, limits: Limits) -> Probing:
        """Give the set-up that plays this strategy."""
        controller = Controller(
            overtravel_mm=limits.overtravel_mm,
            reaction_us=limits.reaction_us,
            holdoff_us=0.0,  # the model knows no bounces to be waited for
        )
        if self.fast_feed_mm_min is not None and self.back_off_mm is not None:
            controller = replace(
                controller,
                two_touches=True,
                fast_feed_mm_min=self.fast_feed_mm_min,
                back_off_mm=self.back_off_mm,
            )
        return Probing(
            nominal=limits.nominal,
            controller=controller,
            path=limits.path,
            feed_mm_min=self.measuring_feed_mm_min,
            approach_mm=limits.stand_off_mm,
        )


def range_um(limits: Limits, feed_mm_min: float) -> float:
    """Full range of the measured position: reaction width × feed, and one count of the axis."""
    return _late_um(limits, feed_mm_min) + limits.nominal.axis.resolution_um


def standard_uncertainty_um(limits: Limits, feed_mm_min: float) -> float:
    """Standard deviation of the measured position, where latency and rounding are uniform."""
    widths = (_late_um(limits, feed_mm_min), limits.nominal.axis.resolution_um)
    return math.hypot(*widths) / math.sqrt(12.0)


def feed_for_range(limits: Limits, wanted_um: float) -> float:
    """Turn `range_um` round: give the feed in mm/min. Where it is not above 0 there is none."""
    late_mm = (wanted_um - limits.nominal.axis.resolution_um) / UM_PER_MM
    if limits.input.width_us == 0.0:
        return math.copysign(math.inf, late_mm)
    return late_mm / (limits.input.width_us / US_PER_S) * S_PER_MIN


def overtravel_mm(limits: Limits, feed_mm_min: float) -> float:
    """From the contact to standstill at worst: s = v·t + v²/2a, t with latency and reaction."""
    v = speed(feed_mm_min)
    late_s = (limits.input.latest_us + limits.reaction_us) / US_PER_S
    return v * late_s + v**2 / (2.0 * limits.accel_mm_s2)


def safe_feed_mm_min(limits: Limits) -> float:
    """Give the feed whose overtravel is just allowed, `overtravel_mm` turned round."""
    late_s = (limits.input.latest_us + limits.reaction_us) / US_PER_S
    root_s = math.sqrt(late_s**2 + 2.0 * limits.overtravel_mm / limits.accel_mm_s2)
    return S_PER_MIN * 2.0 * limits.overtravel_mm / (late_s + root_s)


def ramp_feed_mm_min(limits: Limits) -> float:
    """Give the feed that is just reached within the stand-off."""
    return S_PER_MIN * math.sqrt(2.0 * limits.accel_mm_s2 * limits.stand_off_mm)


def back_off_mm(limits: Limits, fast_mm_min: float, measuring_mm_min: float) -> float:
    """Give the back-off that clears the latest first latch, with room to reach the second feed."""
    late_mm = speed(fast_mm_min) * limits.input.latest_us / US_PER_S
    ramp_mm = speed(measuring_mm_min) ** 2 / (2.0 * limits.accel_mm_s2)
    return max(limits.least_back_off_mm, late_mm + ramp_mm + limits.margin_mm)


def fast_feed_for_stand_off(limits: Limits) -> float:
    """Give the greatest feed of the first touch whose back-off fits into the stand-off."""
    room_mm = limits.stand_off_mm - back_off_mm(limits, 0.0, limits.least_feed_mm_min)
    if limits.input.latest_us == 0.0:
        return math.inf
    return (room_mm / (limits.input.latest_us / US_PER_S)) * S_PER_MIN


def measuring_feed_for_stand_off(limits: Limits, fast_mm_min: float) -> float:
    """Give the greatest feed of the second touch whose back-off fits into the stand-off."""
    late_mm = speed(fast_mm_min) * limits.input.latest_us / US_PER_S
    room_mm = limits.stand_off_mm - late_mm - limits.margin_mm
    return S_PER_MIN * math.sqrt(2.0 * limits.accel_mm_s2 * room_mm)


@dataclass(frozen=True, slots=True)
class Leg:
    """One motion of a cycle, from rest to rest, a trapezoid of the feed over time.

    Attributes:
        feed_mm_min: That is reached; above 0 towards the surface.
        time_s: From rest to rest.
        contact_s: When the surface is met, from the start of the leg; None without a touch.
    """

    feed_mm_min: float
    time_s: float
    contact_s: float | None = None


def legs(limits: Limits, strategy: Strategy) -> list[Leg]:
    """Give the motions of a whole cycle, until the axis is back at the start; mean times."""
    measuring = strategy.measuring_feed_mm_min
    if strategy.fast_feed_mm_min is None or strategy.back_off_mm is None:
        return [
            _touch(limits, limits.stand_off_mm, measuring),
            _return(limits, measuring, measuring),
        ]
    fast = strategy.fast_feed_mm_min
    late_mm = speed(fast) * limits.input.mean_us / US_PER_S
    return [
        _touch(limits, limits.stand_off_mm, fast),
        _move(limits, strategy.back_off_mm + _stop_mm(limits, fast), fast),
        _touch(limits, strategy.back_off_mm - late_mm, measuring),
        _return(limits, measuring, fast),
    ]


def cycle_s(limits: Limits, strategy: Strategy) -> float:
    """Mean time of a whole cycle: of its motions, each of which waits for its turn."""
    return sum(leg.time_s + limits.wait_s for leg in legs(limits, strategy))


def speed(feed_mm_min: float) -> float:
    """Give a feed in mm/s."""
    return feed_mm_min / S_PER_MIN


def _late_um(limits: Limits, feed_mm_min: float) -> float:
    return speed(feed_mm_min) * limits.input.width_us / US_PER_S * UM_PER_MM


def _touch(limits: Limits, way_mm: float, feed_mm_min: float) -> Leg:
    """Accelerate, meet the surface, latch, stop."""
    v = speed(feed_mm_min)
    approach_s = way_mm / v + v / (2.0 * limits.accel_mm_s2)
    late_s = (limits.input.mean_us + limits.reaction_us) / US_PER_S
    return Leg(feed_mm_min, approach_s + late_s + v / limits.accel_mm_s2, approach_s)


def _stop_mm(limits: Limits, feed_mm_min: float) -> float:
    """From the latch to standstill."""
    v = speed(feed_mm_min)
    return v * limits.reaction_us / US_PER_S + v**2 / (2.0 * limits.accel_mm_s2)


def _return(limits: Limits, measuring_mm_min: float, feed_mm_min: float) -> Leg:
    """From standstill after the measuring touch to the start."""
    late_mm = speed(measuring_mm_min) * limits.input.mean_us / US_PER_S
    way_mm = limits.stand_off_mm + late_mm + _stop_mm(limits, measuring_mm_min)
    return _move(limits, way_mm, feed_mm_min)


def _move(limits: Limits, way_mm: float, feed_mm_min: float) -> Leg:
    """Away from the surface, from rest to rest."""
    v = min(speed(feed_mm_min), math.sqrt(limits.accel_mm_s2 * way_mm))
    return Leg(-v * S_PER_MIN, way_mm / v + v / limits.accel_mm_s2)
