"""``skiplatch kinematics sphere``: a sphere through measured points."""

from pathlib import Path

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.options import json_option, write_json
from skiplatch.errors import InputError
from skiplatch.kinematics.sphere import NoSphereError, Sphere, fit_sphere, read_sphere_points
from skiplatch.tables import number, table

EPILOG = """\b
Example:
  skiplatch kinematics sphere build/touches.csv --json build/sphere.json
"""
FIRST_ROW = 2


@click.command(epilog=EPILOG)
@click.argument("points_path", metavar="POINTS", type=Source())
@json_option
def command(points_path: Path, json_path: Path | None) -> None:
    """Fit a sphere to six or more points, wherever on it they lie.

    POINTS is a CSV file with a row for each point and the columns x_mm, y_mm, z_mm. Told are
    centre, radius, form (largest minus smallest distance from the centre) and standard
    uncertainties, of which three hold 99.73 %. A point that does not belong to the others is named
    and left out. Where the points are those of a ball's centre, the radius has the ball's in it.
    """
    points_mm = read_sphere_points(points_path)
    try:
        sphere = fit_sphere(points_mm)
    except NoSphereError as error:
        raise InputError(points_path, None, None, str(error)) from error
    click.echo(_text(len(points_mm), sphere))
    write_json(json_path, _json(len(points_mm), sphere))


def _text(count: int, sphere: Sphere) -> str:
    values = (*sphere.centre_mm, sphere.radius_mm)
    rows = [
        (name, f"{value:.5f}", number(u_um, 2))
        for name, value, u_um in zip(("x", "y", "z", "radius"), values, sphere.u_um, strict=True)
    ]
    return "\n".join(
        [
            table(("sphere", "mm", "standard uncertainty, µm"), rows),
            f"form {number(sphere.form_um, 4)} µm of {count - len(sphere.outliers)} points",
            *(
                f"Outlier, left out: point {place + 1} (line {place + FIRST_ROW}), off by "
                f"{off_um:+.1f} µm."
                for place, off_um in sphere.outliers
            ),
        ]
    )


def _json(count: int, sphere: Sphere) -> dict[str, object]:
    return {
        "format": "skiplatch-sphere/1",
        "points": count,
        "centre_mm": list(sphere.centre_mm),
        "radius_mm": sphere.radius_mm,
        "form_um": sphere.form_um,
        "u_um": list(sphere.u_um),
        "residual_um": sphere.residual_um,
        "outliers": [
            {"place": place, "line": place + FIRST_ROW, "off_um": off_um}
            for place, off_um in sphere.outliers
        ],
    }
