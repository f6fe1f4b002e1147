"""``skiplatch kinematics probing``: the probing test of ISO 10360-5 and ISO 230-10."""

from dataclasses import asdict
from pathlib import Path

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import NumberType
from skiplatch.commands.options import json_option, write_json
from skiplatch.errors import InputError
from skiplatch.kinematics.probing_test import ProbingTest, probing_test, read_test
from skiplatch.kinematics.sphere import NoSphereError
from skiplatch.tables import table

EPILOG = """\b
Example:
  skiplatch kinematics probing build/sphere.csv --radius 12.4997 --json build/probing.json
"""
NEAR_DEG = 5.0
LENGTH = NumberType(0.0, 1e4)


@click.command(epilog=EPILOG)
@click.argument("points_path", metavar="POINTS", type=Source())
@click.option(
    "--radius", "radius_mm", type=LENGTH, help="Calibrated radius of the sphere, mm: for the size."
)
@click.option(
    "--tip-radius",
    "tip_mm",
    type=LENGTH,
    default=0.0,
    show_default=True,
    help="Calibrated radius of the tip, mm, where points are those of its centre.",
)
@json_option
def command(
    points_path: Path, radius_mm: float | None, tip_mm: float, json_path: Path | None
) -> None:
    """Evaluate 25 points on a sphere, probed three times.

    POINTS is a CSV file with the columns run, x_mm, y_mm, z_mm: three runs of 25 points over half
    of a test sphere, its pole along Z. Told are form and size error of each run, and the largest,
    which a report states. No point is left out.
    """
    runs = read_test(points_path)
    expected_mm = None if radius_mm is None else radius_mm + tip_mm
    try:
        found = probing_test(runs, expected_mm)
    except NoSphereError as error:
        raise InputError(points_path, None, None, str(error)) from error
    click.echo(_text(found))
    write_json(json_path, {"format": "skiplatch-probing/1", **asdict(found)})


def _text(found: ProbingTest) -> str:
    rows = [
        (f"run {place}", f"{run.form_um:.2f}", _signed(run.size_um))
        for place, run in enumerate(found.runs, start=1)
    ]
    rows.append(("to state: the largest", f"{found.form_um:.2f}", _signed(found.size_um)))
    header = ("", "form P_Form.Sph.1x25 = P_FTU,3D, µm", "size P_Size.Sph.1x25, µm")
    off = found.off_pattern_deg
    places = "as recommended" if off <= NEAR_DEG else "not the recommended ones: say which"
    return "\n".join(
        [table(header, rows), f"places: {places} (farthest {off:.1f}° from its own; pole along Z)"]
    )


def _signed(size_um: float | None) -> str:
    return "—" if size_um is None else f"{size_um:+.2f}"
