"""What a report says beside the figures: what it looks like, and what the touches cannot tell."""

from collections.abc import Collection, Sequence

import numpy as np

from skiplatch.campaign import Axis, Campaign, InputPath
from skiplatch.campaign.telling import hides_backlash
from skiplatch.diagnosis.fit.beliefs import REPEATABILITY
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.verdict import Failure, Verdict
from skiplatch.errors import InputError
from skiplatch.repeatability import repeatability
from skiplatch.surface_fit import OUTLYING_STEPS
from skiplatch.tables import number
from skiplatch.ways import Ways

FIRST_OFF = 3.0
"""Halves of its 95 % interval from which on a first touch is off: some six standard errors."""
QUARTER_DEG = 90.0
LONGEST_SERIES = 2_000
"""Touches of a campaign up to which series are looked at: a line for each surface takes room."""


def notes(
    scene: Scene,
    verdict: Verdict,
    failures: Sequence[Failure],
    mattering: Sequence[Left],
    named: Collection[str] = (),
    closest: Collection[str] = (),
) -> list[str]:
    """Say what it looks like, what kept it from being explained, and what cannot be told.

    Args:
        scene: The touches.
        verdict: What the diagnosis came to.
        failures: The rules that were missed.
        mattering: What the believed chain leaves that matters.
        named: Ids of the effects that are named.
        closest: Ids of those that came closest and were refused.
    """
    found: list[str] = []
    if verdict is Verdict.UNKNOWN and mattering:
        found.append(_looks_like(mattering))
    if verdict is not Verdict.EXPLAINED:
        found += _missed(Ways.of(scene.touches), failures, closest)
    for path in InputPath:
        found += _of_path(scene, path)
    found += _of_stamps(scene)
    found += _unstated(scene)
    if scene.touches.turns.any():
        found.append(
            "Of axes A, B and C degrees stand for millimetres: 1 µm is 0.001° or 3.6″, "
            "1 mm/min is 1 deg/min."
        )
    if "backlash" in named and _is_along_axes(scene):
        found.append(
            "Touches along the axes alone: a stylus off its centre looks like backlash; "
            "touch at azimuths between them."
        )
    if "backlash" in named and scene.datum_groups is not None:
        found.append(
            "Coordinates whose zero is off by half of the backlash read the same: far in one sense "
            "and near in the other. So where a surface lies along its approach is not known, the "
            "sign of the backlash is not either."
        )
    found += _untold(scene)
    if verdict is Verdict.NO_GAP and scene.datum_groups is not None and scene.datum_u_um is None:
        found.append(
            "An offset that all touches of a datum share may be of any size: it counts as where "
            "the surface lies ([datum] of nominal.toml)."
        )
    return found


def _looks_like(mattering: Sequence[Left]) -> str:
    """Say how most of a gap shows, and what tells of it, which leads to its cause."""
    first = mattering[0]
    telling = next((left for left in mattering if left.is_of(first) and left.is_predicted), first)
    ways = "; ".join(dict.fromkeys((first.looks_like, telling.looks_like)))
    return f"What it looks like: {first.observable}, {first.path} path: {ways}."


def _missed(ways: Ways, failures: Sequence[Failure], closest: Collection[str]) -> list[str]:
    """Say which rules kept a gap from being explained, and what came closest but was refused."""
    if not closest:
        return [f"Not explained: {ways.relabelled(failure.words)}." for failure in failures]
    why = "; ".join(f"{ways.relabelled(one.words)} (rule {one.rule})" for one in failures)
    return [f"Closest, but no finding: {' + '.join(closest)}, refused because {why}."]


def _is_along_axes(scene: Scene) -> bool:
    """Tell whether a probe touched along axes alone, as far as azimuths were recorded."""
    azimuths_deg = scene.touches.alpha_deg[~np.isnan(scene.touches.alpha_deg)]
    return scene.is_machine and not np.any(np.rint(azimuths_deg) % QUARTER_DEG)


def _of_stamps(scene: Scene) -> list[str]:
    """Say what stood in for stamps, or what cannot be told without."""
    if scene.nominal.arrival_us is not None:
        return ["No latch_us: arrivals of reports are held against the latch that positions tell."]
    if scene.has_stamps.any():
        return []
    found = ["No latch_us: what shifts time and what shifts length look alike."]
    if not np.isnan(scene.touches.report_us).all():
        lacking = "report_us without latch_us, and no position or no belief of how long they take"
        found.append(f"{lacking}: how late they come was not looked at.")
    return found


def _unstated(scene: Scene) -> list[str]:
    """Say what was taken from the touches, as nobody stated it."""
    scatter_um = scene.nominal.probe.repeatability_um
    if REPEATABILITY not in scene.nominal.unknown or scatter_um == 0.0:
        return []
    scatter = f"{number(scatter_um, 3)} µm is what touches scatter by"
    return [f"probe.repeatability_um is not stated: {scatter}. No other scatter is told from it."]


def _of_path(scene: Scene, path: InputPath) -> list[str]:
    """Say which touches of a path have no latch, or no contact; or that it has none."""
    here, name = scene.touches.path == path, path.name.lower()
    if not here.any():
        return [f"No touches on the {name} path: nothing can be said of it."]
    missed, false = (
        int((rows & here).sum()) for rows in (scene.touches.missed, scene.touches.false)
    )
    said = [f"Missed on the {name} path: {missed} of {int(here.sum())} touches."] if missed else []
    return said + [f"Triggers without a contact on the {name} path: {false}."] * (false > 0)


def _untold(scene: Scene) -> list[str]:
    """Say what the touches cannot tell, for want of variety."""
    touches = scene.touches
    found: list[str] = []
    if not scene.is_machine:
        return found
    if len(np.unique(touches.feed_mm_min)) == 1:
        found.append("One feed: a delay and a length look alike; touch at a second feed.")
    one_sense = [
        Axis(axis).name if axis >= 0 else "the axis"  # nobody wrote down which
        for axis in np.unique(touches.axis).tolist()
        if len(np.unique(scene.sign[touches.axis == axis])) == 1
    ]
    if one_sense:
        axes = ", ".join(one_sense)
        found.append(f"One sense of motion along {axes}: no backlash can be seen there.")
    if hides_backlash(scene.nominal, touches):
        found.append(
            "No surface, or place that surfaces share, is met in both senses, and each may lie "
            "anywhere ([datum] of nominal.toml): a backlash looks like where they lie."
        )
    return found


def first_touch(campaign: Campaign) -> list[str]:
    """Say by how much the first touch of a series is off those that follow it, if it clearly is."""
    if len(campaign.touches) > LONGEST_SERIES:
        return []
    try:
        found = repeatability(campaign)
    except InputError:
        return []  # no surface was touched so often
    first, step = found.first, found.step or 0.0
    if first is None:
        return []
    half = (first.high - first.low) / 2.0
    if abs(first.value) <= max(FIRST_OFF * half, OUTLYING_STEPS * step):
        return []
    value, low, high = (number(v) for v in (first.value, first.low, first.high))
    size = f"{value} {found.unit} ({low} … {high})"
    return [f"The first touch of a series is off those that follow: {size}."]
