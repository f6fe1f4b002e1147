"""No mode of cycle 451 leaves more than offsets alone would."""

import json
from pathlib import Path

import pytest

from kinematics_programs import evaluated, program_of, run
from kinematics_sweep import judge
from measured_machines import ALL_KINDS, name_of
from rotary_machines import Kind

FORK_HEAD = """table = []
head = ["C", "A"]
tool_mm = [0, 0, 0]
[axes.C]
direction = [0, 0, 1]
point_mm = [0, 0, 300]
[axes.A]
direction = [1, 0, 0]
point_mm = [0, 0, 250]
"""
FORK_HEAD_TRUTH = """[axes.C]
XOC_um = 120
YOC_um = 90
AOC_arcsec = 20
BOC_arcsec = -15
[axes.A]
YOA_um = 60
ZOA_um = -50
BOA_arcsec = 12
COA_arcsec = -18
"""
PROGRAM = """12 TCH PROBE 451 MEASURE KINEMATICS ~
Q406=+{mode} ;MODE ~
Q411=-60 ;START ANGLE A AXIS ~
Q412=+60 ;END ANGLE A AXIS ~
Q413=+{incidence} ;INCID. ANGLE A AXIS ~
Q414=+6 ;MEAS. POINTS A AXIS ~
Q419=-120 ;START ANGLE C AXIS ~
Q420=+180 ;END ANGLE C AXIS ~
Q422=+6 ;MEAS. POINTS C AXIS
"""


@pytest.mark.parametrize("incidence", [0, 45])
def test_a_fork_head_whose_tip_stands_on_the_turning_axis(tmp_path: Path, incidence: int) -> None:
    """With A at 0 an offset of C cannot be told from its tilt: the offset takes both."""
    machine, truth = tmp_path / "machine.toml", tmp_path / "truth.toml"
    machine.write_text(FORK_HEAD, encoding="utf-8")
    truth.write_text(FORK_HEAD_TRUTH, encoding="utf-8")
    left_um = {}
    for mode in (1, 2, 3):
        program = program_of(tmp_path, PROGRAM.format(mode=mode, incidence=incidence))
        result = run(program, tmp_path, "--machine", str(machine), truth=truth)
        assert result.exit_code == 0, result.output
        axes = json.loads((tmp_path / "out.json").read_text())["runs"][0]["axes"]
        left_um[mode] = {letter: axis["scatter_after_um"] for letter, axis in axes.items()}
        said = "XOC-1.454*BOC" in result.output and "offsets before tilts" in result.output
        assert said == (incidence == 0 and mode > 1)

    assert left_um[1]["A"] > 5.0
    for mode in (2, 3):
        assert all(left_um[mode][x] <= left_um[1][x] for x in "AC")
        assert max(left_um[mode].values()) < 1.5


@pytest.mark.parametrize("kind", ALL_KINDS, ids=name_of)
def test_modes_2_and_3_never_leave_more_than_mode_1(kind: Kind) -> None:
    judged = [judge(kind, seed) for seed in range(6)]

    assert max(one.more_um for one in judged) == 0.0
    assert max(one.left_um for one in judged) < 5.0


def test_a_tip_that_nobody_told_is_found_where_a_moved_datum_has_it(tmp_path: Path) -> None:
    """Mode 3 turns the zero of C with A at 45°: the tip has to be found with C as it shows then."""
    machine, truth = tmp_path / "machine.toml", tmp_path / "truth.toml"
    machine.write_text(FORK_HEAD.replace("tool_mm = [0, 0, 0]\n", ""), encoding="utf-8")
    truth.write_text(FORK_HEAD_TRUTH, encoding="utf-8")
    points = ("--machine", str(machine), "--points", str(tmp_path / "points.csv"))
    run(program_of(tmp_path, PROGRAM.format(mode=0, incidence=45)), tmp_path, *points, truth=truth)
    recorded = ("--machine", str(machine), "--from-points", str(tmp_path / "points.csv"))
    left_um = {}
    for mode in (2, 3):
        program = program_of(tmp_path, PROGRAM.format(mode=mode, incidence=45))
        result = evaluated(program, tmp_path, *recorded)
        assert result.exit_code == 0, result.output
        axes = json.loads((tmp_path / "out.json").read_text())["runs"][0]["axes"]
        left_um[mode] = [axes[letter]["scatter_after_um"] for letter in "AC"]

    assert max(left_um[2]) < 1.5
    assert left_um[3] == pytest.approx(left_um[2], abs=0.05)
