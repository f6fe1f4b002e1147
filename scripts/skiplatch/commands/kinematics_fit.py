"""``skiplatch kinematics fit``: location errors from recorded centres of a sphere."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import CountType
from skiplatch.commands.options import json_option, write_json
from skiplatch.errors import InputError
from skiplatch.kinematics.circles import Circle, circles
from skiplatch.kinematics.error_motions import ErrorMotion, error_motions
from skiplatch.kinematics.firmware import Estimate, Fit, NoFitError, Undetermined, fit, recommend
from skiplatch.kinematics.machine import Machine, read_machine
from skiplatch.kinematics.outliers import without_outliers
from skiplatch.kinematics.points import Points, columns_of, read_points
from skiplatch.tables import number, table

RECOMMENDED_MAX = 24
TOUCHES = (3, 8)

HELP = """Find location errors (ISO 230-7) from recorded sphere centres POINTS.

POINTS is a CSV file with a row for each position: the angles a_deg, b_deg, c_deg of the axes
that the machine has, and x_mm, y_mm, z_mm, what the linear axes read with the tip in the
centre of the sphere. With an axis in the head that is without any compensation of the tool's
tilt (TCPM off).

\b
The machine is a TOML file:
  table = ["A", "C"]        from the bed outwards: A tilts and carries C, C carries the sphere
  head = []                 from the ram to the tool
  [axes.A]                  and so on for each axis, with every axis at 0
  direction = [1, 0, 0]     unit vector, machine coordinates: y = point + R(y - point)
  point_mm = [0, 0, 0]      a point of the axis line, machine coordinates
  range_deg = [-90, 90]     optional, for --recommend
  datum_deg = 0             optional: what the control shows more than the encoder
tool_mm = [x, y, z] at the top says where the tip is with every axis at 0, if that is known.

A location error is actual minus believed, at the believed point, in machine coordinates:
XOC and YOC are the offset of the C line in the plane of constant Z through that point, AOC and
BOC the right-handed turns about X and Y from the believed to the actual direction. Likewise
YOA, ZOA, BOA, COA and XOB, ZOB, AOB, COB. The zeros AOA, BOB, COC cannot be told from the lines
carried and the place of the sphere: they are taken as believed and named as undetermined.
Uncertainties are standard uncertainties; three of them hold 99.73 %.
"""

EPILOG = """\b
Example:
  skiplatch kinematics fit build/points.csv --machine build/machine.toml --json build/errors.json
"""


@click.command(name="fit", help=HELP, epilog=EPILOG)
@click.argument("points_path", metavar="POINTS", type=Source())
@click.option(
    "--machine",
    "machine_path",
    required=True,
    type=Source(),
    help="The rotary axes as believed.",
)
@click.option(
    "--recommend",
    "with_positions",
    is_flag=True,
    help="Also recommend positions that determine what these leave undetermined.",
)
@click.option(
    "--touches",
    type=CountType(*TOUCHES),
    help="A centre comes from so many touches around the sphere (Q423) and one on its pole, and "
    "scatters the more along the tool.  [default: alike in all directions]",
)
@json_option
def command(
    points_path: Path,
    machine_path: Path,
    with_positions: bool,  # noqa: FBT001
    touches: int | None,
    json_path: Path | None,
) -> None:
    """Find location errors from recorded sphere centres."""
    machine = read_machine(machine_path)
    points = read_points(points_path, machine)
    with too_few_named(points_path, points):
        judged = without_outliers(machine, points, touches)
        found = fit(machine, judged.kept, touches=touches)
        advice = recommend(machine, judged.kept, RECOMMENDED_MAX) if with_positions else None
    for outlier in judged.outliers:
        click.echo(f"Outlier, left out: position {outlier.place + 1}, {outlier.text}.")
    result = tell(machine, judged.kept, found)
    result["outliers"] = [asdict(outlier) for outlier in judged.outliers]
    if advice is not None:
        click.echo(_advice_text(machine, *advice))
        result["recommended"] = _advice_json(machine, *advice)
    write_json(json_path, result)


@contextmanager
def too_few_named(points_path: Path, points: Points) -> Iterator[None]:
    """Say of which file it is that the points cannot be fitted.

    Raises:
        InputError: They cannot.
    """
    try:
        yield
    except NoFitError as error:
        raise InputError(points_path, len(points) + 1, None, str(error)) from error


def tell(machine: Machine, points: Points, found: Fit) -> dict[str, object]:
    """Say what was found, and give it as JSON has it."""
    turns = circles(machine, points)
    motions = error_motions(machine, points)
    click.echo("\n".join([_text(found, turns), *map(_motion_text, motions)]))
    return {**_json(found, turns), "error_motions": [_motion_json(one) for one in motions]}


def _motion_text(motion: ErrorMotion) -> str:
    values = ", ".join(f"{name} {number(um, 3)} µm" for name, um in motion.values_um.items())
    apart = motion.asynchronous_um
    repeats = "" if apart is None else f", asynchronous {number(apart, 3)} µm"
    count = f"{len(motion.angle_deg)} angles, {number(motion.radius_mm, 4)} mm off the axis"
    return f"error motion of {motion.letter} (ISO 230-7), {count}: {values}{repeats}"


def _motion_json(motion: ErrorMotion) -> dict[str, object]:
    names = [f"E{x}{motion.letter}_um" for x in "XYZ"]
    return {
        "axis": motion.letter,
        "others_deg": motion.others_deg,
        "radius_mm": motion.radius_mm,
        "angle_deg": motion.angle_deg.tolist(),
        **dict(zip(names, motion.motion_um.T.tolist(), strict=True)),
        "radial_um": motion.radial_um.tolist(),
        "face_um": motion.face_um.tolist(),
        "turn_arcsec": motion.turn_arcsec.tolist(),
        "values_um": motion.values_um,
        "asynchronous_um": motion.asynchronous_um,
    }


def _text(found: Fit, turns: Sequence[Circle]) -> str:
    rows = [
        (name, number(e.value, 4), number(e.uncertainty, 2), e.unit) for name, e in found.estimates
    ]
    lines = [
        table(("location error", "actual minus believed", "standard uncertainty", "unit"), rows)
        if rows
        else "No location error can be determined.",
        _quality(found),
        "undetermined, left as believed:",
        *(f"  {_why(u)}" for u in found.undetermined),
        *(
            f"circle of {c.letter}: radius {number(c.radius_mm, 6)} mm, {c.positions} positions"
            for c in turns
        ),
    ]
    return "\n".join(lines)


def _quality(found: Fit) -> str:
    residual = f"residual {number(found.residual_um, 3)} µm a coordinate"
    return f"{residual}; {found.unknowns} unknowns, rank {found.rank}"


def _why(undetermined: Undetermined) -> str:
    if not undetermined.against:
        return f"{undetermined.name}: shows at no position"
    return (
        f"{undetermined.name}: goes with the place of the {' and the '.join(undetermined.against)}"
    )


def _json(found: Fit, turns: Sequence[Circle]) -> dict[str, object]:
    return {
        "parameters": {name: _estimate(e) for name, e in found.parameters.items()},
        "combinations": {
            c.name: {**_estimate(c.estimate), "factors": dict(c.amounts)}
            for c in found.combinations
        },
        "undetermined": [u.name for u in found.undetermined],
        "undetermined_against": {u.name: list(u.against) for u in found.undetermined},
        "residual_um": found.residual_um,
        "circles": [asdict(circle) for circle in turns],
        "sphere_mm": list(found.sphere_mm),
        "unknowns": found.unknowns,
        "rank": found.rank,
        "degrees_of_freedom": found.freedom,
    }


def _estimate(estimate: Estimate) -> dict[str, object]:
    return {
        "value": estimate.value,
        "uncertainty": estimate.uncertainty,
        "unit": estimate.unit,
    }


def _still_open(after: Fit) -> list[str]:
    return [u.name for u in after.undetermined if not u.is_zero]


def _advice_text(machine: Machine, more: Points, after: Fit) -> str:
    left = _still_open(after)
    last = (
        f"No positions of the axes determine: {', '.join(left)}. {_remedy(machine)}" if left else ""
    )
    if not len(more):
        return "\n".join(["No further positions are needed.", last]).rstrip()
    columns = columns_of(machine)
    rows = [[number(v, 6) for v in row] for row in _rows(more)]
    return "\n".join(["further positions to measure:", table(columns, rows), last]).rstrip()


def _remedy(machine: Machine) -> str:
    if any(axis.in_head for axis in machine.axes) and machine.tool_mm is None:
        return "The pivot of a head cannot be told from the tool's length: tool_mm would say it."
    return "Mount the sphere farther from the centre of the table."


def _rows(points: Points) -> list[list[float]]:
    return [
        [*map(float, angles), *map(float, position)]
        for angles, position in zip(points.angles_deg, points.positions_mm, strict=True)
    ]


def _advice_json(machine: Machine, more: Points, after: Fit) -> dict[str, object]:
    columns = columns_of(machine)
    return {
        "positions": [dict(zip(columns, row, strict=True)) for row in _rows(more)],
        "undetermined": _still_open(after),
    }
