"""What a report says beside the figures: what it looks like, and what the touches cannot tell."""

from collections.abc import Sequence

import numpy as np

from skiplatch.campaign import Axis, InputPath
from skiplatch.diagnosis.look import Left
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.verdict import Failure, Verdict


def notes(
    scene: Scene, verdict: Verdict, failures: Sequence[Failure], mattering: Sequence[Left]
) -> list[str]:
    """Say what it looks like, what kept it from being explained, and what cannot be told.

    Args:
        scene: The touches.
        verdict: What the diagnosis came to.
        failures: The rules that were missed.
        mattering: What the believed chain leaves that matters.
    """
    found: list[str] = []
    if verdict is Verdict.UNKNOWN and mattering:
        first = mattering[0]
        where = f"{first.observable}, {first.path} path"
        found.append(f"What it looks like: {where}: {first.looks_like}.")
    if verdict is not Verdict.EXPLAINED:
        found += [f"Not explained: {failure.words}." for failure in failures]
    for path in InputPath:
        if not (scene.touches.path == path).any():
            name = path.name.lower()
            found.append(f"No touches on the {name} path: nothing can be said of it.")
    if not scene.has_stamps.any():
        found.append("No time stamps: what shifts time and what shifts length look alike.")
    if (scene.touches.axis >= Axis.A).any():
        found.append(
            "Of axes A, B and C degrees stand for millimetres: 1 µm is 0.001° or 3.6″, "
            "1 mm/min is 1 deg/min."
        )
    found += _untold(scene)
    return found


def _untold(scene: Scene) -> list[str]:
    """Say what the touches cannot tell, for want of variety."""
    touches = scene.touches
    found: list[str] = []
    if not scene.is_machine:
        return found
    if len(np.unique(touches.feed_mm_min)) == 1:
        found.append("One feed: a delay and a length look alike; touch at a second feed.")
    for axis in np.unique(touches.axis):
        senses = np.unique(scene.sign[touches.axis == axis])
        if len(senses) == 1:
            found.append("One sense of motion on an axis: no backlash can be seen there.")
            break
    return found
