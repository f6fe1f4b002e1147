"""The log of cycles 451, 452 and 453, TCHPRAUTO.html: no script, nothing from elsewhere."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from skiplatch.figures.inline import Drawing
from skiplatch.figures.kinematics import draw_axis
from skiplatch.kinematics.correction import ANGLES, CHECK
from skiplatch.kinematics.evaluation import AxisResult, Evaluation
from skiplatch.kinematics.machine import LETTERS, RotaryAxis, Vector
from skiplatch.kinematics.recorded import PARAMETERS_OF_AXIS
from skiplatch.report.kinematics_grid import LoggedGrid, lay_out_grid
from skiplatch.report.kinematics_tables import location_errors_table, positions_table, results_table
from skiplatch.report.layout import Table, render
from skiplatch.units import UM_PER_MM

TEMPLATE = "kinematics.html"
STREAM = "log"
MODES = (
    "check",
    "optimise positions",
    "optimise positions and angles",
    "optimise origin and angles",
)


@dataclass(frozen=True, slots=True, eq=False)
class Logged:
    """One run of cycle 451 or 452.

    Attributes:
        cycle: Which of them.
        evaluation: What it found.
        parameters: Q parameters by number, as the cycle had them.
        effort: What the measurement took, such as touches and time.
        end: How 3-D ROT and TRACK stand at the end.
        notes: What the operator should know, a sentence each.
        spindle_mm: The spindle nose with every axis at 0: positions of axes are told from there.
    """

    cycle: int
    evaluation: Evaluation
    parameters: Mapping[int, float | str]
    effort: str
    end: str
    notes: Sequence[str] = ()
    spindle_mm: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class AxisSection:
    """What the page says of one axis."""

    letter: str
    facts: list[tuple[str, str]]
    positions: Table
    charts: dict[str, Drawing]


@dataclass(frozen=True, slots=True)
class Log:
    """The log as it is to be written.

    Attributes:
        html: The page, which shows all charts.
        charts: The same charts as SVG, by the names of files that belong beside the page.
    """

    html: str
    charts: Mapping[str, str]


def lay_out(
    logged: Sequence[Logged | LoggedGrid],
    *,
    name: str | None,
    when: datetime,
    program: Path,
    tool: str,
    kinematics: str,
) -> Log:
    """Lay out the log of all runs of a program.

    Args:
        logged: The runs, in their order.
        name: Begins the names of the charts' files; None: there are none, and no links to them.
        when: Date and time of the log.
        program: The NC program.
        tool: Name of the probe.
        kinematics: Name of the active kinematics.
    """
    sections = [
        []
        if isinstance(run, LoggedGrid)
        else [_section(run, axis, f"{name or STREAM}-{i}") for axis in run.evaluation.axes]
        for i, run in enumerate(logged, start=1)
    ]
    html = render(
        TEMPLATE,
        when=when.strftime("%Y-%m-%d %H:%M:%S"),
        program=str(program),
        tool=tool or "—",
        kinematics=kinematics,
        has_files=name is not None,
        runs=[
            lay_out_grid(run, i) if isinstance(run, LoggedGrid) else _run(run, i, sections[i])
            for i, run in enumerate(logged)
        ],
    )
    charts = {
        file: chart.file
        for run in sections
        for section in run
        for file, chart in section.charts.items()
    }
    return Log(html, charts)


def _run(logged: Logged, place: int, sections: Sequence[AxisSection]) -> dict[str, object]:
    evaluation = logged.evaluation
    return {
        "cycle": f"cycle {logged.cycle}",
        "title": _title(logged),
        "words": _words(logged),
        "preset": _preset(logged),
        "incidence": _incidence(logged),
        "effort": logged.effort,
        "end": logged.end,
        "notes": [*logged.notes, *_undetermined(evaluation)],
        "lead": _lead(evaluation),
        "axes": sections,
        "grid": None,
        "results": results_table(evaluation),
        "errors": location_errors_table(evaluation),
        "is_check": evaluation.mode == CHECK,
        "id": f"run-{place + 1}",
    }


def _words(logged: Logged) -> str:
    is_compensated = logged.evaluation.preset_off_mm is not None
    return "compensate the preset" if is_compensated else MODES[logged.evaluation.mode]


def _title(logged: Logged) -> str:
    evaluation = logged.evaluation
    if evaluation.preset_off_mm is not None:
        return f"Cycle {logged.cycle} PRESET COMPENSATION"
    name = f"Cycle {logged.cycle} MEASURE KINEMATICS"
    return f"{name}, mode {evaluation.mode} = {MODES[evaluation.mode]}"


def _preset(logged: Logged) -> list[tuple[str, str]]:
    """Say what cycle 452 did to the tip, besides what stands with the axes."""
    evaluation = logged.evaluation
    if evaluation.preset_off_mm is None:
        return []
    before, after = (
        machine.tip_shift_mm for machine in (evaluation.believed, evaluation.corrected)
    )
    return [
        ("sphere off the preset, with every axis at 0", vector_text(evaluation.preset_off_mm)),
        ("shift of the tip before", vector_text(before)),
        ("shift of the tip, compensated", vector_text(after)),
    ]


def _lead(evaluation: Evaluation) -> str:
    if not evaluation.axes:
        return "No rotary axis was measured: the sphere alone, for the preset."
    parts = [
        f"{axis.letter} {UM_PER_MM * axis.scatter_before_mm:.2f} → "
        f"{UM_PER_MM * axis.scatter_after_mm:.2f} µm"
        for axis in evaluation.axes
    ]
    would = "would go" if evaluation.mode == CHECK else "goes"
    return f"Scatter {would} from the active to the corrected kinematics: {'; '.join(parts)}."


def _undetermined(evaluation: Evaluation) -> list[str]:
    names = [u.name for u in evaluation.fit.undetermined]
    if not names:
        return []
    return [f"The positions do not determine {', '.join(names)}: left as believed."]


def _incidence(logged: Logged) -> str:
    given = [
        f"{letter} {_number(logged.parameters.get(PARAMETERS_OF_AXIS[letter][2]))}°"
        for letter in LETTERS
        if letter in {axis.letter for axis in logged.evaluation.believed.axes}
    ]
    return ", ".join(given)


def _number(value: float | str | None) -> str:
    if value is None:
        return "—"
    return f"{value:g}" if isinstance(value, float) else value


def _section(logged: Logged, axis: AxisResult, name: str) -> AxisSection:
    charts = draw_axis(axis, f"run{name.rpartition('-')[2]}")
    files = {f"{name}-{title}.svg": chart for title, chart in charts.items()}
    return AxisSection(axis.letter, _facts(logged, axis), positions_table(axis), files)


def _facts(logged: Logged, axis: AxisResult) -> list[tuple[str, str]]:
    start, end, _, count = (logged.parameters.get(q) for q in PARAMETERS_OF_AXIS[axis.letter])
    evaluation = logged.evaluation
    before, after = (
        next(a for a in machine.axes if a.letter == axis.letter)
        for machine in (evaluation.believed, evaluation.corrected)
    )
    would = "possible" if evaluation.mode == CHECK else "optimised"
    facts = [
        ("start angle", f"{_number(start)}°"),
        ("end angle", f"{_number(end)}°"),
        ("measuring points", f"{_number(count)} (measured besides 0°: {len(axis.angle_deg)})"),
        ("radius of the measuring circle", f"{axis.radius_mm:.4f} mm"),
    ]
    positioning = (
        f"{axis.positioning_arcsec:+z.2f}″, standard deviation "
        f"{axis.positioning_scatter_arcsec:.2f}″"
    )
    if logged.parameters.get(432, 0.0) != 0.0:
        facts.append(("mean backlash", _backlash(axis)))
    facts += [
        ("scatter (standard deviation), measured", f"{axis.scatter_before_mm:.4f} mm"),
        (f"scatter, {would}", f"{axis.scatter_after_mm:.4f} mm"),
        ("greatest error, measured", f"{axis.greatest_before_mm:.4f} mm"),
        (f"greatest error, {would}", f"{axis.greatest_after_mm:.4f} mm"),
        ("position of the axis before, from the spindle nose", _seen(before, logged)),
        (f"position of the axis, {would}, from the spindle nose", _seen(after, logged)),
        ("compensation in X, Y, Z (shift of the preset)", vector_text(_shift(before, after))),
        ("mean positioning error relative to 0°", positioning),
    ]
    if evaluation.mode >= ANGLES or evaluation.mode == CHECK:
        facts.insert(-1, ("angular location errors", _tilts(evaluation, axis.letter)))
    return facts


def _backlash(axis: AxisResult) -> str:
    if axis.backlash_arcsec is None:
        return "not computed: Hirth axis, M function, or a circle of less than 1 mm"
    return f"{axis.backlash_arcsec:z.2f}″ = {axis.backlash_arcsec / 3600.0:z.5f}°"


def _tilts(evaluation: Evaluation, letter: str) -> str:
    found = [
        f"{name} {e.value:+z.2f}″ ± {e.uncertainty:.2f}″"
        for name, e in evaluation.fit.parameters.items()
        if e.unit == "arcsec" and name[2:3] == letter
    ]
    return ", ".join(found) or "not determined"


def _shift(before: RotaryAxis, after: RotaryAxis) -> tuple[float, ...]:
    return tuple(a - b for a, b in zip(after.point_mm, before.point_mm, strict=True))


def _seen(axis: RotaryAxis, logged: Logged) -> str:
    pairs = zip(axis.point_mm, logged.spindle_mm, strict=True)
    return vector_text([point - start for point, start in pairs])


def vector_text(values: Sequence[float]) -> str:
    """Write a vector in mm, axis by axis."""
    parts = (f"{name} {value:+z.4f}" for name, value in zip("XYZ", values, strict=True))
    return f"{', '.join(parts)} mm"
