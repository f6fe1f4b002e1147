"""``skiplatch kinematics probing``: 25 points three times, planted."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from skiplatch.arrays import FloatArray
from skiplatch.cli import group
from skiplatch.errors import InputError

CENTRE_MM, RADIUS_MM = np.array([310.0, -120.0, 55.0]), 12.5
POLAR_DEG = np.repeat([0.0, 22.5, 45.0, 67.5, 90.0], [1, 4, 8, 4, 8])


def places() -> FloatArray:
    """The recommended ones, written out by azimuth; turned by 10° as a whole."""
    azimuths = [0.0, *(0, 90, 180, 270), *(22.5 + 45.0 * np.arange(8))]
    azimuths += [*(45.0 + 90.0 * np.arange(4)), *(67.5 + 45.0 * np.arange(8))]
    polar, azimuth = np.radians(POLAR_DEG), np.radians(np.array(azimuths) + 10.0)
    flat = np.sin(polar)
    return np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.cos(polar)])


def run(folder: Path, runs: list[FloatArray], *more: str) -> tuple[Result, Path]:
    rows = [(i, *point) for i, points in enumerate(runs, start=1) for point in points]
    path, out = folder / "points.csv", folder / "out.json"
    header = "run,x_mm,y_mm,z_mm"
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=header, comments="")
    words = ["kinematics", "probing", str(path), "--json", str(out), *more]
    return CliRunner().invoke(group, words), out


def sphere(radius_mm: float, lobes_mm: float = 0.0) -> FloatArray:
    """Points with lobes four times a turn at the equator: no shift and no size looks like that."""
    azimuth = np.arctan2(places()[:, 1], places()[:, 0])
    off = np.where(POLAR_DEG == 90.0, lobes_mm * np.cos(4.0 * azimuth - np.radians(130.0)), 0.0)
    return np.asarray(CENTRE_MM + places() * (radius_mm + off)[:, None])


def test_form_and_size_of_each_run_and_the_largest_are_told(tmp_path: Path) -> None:
    tip_mm = 3.0
    runs = [sphere(15.5), sphere(15.501, 0.002), sphere(15.4985)]

    result, out = run(tmp_path, runs, "--radius", "12.5", "--tip-radius", str(tip_mm))

    assert result.exit_code == 0, result.output
    found = json.loads(out.read_text(encoding="utf-8"))
    forms = [one["form_um"] for one in found["runs"]]
    assert forms[0] == pytest.approx(0.0, abs=1e-3)
    assert forms[1] == pytest.approx(4.0, abs=0.02)
    assert found["form_um"] == forms[1]
    assert [one["size_um"] for one in found["runs"]] == pytest.approx([0.0, 2.0, -3.0], abs=0.01)
    assert found["size_um"] == pytest.approx(-3.0, abs=0.01)
    assert found["off_pattern_deg"] < 0.01
    assert "places: as recommended" in result.output


def test_a_point_far_off_is_not_left_out(tmp_path: Path) -> None:
    chip = sphere(RADIUS_MM)
    chip[7] += 0.1 * places()[7]

    result, out = run(tmp_path, [sphere(RADIUS_MM), chip, sphere(RADIUS_MM)])

    assert result.exit_code == 0, result.output
    found = json.loads(out.read_text(encoding="utf-8"))
    assert 80.0 < found["form_um"] < 100.0
    assert found["size_um"] is None


def test_other_places_are_named(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    away = rng.normal(size=(25, 3))
    away[:, 2] = np.abs(away[:, 2])
    elsewhere = CENTRE_MM + RADIUS_MM * away / np.linalg.norm(away, axis=1)[:, None]

    result, _ = run(tmp_path, [elsewhere] * 3)

    assert result.exit_code == 0, result.output
    assert "not the recommended ones" in result.output


@pytest.mark.parametrize(
    ("runs", "message"),
    [
        ([sphere(12.5)] * 2, "run: expected 3 runs, got 2"),
        ([sphere(12.5), sphere(12.5)[:24], sphere(12.5)], "run 2: expected 25 points, got 24"),
    ],
)
def test_another_number_of_points_is_refused(
    tmp_path: Path, runs: list[FloatArray], message: str
) -> None:
    result, _ = run(tmp_path, runs)

    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)


@pytest.mark.parametrize(
    ("line", "cells", "message"),
    [
        (4, "0,", "points.csv:4: run: expected the number of a run, from 1 on, got 0"),
        (4, "1.5,", "points.csv:4: run: expected the number of a run, from 1 on, got 1.5"),
        (4, "1_0,", 'points.csv:4: run: expected a number in run, at most 1e+06, got "1_0"'),
        (4, None, "points.csv:4: expected 25 points of their own, got that of line 3 again"),
    ],
)
def test_row_that_is_no_point_of_its_own_is_refused(
    tmp_path: Path, line: int, cells: str | None, message: str
) -> None:
    run(tmp_path, [sphere(12.5)] * 3)
    path = tmp_path / "points.csv"
    rows = path.read_text().splitlines()
    own = rows[line - 1]
    rows[line - 1] = rows[line - 2] if cells is None else cells + own.partition(",")[2]
    path.write_text("\n".join(rows) + "\n")

    result = CliRunner().invoke(group, ["kinematics", "probing", str(path)])

    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)
