"""``skiplatch import csv`` of touches round a ring: the axes that moved, and the centre."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis
from test_import_logs import Run

MAPPED = ("--map", "alpha_deg=Angle", "--map", "deviation_um=Error [um]", "--feed", "100")
ROUND = np.arange(0.0, 360.0, 20.0)
ASSUMED_Z = "Z probed, as no column says which axis did; else give --axis"


def waves(angles: FloatArray, *, lobes_um: float, centre_um: float) -> FloatArray:
    """Give three lobes from 0 degrees on, and a centre that lies off towards 70 degrees."""
    lobes = lobes_um * np.cos(np.radians(3.0 * angles))
    return np.asarray(5.0 + lobes + centre_um * np.cos(np.radians(angles - 70.0)))


def read(
    folder: Path,
    angles: FloatArray,
    errors: FloatArray,
    *options: str,
    more: Sequence[tuple[str, Sequence[object]]] = (),
) -> Run:
    """Import a table, with more columns besides."""
    heads = ["Angle", "Error [um]", *(head for head, _ in more)]
    columns = [angles.tolist(), errors.tolist(), *(cells for _, cells in more)]
    rows = [",".join(map(str, row)) for row in zip(*columns, strict=True)]
    (folder / "t.csv").write_text("\n".join([",".join(heads), *rows]) + "\n")
    return Run(folder, "csv", str(folder / "t.csv"), *MAPPED, *options)


def said_of_centre(run: Run) -> list[str]:
    return [line for line in run.said["assumed"] if line.startswith("the centre of the ring")]


def test_centre_of_a_ring_is_taken_out_and_said(tmp_path: Path) -> None:
    run = read(tmp_path, ROUND, waves(ROUND, lobes_um=2.0, centre_um=4.0))

    expected = waves(ROUND, lobes_um=2.0, centre_um=0.0)
    assert run.campaign.touches.deviation_um == pytest.approx(expected, abs=1e-3)
    (line,) = said_of_centre(run)
    assert "of 4 µm, highest at azimuth 70°, was fitted by least squares (two figures)" in line


def test_every_session_has_a_centre_of_its_own(tmp_path: Path) -> None:
    angles = np.tile(ROUND, 2)
    parts = [waves(ROUND, lobes_um=0.0, centre_um=off_um) for off_um in (4.0, -7.0)]
    sessions = np.repeat(["a", "b"], len(ROUND)).tolist()

    run = read(
        tmp_path, angles, np.concatenate(parts), "--map", "session=S", more=[("S", sessions)]
    )

    assert run.campaign.touches.deviation_um == pytest.approx(5.0, abs=1e-3)
    assert len(said_of_centre(run)) == 2


def test_slow_and_fast_touches_keep_what_is_between_them(tmp_path: Path) -> None:
    feeds = np.where(ROUND < 180.0, 100.0, 500.0)
    errors = waves(ROUND, lobes_um=0.0, centre_um=0.0) + feeds / 100.0

    run = read(tmp_path, ROUND, errors, "--map", "feed_mm_min=F", more=[("F", feeds.tolist())])

    assert run.campaign.touches.deviation_um == pytest.approx(errors, abs=1e-3)


@pytest.mark.parametrize("angles", [ROUND[:5], np.array([0.0, 90.0, 180.0, 270.0] * 3)])
def test_azimuths_that_do_not_tell_a_centre_leave_deviations(
    tmp_path: Path, angles: FloatArray
) -> None:
    errors = waves(angles, lobes_um=2.0, centre_um=4.0)

    run = read(tmp_path, angles, errors)

    assert run.campaign.touches.deviation_um == pytest.approx(errors, abs=1e-3)
    assert not said_of_centre(run)


@pytest.mark.parametrize("column", ["position_mm", "rotary_deg"])
def test_touches_of_other_places_are_no_ring(tmp_path: Path, column: str) -> None:
    errors = waves(ROUND, lobes_um=0.0, centre_um=4.0)

    run = read(tmp_path, ROUND, errors, "--map", f"{column}=P", more=[("P", ROUND.tolist())])

    assert run.campaign.touches.deviation_um == pytest.approx(errors, abs=1e-3)


def test_axes_and_senses_round_a_bore_follow_from_the_azimuths(tmp_path: Path) -> None:
    angles = np.array([0.0, 80.0, 100.0, 190.0, 260.0, 350.0])

    run = read(tmp_path, angles, np.zeros(6))

    touches, x, y = run.campaign.touches, Axis.X, Axis.Y
    assert touches.axis.tolist() == [x, y, y, x, y, x]
    assert touches.sign.tolist() == [1, 1, 1, -1, -1, 1]
    assert any("X or Y moved" in line for line in run.said["assumed"])
    assert ASSUMED_Z not in run.said["assumed"]


def test_an_axis_that_is_given_holds_round_a_bore(tmp_path: Path) -> None:
    run = read(tmp_path, ROUND, np.zeros(len(ROUND)), "--axis", "Y")

    assert set(run.campaign.touches.axis.tolist()) == {Axis.Y}
    assert np.isnan(run.campaign.touches.sign).all()


@pytest.mark.parametrize("mapped", ["deviation_um=Error [um]", "coordinate_mm=Error [um]"])
def test_an_axis_that_nothing_says_is_told_as_assumed(tmp_path: Path, mapped: str) -> None:
    (tmp_path / "t.csv").write_text("Error [um]\n1\n2\n1.5\n")
    arguments = ("csv", str(tmp_path / "t.csv"), "--map", mapped)
    folders = [tmp_path / "without", tmp_path / "given"]
    for folder in folders:
        folder.mkdir()

    without, given = Run(folders[0], *arguments), Run(folders[1], *arguments, "--axis", "z")

    assert ASSUMED_Z in without.said["assumed"]
    assert ASSUMED_Z not in given.said["assumed"]
