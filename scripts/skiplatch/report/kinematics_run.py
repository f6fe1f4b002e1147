"""Runs of cycles 451 to 453 for the terminal, and as JSON."""

from dataclasses import asdict

import numpy as np

from skiplatch.kinematics.cycle import COMPENSATE_PRESET
from skiplatch.kinematics.evaluation import Evaluation
from skiplatch.kinematics.grid_evaluation import DELETE, GridEvaluation
from skiplatch.kinematics.machine import (
    LETTERS,
)
from skiplatch.kinematics.run import Outcome, Run
from skiplatch.report.kinematics import vector_text
from skiplatch.report.kinematics_grid import lead
from skiplatch.tables import table
from skiplatch.units import S_PER_MIN, UM_PER_MM


def effort(run: Run) -> str:
    """Say what the measurement took, or where it comes from."""
    if run.evaluation.mode == DELETE:
        return "no touch"
    if run.report.touches == 0:
        return f"{len(np.unique(run.stations.centre_mm, axis=0))} recorded positions"
    minutes = run.report.duration_s / S_PER_MIN
    return f"{run.report.touches} touches in {minutes:.1f} min"


def _tilt_deg(run: Run) -> dict[str, float]:
    """Give the angles of 3-D ROT by axis; empty where it is not active."""
    shown = dict(zip(LETTERS, run.report.tilt_deg, strict=True)) if run.report.is_tilted else {}
    return {axis.letter: shown[axis.letter] for axis in run.evaluation.believed.axes if shown}


def end_state(run: Run) -> str:
    """Say how the tilt of the automatic mode and the tracking of the probe stand."""
    angles = ", ".join(f"{letter} {angle:g}°" for letter, angle in _tilt_deg(run).items())
    tilt = f"active at {angles}, as the axes stand" if angles else "off"
    return f"3-D ROT of the automatic mode {tilt}; TRACK {'on' if run.tracks else 'off'}"


def run_text(run: Run) -> str:
    """Say what a run found, for the terminal."""
    found = run.evaluation
    return _grid_text(run, found) if isinstance(found, GridEvaluation) else _text(run, found)


def _grid_text(run: Run, evaluation: GridEvaluation) -> str:
    name = f"cycle {run.cycle}, mode {evaluation.mode}, {effort(run)}"
    return "\n".join([name, *run.notes, f"{end_state(run)}.", lead(evaluation)])


def _text(run: Run, evaluation: Evaluation) -> str:
    rows = []
    for axis in evaluation.axes:
        backlash = "—" if axis.backlash_arcsec is None else f"{axis.backlash_arcsec:.2f}"
        lengths_mm = (axis.scatter_before_mm, axis.scatter_after_mm, axis.greatest_after_mm)
        lengths = [f"{UM_PER_MM * length:.2f}" for length in lengths_mm]
        rows.append((axis.letter, str(len(axis.angle_deg)), *lengths, backlash))
    header = ("axis", "positions", "scatter before, µm", "after, µm", "greatest, µm", "backlash, ″")
    found = [
        f"{name} {e.value:+.2f} ± {e.uncertainty:.2f} {e.unit}"
        for name, e in evaluation.fit.estimates
    ]
    left = ", ".join(u.name for u in evaluation.fit.undetermined)
    return "\n".join(
        [
            f"{_named(run)}, {effort(run)}",
            *_compensation(evaluation),
            *run.notes,
            f"{end_state(run)}.",
            table(header, rows),
            *found,
            f"undetermined, left as believed: {left}",
        ]
    )


def _named(run: Run) -> str:
    mode = f"mode {run.evaluation.mode}"
    return f"cycle {run.cycle}, {'preset compensation' if run.cycle == COMPENSATE_PRESET else mode}"


def _compensation(evaluation: Evaluation) -> list[str]:
    """Say how far the sphere was off the preset that cycle 452 keeps."""
    off_mm = evaluation.preset_off_mm
    return [] if off_mm is None else [f"the sphere was off the preset by {vector_text(off_mm)}"]


def as_json(outcome: Outcome) -> dict[str, object]:
    """Give all runs in plain types."""
    return {"runs": [_run_json(run) for run in outcome.runs]}


def _run_json(run: Run) -> dict[str, object]:
    found = run.evaluation
    return {
        "cycle": run.cycle,
        "mode": found.mode,
        "touches": run.report.touches,
        "duration_s": run.report.duration_s,
        "notes": list(run.notes),
        "preset_mm": list(run.report.preset_mm),
        "preset_at_0_mm": list(run.preset_at_0_mm),
        "end": {"3d_rot_deg": _tilt_deg(run), "track": run.tracks},
        **(_grid_json(found) if isinstance(found, GridEvaluation) else _found_json(found)),
    }


def _grid_json(evaluation: GridEvaluation) -> dict[str, object]:
    """Give what cycle 453 found at the positions of the grid, and its table."""
    if evaluation.mode == DELETE:
        return {}
    grid = evaluation.corrected.grid
    return {
        "deviation_um": UM_PER_MM * evaluation.deviation_mm,
        "greatest_um": UM_PER_MM * evaluation.change_mm,
        "greatest_at_deg": evaluation.angle_deg[evaluation.greatest].tolist(),
        "angle_deg": evaluation.angle_deg.tolist(),
        "off_um": (UM_PER_MM * evaluation.off_mm).tolist(),
        "table": {
            "angle_deg": grid.positions_deg if grid else [],
            "offset_um": (UM_PER_MM * np.array(grid.table_mm)).tolist() if grid else [],
        },
    }


def _found_json(evaluation: Evaluation) -> dict[str, object]:
    """Give what cycle 451 or 452 found."""
    return {
        "preset_off_mm": evaluation.preset_off_mm,
        "q": {f"Q{q}": value for q, value in evaluation.q_parameters().items()},
        "parameters": {
            name: {"value": e.value, "uncertainty": e.uncertainty, "unit": e.unit}
            for name, e in evaluation.fit.parameters.items()
        },
        "undetermined": [u.name for u in evaluation.fit.undetermined],
        "residual_um": evaluation.fit.residual_um,
        "outliers": [asdict(outlier) for outlier in evaluation.outliers],
        "axes": {
            axis.letter: {
                "angle_deg": axis.angle_deg.tolist(),
                "radius_mm": axis.radius_mm,
                "backlash_arcsec": axis.backlash_arcsec,
                "scatter_before_um": UM_PER_MM * axis.scatter_before_mm,
                "scatter_after_um": UM_PER_MM * axis.scatter_after_mm,
                "before_um": (UM_PER_MM * axis.before_mm).tolist(),
                "after_um": (UM_PER_MM * axis.after_mm).tolist(),
            }
            for axis in evaluation.axes
        },
    }
