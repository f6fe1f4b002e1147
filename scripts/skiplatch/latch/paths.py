"""All there is to know of how an input path latches."""

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass

from skiplatch.campaign import InputPath, Nominal
from skiplatch.latch.effort import Effort
from skiplatch.latch.errors import LatchErrors, latch_errors
from skiplatch.latch.probing import one_touch
from skiplatch.latch.pulses import Pulses, default_widths_us, pulse_response
from skiplatch.workers import NOT_KEPT, Keeper

MOST_PULSES = 100_000  # of each width


@dataclass(frozen=True, slots=True)
class PathResult:
    """What was found out about one path."""

    errors: LatchErrors
    pulses: Pulses


Results = Mapping[InputPath, PathResult]


def examine(
    rig: Nominal,
    path: InputPath,
    feed_mm_min: float,
    effort: Effort,
    executor: Executor | None = None,
    keeper: Keeper = NOT_KEPT,
) -> PathResult:
    """Find out how far off a path latches and what it makes of short pulses.

    Args:
        rig: What is believed of the rig.
        path: Which.
        feed_mm_min: Of the measuring touch.
        effort: How many touches are played.
        executor: Workers that play them; else they are played here. The result is the same.
        keeper: Keeps the chunks that workers have played.
    """
    probing = one_touch(rig, path, feed_mm_min)
    pulses = effort.at_most(MOST_PULSES)
    return PathResult(
        errors=latch_errors(probing, effort, executor, keeper),
        pulses=pulse_response(probing, default_widths_us(rig), pulses),
    )
