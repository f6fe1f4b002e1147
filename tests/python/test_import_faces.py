"""``skiplatch import csv``: where each touch was latched, beside where its face is."""

from pathlib import Path

import numpy as np
import pytest

from skiplatch.campaign import DatumFreedom
from test_import_logs import Run

MAPPED = ("--map", "coordinate_mm=Measured", "--map", "position_mm=Nominal", "--axis", "X")
GAUGE = """Side,Nominal,Measured
+,1250.0,1250.0035
+,1250.0,1250.0045
-,1200.0,1200.0020
-,1200.0,1200.0030
"""


def test_reversal_between_two_faces_is_kept(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(GAUGE)

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED, "--map", "sign=Side")

    touches = run.campaign.touches
    assert touches.deviation_um == pytest.approx([3.5, 4.5, -2.0, -3.0])
    assert touches.position_mm.tolist() == [1250.0, 1250.0, 1200.0, 1200.0]
    assert run.campaign.nominal.datum.free is DatumFreedom.AXIS
    assert any(line.startswith("where each face is: ") for line in run.said["known"])


def test_without_a_sense_the_positive_one_is_assumed_and_said(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(GAUGE)

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED)

    assert run.campaign.touches.deviation_um == pytest.approx([3.5, 4.5, 2.0, 3.0])
    assert any(line.startswith("the positive sense") for line in run.said["assumed"])


def test_touch_that_was_not_latched_is_missed_at_its_face(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("Nominal,Measured,S\n5,5.001,ok\n5,,missed\n5,5.002,ok\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED, "--map", "status=S")

    assert run.campaign.touches.missed.tolist() == [False, True, False]
    assert run.campaign.touches.position_mm.tolist() == [5.0, 5.0, 5.0]


@pytest.mark.parametrize(
    ("nominals", "why"),
    [(("7", "7"), "half of the touches are more than 0.6 mm off it"), (("5", ""), "has one")],
)
def test_positions_of_no_faces_only_tell_surfaces_apart(
    tmp_path: Path, nominals: tuple[str, str], why: str
) -> None:
    rows = [f"{nominals[0]},5.001", f"{nominals[0]},5.003", f"{nominals[1]},5.003"]
    (tmp_path / "t.csv").write_text("\n".join(["Nominal,Measured", *rows]) + "\n")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED, "--sign", "1")

    assert run.coordinates() == [5.001, 5.003, 5.003]
    assert np.all(np.abs(np.nan_to_num(run.campaign.touches.deviation_um)) <= 2.0)
    assert any(why in line for line in run.said["assumed"])
