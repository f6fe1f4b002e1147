"""Cycle 452, preset compensation: another head, or a drift, found and put right."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from kinematics_programs import MACHINE, program_of, run
from skiplatch.cli import group
from skiplatch.errors import InputError
from skiplatch.kinematics.machine import Machine, RotaryAxis, read_machine
from skiplatch.kinematics.memory import format_machine, pack, unpack

DRIFT_UM = np.array([40.0, -25.0, 60.0])
TOOL = '0 BEGIN PGM X MM\n11 TOOL CALL "TOUCH_PROBE" Z\n'
FORK = """table = []
head = ["C", "A"]
tool_mm = [0, 0, -150]
[axes.C]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
[axes.A]
direction = [1, 0, 0]
point_mm = [0, 0, 0]
"""


def cycle(number: int, **given: float) -> str:
    counts = {"Q414": 0, "Q418": 0, "Q422": 0, "Q423": 3, "Q419": 90, "Q420": 270, **given}
    lines = [f"{name}={value:+g} ;X" for name, value in counts.items()]
    return f"12 TCH PROBE {number} X ~\n" + " ~\n".join(lines) + "\n"


def truth_of(path: Path, text: str) -> Path:
    path.write_text(f"sphere_mm = [120, 60, 80]\n{text}", encoding="utf-8")
    return path


def played(
    folder: Path, cycles: str, truth: str, changed: str, *more: str
) -> list[dict[str, object]]:
    result = run(
        program_of(folder, TOOL + cycles),
        folder,
        "--changed",
        str(truth_of(folder / "changed.toml", changed)),
        *more,
        truth=truth_of(folder / "truth.toml", truth),
    )
    assert result.exit_code == 0, (result.output, result.exception)
    runs: list[dict[str, object]] = json.loads((folder / "out.json").read_text())["runs"]
    return runs


def off_um(one: dict[str, object]) -> np.ndarray:
    return 1000.0 * np.array(one["preset_off_mm"])


def test_a_drift_of_the_tip_is_found_and_gone(tmp_path: Path) -> None:
    drift = f"tip_um = {DRIFT_UM.tolist()}\n"

    machine = ("--machine", str(plain_preset(tmp_path)))
    first, second = played(tmp_path, 2 * cycle(452), "", drift, *machine)

    np.testing.assert_allclose(off_um(first), -DRIFT_UM, atol=1.0)
    np.testing.assert_allclose(off_um(second), 0.0, atol=1.0)
    assert first["q"]["Q147"] == pytest.approx(-0.040, abs=0.001)  # type: ignore[index]
    assert first["q"]["Q142"] == -1.0  # type: ignore[index]


def test_the_preset_of_a_cycle_451_before_it_is_kept(tmp_path: Path) -> None:
    runs = played(tmp_path, cycle(451, Q418=2, Q431=2) + cycle(452), "", "")

    assert [one["cycle"] for one in runs] == [451, 452]
    np.testing.assert_allclose(off_um(runs[1]), 0.0, atol=1.0)


def test_the_preset_may_be_the_operators(tmp_path: Path) -> None:
    machine = tmp_path / "machine.toml"
    control = "\n[control]\npreset_miss_mm = [0.05, -0.03, 0.02]\n"
    machine.write_text(MACHINE.read_text() + control, encoding="utf-8")

    runs = played(tmp_path, cycle(452), "", "", "--machine", str(machine))

    np.testing.assert_allclose(off_um(runs[0]), [-50.0, 30.0, -20.0], atol=1.0)


def test_a_drift_of_the_tip_is_told_from_one_of_an_axis(tmp_path: Path) -> None:
    moved = f"tip_um = {DRIFT_UM.tolist()}\n[axes.C]\nXOC_um = 30\nYOC_um = -20\n"
    corrected = tmp_path / "corrected.toml"

    played(
        tmp_path,
        cycle(452, Q422=3),
        "",
        moved,
        "--machine",
        str(plain_preset(tmp_path)),
        "--corrected",
        str(corrected),
    )

    machine = read_machine(corrected)
    (_, axis) = machine.axes
    np.testing.assert_allclose(machine.tip_shift_mm, DRIFT_UM / 1000.0, atol=1e-3)
    np.testing.assert_allclose(axis.point_mm[:2], [0.030, -0.020], atol=1e-3)


def plain_preset(folder: Path) -> Path:
    machine = folder / "machine.toml"
    text = f"preset_mm = [120, 60, 80]\n{MACHINE.read_text()}"
    machine.write_text(text, encoding="utf-8")
    return machine


def test_another_head_is_right_though_its_carrier_was_not_measured(tmp_path: Path) -> None:
    """A fork that is changed behind C: the check turns C too, whose circle the new tip changes."""
    fork = tmp_path / "fork.toml"
    fork.write_text(f"preset_mm = [120, 60, 80]\n{FORK}", encoding="utf-8")
    x, y, z = DRIFT_UM
    head = f"tip_um = [{x}, {y}, {z}]\n[axes.A]\nYOA_um = {y + 15}\nZOA_um = {z - 8}\n"
    corrected = tmp_path / "corrected.toml"
    check = cycle(451, Q414=1, Q422=2, Q406=0)

    runs = played(
        tmp_path,
        cycle(452, Q414=2) + check,
        "",
        head,
        "--machine",
        str(fork),
        "--corrected",
        str(corrected),
    )

    seen = runs[1]["axes"]
    assert seen["C"]["scatter_before_um"] < 1.5  # type: ignore[index]
    assert seen["A"]["scatter_before_um"] < 1.5  # type: ignore[index]
    np.testing.assert_allclose(off_um(runs[0]), -DRIFT_UM, atol=1.0)
    carrier, carried = read_machine(corrected).axes
    assert carrier.point_mm == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(carried.point_mm[1:], [(y + 15) / 1e3, (z - 8) / 1e3], atol=1.5e-3)


def test_a_whole_head_has_moved_where_none_of_its_axes_was_measured(tmp_path: Path) -> None:
    fork = tmp_path / "fork.toml"
    fork.write_text(f"preset_mm = [120, 60, 80]\n{FORK}", encoding="utf-8")
    x, y, z = DRIFT_UM
    lines = f"[axes.C]\nXOC_um = {x}\nYOC_um = {y}\n[axes.A]\nYOA_um = {y}\nZOA_um = {z}\n"
    drift = f"tip_um = [{x}, {y}, {z}]\n{lines}"
    check = cycle(451, Q414=1, Q422=2, Q406=0)

    runs = played(tmp_path, cycle(452) + check, "", drift, "--machine", str(fork))

    seen = runs[1]["axes"]
    assert seen["C"]["scatter_before_um"] < 1.5  # type: ignore[index]
    assert seen["A"]["scatter_before_um"] < 1.5  # type: ignore[index]


def test_a_change_above_the_limit_wants_its_acknowledgement(tmp_path: Path) -> None:
    cycles = TOOL + cycle(452)
    program = program_of(tmp_path, cycles)
    changed = truth_of(tmp_path / "changed.toml", "tip_um = [1200, 0, 0]\n")
    more = ("--changed", str(changed))

    refused = run(program, tmp_path, *more)
    accepted = run(program, tmp_path, *more, "--acknowledge")

    assert "cycle 452: a change above maxModification" in str(refused.exception)
    assert accepted.exit_code == 0, accepted.output
    assert "exceeds maxModification" in accepted.output


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"Q406": 1}, "cycle 452: Q406 is no parameter of this cycle"),
        ({"Q431": 0}, "cycle 452: Q431 is no parameter of this cycle"),
        ({"Q423": 9}, "(NO. OF PROBE POINTS: 3 to 8)"),
        ({"Q421": 30}, "Q421: cycle 452 wants every axis at 0° that it does not measure"),
    ],
)
def test_a_bad_parameter_is_refused_where_it_stands(
    tmp_path: Path, more: dict[str, float], said: str
) -> None:
    result = run(program_of(tmp_path, TOOL + cycle(452, **more)), tmp_path)

    assert isinstance(result.exception, InputError)
    assert said in str(result.exception)
    assert not (tmp_path / "log.html").exists()


RECORDED = """c_deg,x_mm,y_mm,z_mm
0,10.03,0.01,-0.02
90,0.03,10.01,-0.02
180,-9.97,0.01,-0.02
270,0.03,-9.99,-0.02
"""


def recorded(folder: Path, machine: str) -> object:
    (folder / "points.csv").write_text(RECORDED, encoding="utf-8")
    (folder / "machine.toml").write_text(machine, encoding="utf-8")
    return CliRunner().invoke(
        group,
        [
            *("kinematics", "run", str(program_of(folder, TOOL + cycle(452, Q422=3)))),
            *("--from-points", str(folder / "points.csv"), "--html", str(folder / "log.html")),
            *("--machine", str(folder / "machine.toml"), "--json", str(folder / "out.json")),
            *("--memory", str(folder / "store.bin"), "--corrected", str(folder / "corrected.toml")),
        ],
    )


TABLE_C = 'table = ["C"]\n[axes.C]\ndirection = [0, 0, 1]\npoint_mm = [0, 0, 0]\n'


def test_a_drift_of_a_real_machine_is_compensated(tmp_path: Path) -> None:
    """The sphere on a circle of 10 mm that has moved with its centre: a drift of the tip alone."""
    result = recorded(tmp_path, f"preset_mm = [10, 0, 0]\n{TABLE_C}")

    assert result.exit_code == 0, result.output  # type: ignore[attr-defined]
    machine = read_machine(tmp_path / "corrected.toml")
    np.testing.assert_allclose(machine.tip_shift_mm, [-0.03, -0.01, 0.02], atol=1e-9)
    np.testing.assert_allclose(machine.axes[0].point_mm, 0.0, atol=1e-9)


def test_a_real_machine_has_to_tell_its_preset_and_the_tip_of_a_head(tmp_path: Path) -> None:
    unset = recorded(tmp_path, TABLE_C)
    head = TABLE_C.replace("table", "head")
    unknown = recorded(tmp_path, f"preset_mm = [10, 0, 0]\n{head}")

    assert "preset_mm of the machine's description is needed" in str(unset.exception)  # type: ignore[attr-defined]
    assert "tool_mm is needed" in str(unknown.exception)  # type: ignore[attr-defined]


def test_the_shift_of_the_tip_is_kept_in_store_and_file(tmp_path: Path) -> None:
    axes = tuple(RotaryAxis(x, True, (0.0, 0.0, 1.0), (1.0, 2.0, 3.0), (-9.0, 9.0)) for x in "CBA")
    machine = Machine(axes, (0.0, 0.0, -150.0), (0.04, -0.025, 0.06))
    path = tmp_path / "machine.toml"

    path.write_text(format_machine(read_machine(MACHINE)), encoding="utf-8")

    assert unpack(pack(machine)) == machine
    assert "tip_shift_mm = [0.04, -0.025, 0.06]" in format_machine(machine)
    assert "tip_shift_mm" not in path.read_text()


def test_the_log_tells_what_was_compensated(tmp_path: Path) -> None:
    played(
        tmp_path,
        cycle(452),
        "",
        f"tip_um = {DRIFT_UM.tolist()}\n",
        "--machine",
        str(plain_preset(tmp_path)),
    )

    page = (tmp_path / "log.html").read_text()
    assert "Cycle 452 PRESET COMPENSATION" in page
    assert "<dt>sphere off the preset, with every axis at 0</dt><dd>X -0.0" in page
    assert "<dt>shift of the tip, compensated</dt><dd>X +0.0" in page


def test_the_log_goes_to_stdout_and_words_aside(tmp_path: Path) -> None:
    program = program_of(tmp_path, TOOL + cycle(452, Q422=2))
    arguments = ["kinematics", "run", str(program), "--html", "-", "--memory"]

    result = CliRunner().invoke(group, [*arguments, str(tmp_path / "store.bin")])

    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("<!DOCTYPE html>")
    assert result.stdout.rstrip().endswith("</html>")
    assert ".svg</a>" not in result.stdout
    assert "cycle 452, preset compensation" in result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["program.h", "store.bin"]
