"""Tables of the log of cycles 451 and 452: positions, Q parameters, location errors."""

from skiplatch.kinematics.evaluation import AxisResult, Evaluation
from skiplatch.kinematics.machine import LETTERS
from skiplatch.report.layout import Table


def positions_table(axis: AxisResult) -> Table:
    """Give the errors of an axis at its positions."""
    header = (
        f"{axis.letter}, deg",
        *(f"E{c}{axis.letter} before, mm" for c in "XYZ"),
        *(f"E{c}{axis.letter} after, mm" for c in "XYZ"),
    )
    rows = [
        (f"{angle:g}", *(f"{v:+z.4f}" for v in (*before, *after)))
        for angle, before, after in zip(axis.angle_deg, axis.before_mm, axis.after_mm, strict=True)
    ]
    return Table(header, rows)


def results_table(evaluation: Evaluation) -> Table:
    """Give Q141 to Q149."""
    offset = "offset" if evaluation.preset_off_mm is None else "sphere off the preset"
    meanings = {
        **{141 + i: f"standard deviation of {x}, measured" for i, x in enumerate(LETTERS)},
        **{144 + i: f"standard deviation of {x}, optimised" for i, x in enumerate(LETTERS)},
        **{147 + i: f"{offset} in {x}" for i, x in enumerate("XYZ")},
    }
    rows = [
        (f"Q{q}", "−1" if value == -1.0 else f"{value:z.4f}", meanings[q])
        for q, value in evaluation.q_parameters().items()
    ]
    return Table(("parameter", "mm", "meaning"), rows)


def location_errors_table(evaluation: Evaluation) -> Table:
    """Give the location errors that are determined."""
    rows = [
        (name, f"{e.value:+z.2f}", f"{e.uncertainty:.2f}", e.unit)
        for name, e in evaluation.fit.estimates
    ]
    return Table(("ISO 230-7", "actual − believed", "standard uncertainty", "unit"), rows)
