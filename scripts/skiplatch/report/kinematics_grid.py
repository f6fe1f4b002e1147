"""What the log says of cycle 453: how far the sphere is off over the grid."""

from collections.abc import Sequence
from dataclasses import dataclass

from skiplatch.kinematics.grid_evaluation import DELETE, GridEvaluation
from skiplatch.kinematics.machine import LETTERS
from skiplatch.report.layout import Table
from skiplatch.units import UM_PER_MM

MODES = {-1: "delete the compensation", 0: "check the grid", 1: "compensate over the grid"}


@dataclass(frozen=True, slots=True, eq=False)
class LoggedGrid:
    """One run of cycle 453.

    Attributes:
        evaluation: What it found.
        effort: What the measurement took, such as touches and time.
        end: How 3-D ROT and TRACK stand at the end.
        notes: What the operator should know, a sentence each.
    """

    evaluation: GridEvaluation
    effort: str
    end: str
    notes: Sequence[str] = ()


def lay_out_grid(logged: LoggedGrid, place: int) -> dict[str, object]:
    """Lay out the section of one run of cycle 453; what has nothing to show is not there."""
    evaluation = logged.evaluation
    return {
        "cycle": "cycle 453",
        "title": f"Cycle 453 KINEMATICS GRID, mode {evaluation.mode} = {MODES[evaluation.mode]}",
        "words": MODES[evaluation.mode],
        "effort": logged.effort,
        "end": logged.end,
        "notes": logged.notes,
        "lead": lead(evaluation),
        "preset": facts(evaluation),
        "incidence": "",
        "axes": (),
        "errors": None,
        "grid": _positions(evaluation) if evaluation.mode != DELETE else None,
        "id": f"run-{place + 1}",
    }


def lead(evaluation: GridEvaluation) -> str:
    """Say in a sentence what came of it."""
    if evaluation.mode == DELETE:
        return "Nothing is compensated any more. Nothing was measured."
    written = "is compensated" if evaluation.mode else "is left as it is"
    return (
        f"Standard deviation {UM_PER_MM * evaluation.deviation_mm:.2f} µm, greatest deviation "
        f"{UM_PER_MM * evaluation.change_mm:.2f} µm at "
        f"{evaluation.place_text(evaluation.greatest)}; it {written}."
    )


def facts(evaluation: GridEvaluation) -> list[tuple[str, str]]:
    """Give the results by name."""
    if evaluation.mode == DELETE:
        return []
    return [
        ("measuring positions", f"{len(evaluation.angle_deg)}, one with every axis at 0"),
        ("standard deviation", f"{evaluation.deviation_mm:.4f} mm"),
        ("greatest deviation", f"{evaluation.change_mm:.4f} mm"),
        ("it stands at", evaluation.place_text(evaluation.greatest)),
    ]


def _positions(evaluation: GridEvaluation) -> Table:
    letters = [letter for letter in LETTERS if letter in evaluation.believed.letters]
    header = (
        *(f"{letter}, deg" for letter in letters),
        *(f"{c} off, mm" for c in "XYZ"),
        "in space, mm",
    )
    rows = [
        (
            *(f"{angles[LETTERS.index(letter)]:g}" for letter in letters),
            *(f"{mm:+z.4f}" for mm in off),
            f"{distance:.4f}",
        )
        for angles, off, distance in zip(
            evaluation.angle_deg, evaluation.off_mm, evaluation.distance_mm, strict=True
        )
    ]
    return Table(header, rows)
