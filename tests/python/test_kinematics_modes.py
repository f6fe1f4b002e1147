"""What each mode of cycle 451 corrects, and what a check finds afterwards."""

import json
from pathlib import Path

import numpy as np
import pytest

from kinematics_programs import LOCATIONS, MACHINE, SAMPLES, axes_of, program_of, run
from rotary_machines import Kind, Line, best_offsets, readings
from skiplatch.kinematics.machine import read_machine
from skiplatch.kinematics.points import read_points

TABLE_BC = Kind("BC", "")


@pytest.mark.parametrize(("path", "floor_um"), [("skip", 1.0), ("plc", 10.0)])
def test_a_check_after_the_optimisation_shows_the_noise_floor(
    tmp_path: Path, path: str, floor_um: float
) -> None:
    result = run(SAMPLES / "optimise_then_check.h", tmp_path, "--path", path)

    assert result.exit_code == 0, result.output
    optimised, checked = json.loads((tmp_path / "out.json").read_text())["runs"]
    assert (optimised["mode"], checked["mode"]) == (2, 0)
    for letter in "BC":
        assert optimised["axes"][letter]["scatter_before_um"] > 50.0
        assert 0.1 < checked["axes"][letter]["scatter_before_um"] < floor_um


def test_after_mode_1_a_check_shows_what_offsets_alone_can_reach(tmp_path: Path) -> None:
    text = (SAMPLES / "optimise_then_check.h").read_text(encoding="utf-8")
    text = text.replace("Q406=+2", "Q406=+1").replace("Q432=+0.5", "Q432=+0")
    points, corrected = tmp_path / "points.csv", tmp_path / "corrected.toml"

    more = ("--points", str(points), "--corrected", str(corrected))
    result = run(program_of(tmp_path, text), tmp_path, *more)

    assert result.exit_code == 0, result.output
    believed = read_machine(MACHINE)
    found = {
        a.letter: Line(np.array(a.point_mm), np.array(a.direction)) for a in axes_of(corrected)
    }
    lines = {a.letter: Line(np.array(a.point_mm), np.array(a.direction)) for a in believed.axes}
    read = read_points(points, believed)
    measured = 1 + 6 + 5  # B and C at 0, then B, then C, of which one would be at 0 again
    best = best_offsets(
        TABLE_BC,
        lines,
        read.angles_deg[:measured],
        read.positions_mm[:measured],
        weight_z=np.sqrt(0.5),
    )
    for letter, line in best.items():
        assert found[letter].point == pytest.approx(line.point, abs=1e-5)
        assert found[letter].direction == pytest.approx(lines[letter].direction, abs=0.0)
    check = json.loads((tmp_path / "out.json").read_text())["runs"][1]["axes"]
    angles_deg, read_mm = read.angles_deg[measured:], read.positions_mm[measured:]
    off_mm = read_mm - readings(TABLE_BC, best, read_mm[0], np.zeros(3), angles_deg)
    for place, letter in enumerate("BC"):
        own = angles_deg[:, place] != 0.0
        expected_um = 1000.0 * np.sqrt(np.mean(np.sum(off_mm[own] ** 2, axis=1)))
        assert check[letter]["scatter_before_um"] == pytest.approx(expected_um, abs=0.05)
        assert expected_um > 2.0  # tilts are left


def test_where_there_are_no_tilts_mode_1_leaves_the_noise(tmp_path: Path) -> None:
    truth = tmp_path / "truth.toml"
    tilted = LOCATIONS.read_text(encoding="utf-8").splitlines()
    truth.write_text("\n".join(x for x in tilted if "arcsec" not in x), encoding="utf-8")
    text = (SAMPLES / "optimise_then_check.h").read_text(encoding="utf-8")
    program = program_of(tmp_path, text.replace("Q406=+2", "Q406=+1"))
    corrected = tmp_path / "corrected.toml"

    result = run(program, tmp_path, "--corrected", str(corrected), truth=truth)

    assert result.exit_code == 0, result.output
    b, c = (np.array(axis.point_mm) * 1000.0 for axis in axes_of(corrected))
    assert b == pytest.approx([-45.0, 0.0, 70.0], abs=1.0)
    assert c == pytest.approx([120.0, -80.0, 0.0], abs=1.0)
    optimised, checked = json.loads((tmp_path / "out.json").read_text())["runs"]
    q = optimised["q"]
    assert (q["Q141"], q["Q144"]) == (-1.0, -1.0)
    assert (q["Q147"], q["Q148"], q["Q149"]) == pytest.approx((0.12, -0.08, 0.07), abs=1e-3)
    assert all(0.1 < checked["axes"][letter]["scatter_before_um"] < 1.0 for letter in "BC")


@pytest.mark.parametrize("mode", ["2", "3"])
def test_modes_2_and_3_leave_the_noise_and_only_3_moves_a_datum(tmp_path: Path, mode: str) -> None:
    text = (SAMPLES / "optimise_then_check.h").read_text(encoding="utf-8")
    program = program_of(tmp_path, text.replace("Q406=+2", f"Q406=+{mode}"))
    corrected = tmp_path / "corrected.toml"

    result = run(program, tmp_path, "--corrected", str(corrected))

    assert result.exit_code == 0, result.output
    b, c = axes_of(corrected)
    boc_rad = np.radians(-10.0 / 3600.0)
    in_datum = mode == "3"
    if in_datum:
        assert c.direction[0] == pytest.approx(0.0, abs=1e-12)
    else:
        assert c.direction[0] == pytest.approx(boc_rad, abs=3e-6)
    assert b.datum_deg * 3600.0 == pytest.approx(-10.0 if in_datum else 0.0, abs=0.5)
    assert ("The machine datum of B moves by -" in result.output) == in_datum
    check = json.loads((tmp_path / "out.json").read_text())["runs"][1]["axes"]
    assert all(check[letter]["scatter_before_um"] < 1.0 for letter in "BC")


def test_one_position_an_axis_is_enough_for_a_rough_optimisation(tmp_path: Path) -> None:
    text = (SAMPLES / "optimise_positions.h").read_text(encoding="utf-8")
    few = text.replace("Q418=+4", "Q418=+1").replace("Q422=+3", "Q422=+1")
    corrected = tmp_path / "corrected.toml"

    result = run(program_of(tmp_path, few), tmp_path, "--corrected", str(corrected))

    assert result.exit_code == 0, result.output
    b, c = (np.array(axis.point_mm) * 1000.0 for axis in axes_of(corrected))
    assert b == pytest.approx([-45.0, 0.0, 70.0], abs=20.0)
    assert c == pytest.approx([120.0, -80.0, 0.0], abs=20.0)


HEAD_HEAD = """table = []
head = ["C", "A"]
tool_mm = [0, 0, 0]
[axes.C]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
[axes.A]
direction = [1, 0, 0]
point_mm = [0, 0, 250]
"""


def test_a_tilt_that_is_only_just_determined_is_not_corrected(tmp_path: Path) -> None:
    """The tip stands on the line of C, but for its offset: hardly anything tells its tilt."""
    machine, truth = tmp_path / "machine.toml", tmp_path / "truth.toml"
    machine.write_text(HEAD_HEAD, encoding="utf-8")
    truth.write_text("[axes.C]\nYOC_um = 90\nBOC_arcsec = 5\n", encoding="utf-8")
    text = (SAMPLES / "optimise_then_check.h").read_text(encoding="utf-8")
    text = text.replace("Q406=+0", "Q406=+2")  # the second time C is off the tip by its offset
    for b, a in (("Q415=-90", "Q411=-60"), ("Q416=+90", "Q412=+60"), ("Q417", "Q413")):
        text = text.replace(b, a)
    program = program_of(tmp_path, text.replace("Q418", "Q414"))
    corrected = tmp_path / "corrected.toml"

    more = ("--machine", str(machine), "--corrected", str(corrected))
    result = run(program, tmp_path, *more, truth=truth)

    assert result.exit_code == 0, result.output
    direction = read_machine(corrected).axes[0].direction
    assert np.hypot(*direction[:2]) < np.radians(30.0 / 3600.0)


def test_a_check_changes_nothing(tmp_path: Path) -> None:
    corrected = tmp_path / "corrected.toml"

    result = run(SAMPLES / "save_and_check.h", tmp_path, "--corrected", str(corrected))

    assert result.exit_code == 0, result.output
    assert read_machine(corrected) == read_machine(MACHINE)
    q = json.loads((tmp_path / "out.json").read_text())["runs"][0]["q"]
    assert q["Q142"] > 0.05
    assert {q["Q144"], q["Q145"], q["Q146"]} == {-1.0}
