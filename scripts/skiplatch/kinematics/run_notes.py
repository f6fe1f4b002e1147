"""What the operator should know of a run of cycle 451 to 453, a sentence each."""

from collections.abc import Iterator

from skiplatch.kinematics.cycle import (
    Report,
)
from skiplatch.kinematics.evaluation import Evaluation
from skiplatch.units import ARCSEC_PER_DEG

NO_BACKLASH = (
    "Backlash of {} was not measured (Q432 = 0, a Hirth coupling or an M function): an axis that "
    "has some stands off by up to that angle, as it came. It shows as scatter, and as a tilt of "
    "the axis that it carries."
)


def cancelled_rotation(report: Report) -> Iterator[str]:
    """Say that the basic rotation is gone, if it is."""
    if report.cancelled_rotation:
        yield "The preset has no basic rotation any more (SPA, SPB, SPC): set it again."


def moved_datums(evaluation: Evaluation) -> Iterator[str]:
    """Say by how much the machine datum of an axis moves, if it does."""
    for before, after in zip(evaluation.believed.axes, evaluation.corrected.axes, strict=True):
        if after.datum_deg != before.datum_deg:
            moved_arcsec = ARCSEC_PER_DEG * (after.datum_deg - before.datum_deg)
            yield (
                f"The machine datum of {before.letter} moves by {moved_arcsec:+.2f}″: it takes the "
                "tilt of the axis carried, which no position tells from it."
            )


def known_in_combination(evaluation: Evaluation) -> Iterator[str]:
    """Say which location errors only their sum is known of, if there are any."""
    if evaluation.combined:
        yield (
            f"Known only in combination: {', '.join(evaluation.combined)}. The smallest correction "
            "that does it is taken, offsets before tilts."
        )
