"""Cycle 453, kinematics grid: errors that depend on the position, found and compensated.

The machines here turn whole points about lines with matrices of their own, and wobble besides.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from kinematics_programs import SAMPLES, program_of, run
from measured_machines import described, lines_of
from rotary_machines import OWN, Array, Kind, Planted, plant, readings
from skiplatch.cli import group
from skiplatch.errors import InputError
from skiplatch.kinematics.axis_report import expected_mm
from skiplatch.kinematics.five_axis import Truth
from skiplatch.kinematics.machine import Machine, read_machine
from skiplatch.kinematics.memory import format_machine

TOOL = '0 BEGIN PGM X MM\n11 TOOL CALL "TOUCH_PROBE" Z\n'
AXES = """[axes.B]
direction = [0, 1, 0]
point_mm = [0, 0, -50]
[axes.C]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
"""
GRID = "[grid]\nB = [-40, 0, 40]\nC = [-180, -90, 0, 90, 180]\n"
WOBBLY = """sphere_mm = [120, 60, 80]
[axes.B]
twice_arcsec = 12
twice_phase_deg = 30
axial_um = 6
[axes.C]
once_arcsec = 10
radial_um = 5
"""
NODES = {
    "A": [-60.0, -30.0, 0.0, 30.0, 60.0],
    "B": [-60.0, -30.0, 0.0, 30.0, 60.0],
    "C": [-180.0, -150.0, -120.0, -60.0, -30.0, 0.0, 45.0, 90.0, 120.0, 150.0, 180.0],
}


def cycle(mode: int, number: int = 453, **given: float) -> str:
    parameters = {"Q406": mode, "Q423": 5, **given}
    lines = [f"{name}={value:+g} ;X" for name, value in parameters.items()]
    return f"12 TCH PROBE {number} KINEMATICS GRID ~\n" + " ~\n".join(lines) + "\n"


def machine_file(folder: Path, *more: str) -> Path:
    """Write a description; what stands before its tables comes first of `more`."""
    first, *rest = more or ("", GRID)
    path = folder / "machine.toml"
    path.write_text(f'table = ["B", "C"]\n{first}{AXES}{"".join(rest)}', encoding="utf-8")
    return path


def play(folder: Path, cycles: str, *more: str, machine: Path | None = None) -> Result:
    truth = folder / "truth.toml"
    truth.write_text(WOBBLY, encoding="utf-8")
    corrected = ("--corrected", str(folder / "corrected.toml"))
    described_in = ("--machine", str(machine or machine_file(folder)))
    program = program_of(folder, TOOL + cycles)
    return run(program, folder, *described_in, *corrected, *more, truth=truth)


def runs_of(folder: Path, result: Result) -> list[dict[str, object]]:
    assert result.exit_code == 0, (result.output, result.exception)
    runs: list[dict[str, object]] = json.loads((folder / "out.json").read_text())["runs"]
    return runs


def test_what_was_off_is_compensated_and_comes_back_when_deleted(tmp_path: Path) -> None:
    result = play(tmp_path, cycle(1) + cycle(0) + cycle(-1) + cycle(0))

    first, checked, _, again = runs_of(tmp_path, result)
    assert first["deviation_um"] > 10.0  # type: ignore[operator]
    assert checked["deviation_um"] < 1.5  # type: ignore[operator]
    assert again["deviation_um"] == pytest.approx(first["deviation_um"], abs=1.0)
    assert len(first["off_um"]) == 15  # type: ignore[arg-type]
    assert first["off_um"][0] == pytest.approx([0, 0, 0], abs=1e-6)  # type: ignore[index]
    assert read_machine(tmp_path / "corrected.toml").grid.offset_mm == ()  # type: ignore[union-attr]


def test_the_sample_is_compensated_after_its_axes_are_corrected(tmp_path: Path) -> None:
    sample, truth = SAMPLES / "compensate_grid.h", SAMPLES / "truth_bc_wobbly.toml"

    result = run(sample, tmp_path, "--machine", str(SAMPLES / "machine_bc_grid.toml"), truth=truth)

    axes, first, checked = runs_of(tmp_path, result)
    assert (axes["cycle"], first["mode"], checked["mode"]) == (451, 1, 0)
    assert first["deviation_um"] > 10.0  # type: ignore[operator]
    assert checked["deviation_um"] < 1.5  # type: ignore[operator]


def test_the_table_goes_on_in_the_next_program(tmp_path: Path) -> None:
    runs_of(tmp_path, play(tmp_path, cycle(1)))
    corrected = (tmp_path / "corrected.toml").rename(tmp_path / "next.toml")

    (checked,) = runs_of(tmp_path, play(tmp_path, cycle(0), "--seed", "2", machine=corrected))

    assert checked["deviation_um"] < 1.5  # type: ignore[operator]


def test_a_check_writes_no_table(tmp_path: Path) -> None:
    (checked,) = runs_of(tmp_path, play(tmp_path, cycle(0)))

    assert checked["deviation_um"] > 10.0  # type: ignore[operator]
    assert "offset_um" not in (tmp_path / "corrected.toml").read_text()


def test_cycle_451_measures_what_the_table_leaves(tmp_path: Path) -> None:
    """With the table active the axes go as straight lines say at its nodes."""
    measure = cycle(0, 451, Q418=3, Q415=-40, Q416=40, Q422=5, Q419=-180, Q420=180)

    before, _, after = runs_of(tmp_path, play(tmp_path, measure + cycle(1) + measure))

    for letter in "BC":
        scatter = [one["axes"][letter]["scatter_before_um"] for one in (before, after)]  # type: ignore[index]
        assert scatter[0] > 5.0
        assert scatter[1] < 1.5
    assert after["residual_um"] < 1.0  # type: ignore[operator]


def test_an_iso_program_says_the_same(tmp_path: Path) -> None:
    program = program_of(tmp_path, '%X G71 *\nN10 T "P" G17 *\nN20 G453 Q406=+0 Q423=5 *\n')
    truth = tmp_path / "truth.toml"
    truth.write_text(WOBBLY, encoding="utf-8")

    (checked,) = runs_of(
        tmp_path, run(program, tmp_path, "--machine", str(machine_file(tmp_path)), truth=truth)
    )

    assert checked["cycle"] == 453


def test_the_log_tells_deviations_and_where_the_greatest_is(tmp_path: Path) -> None:
    (found,) = runs_of(tmp_path, play(tmp_path, cycle(0)))

    page = (tmp_path / "log.html").read_text()
    _, b, c = np.array(found["greatest_at_deg"])
    assert "Cycle 453 KINEMATICS GRID, mode 0 = check the grid" in page
    assert f"<dt>standard deviation</dt><dd>{found['deviation_um'] / 1e3:.4f} mm</dd>" in page  # type: ignore[operator]
    assert f"<dt>greatest deviation</dt><dd>{found['greatest_um'] / 1e3:.4f} mm</dd>" in page  # type: ignore[operator]
    assert f"<dt>it stands at</dt><dd>B {b:g}°, C {c:g}°</dd>" in page
    assert "<dt>measuring positions</dt><dd>15, one with every axis at 0</dd>" in page


def test_a_change_above_the_limit_wants_its_acknowledgement(tmp_path: Path) -> None:
    machine = machine_file(tmp_path, "", GRID, "[control]\nmax_modification_mm = 0.005\n")

    refused = play(tmp_path, cycle(1), machine=machine)
    accepted = play(tmp_path, cycle(1), "--acknowledge", machine=machine)

    assert "cycle 453: a change above maxModification" in str(refused.exception)
    assert accepted.exit_code == 0, accepted.output
    assert "exceeds maxModification" in accepted.output


@pytest.mark.parametrize(
    ("cycles", "machine", "said"),
    [
        (cycle(2), ("", GRID), "4:6: cycle 453: Q406 is above its upper limit (MODE: -1 to 1)"),
        (cycle(0, Q411=5), ("", GRID), "cycle 453: Q411 is no parameter of this cycle"),
        (cycle(0, Q432=1), ("", GRID), "cycle 453: Q432 is no parameter of this cycle"),
        (cycle(0), ("",), "cycle 453 needs a grid of the machine's maker"),
        (
            cycle(0),
            ("", GRID, "[control]\nhas_kinematics_comp = false\n"),
            "cycle 453 needs KinematicsComp (option 52)",
        ),
        (
            cycle(-1),
            ("", GRID, "[control]\nhas_kinematics_opt = false\n"),
            "needs KinematicsOpt (option 48)",
        ),
        (cycle(0), ("", GRID, "[control]\nis_tcpm_on = true\n"), "M128 or TCPM is on"),
        (cycle(0), ("", GRID, "[control]\nhirth_deg = [0, 3, 0]\n"), "on the grids of Hirth"),
        (cycle(0, Q407=12), ("", GRID), "Q407: the measured radius of the sphere is off"),
    ],
)
def test_what_is_not_possible_is_refused(
    tmp_path: Path, cycles: str, machine: tuple[str, ...], said: str
) -> None:
    result = play(tmp_path, cycles, machine=machine_file(tmp_path, *machine))

    assert isinstance(result.exception, InputError)
    assert said in str(result.exception)
    assert not (tmp_path / "log.html").exists()
    assert not (tmp_path / "corrected.toml").exists()


@pytest.mark.parametrize(
    ("grid", "said"),
    [
        ("grid = 3\n", "grid: expected a table"),
        ("[grid]\nA = [0, 1]\n", "grid.A: expected an axis of the machine (B, C) or offset_um"),
        ("[grid]\nB = []\n", "grid.B: expected a list of 1 to 25 angles"),
        (f"[grid]\nB = [0, 1{'0' * 400}]\n", "grid.B: expected a list of 1 to 25 angles"),
        ("[grid]\nB = [0, 0]\n", "grid.B: expected rising angles, 0 among them"),
        ("[grid]\nB = [1, 2]\n", "grid.B: expected rising angles, 0 among them"),
        ("[grid]\nC = [-181, 0, 180]\n", "grid.C: expected angles within 360°"),
        ("[grid]\nC = [0]\n", "grid: expected 2 to 75 positions, got 1"),
        ("[grid]\nC = [0, 9]\noffset_um = [[0, 0, 0]]\n", "expected 2 rows of X, Y and Z"),
        ('[grid]\nC = [0, 9]\noffset_um = [[0, 0, 0], [0, 0, "1"]]\n', "expected 2 rows"),
    ],
)
def test_a_wrong_grid_is_named_with_its_place(tmp_path: Path, grid: str, said: str) -> None:
    is_table = grid.startswith("[")
    machine = machine_file(tmp_path, "", grid) if is_table else machine_file(tmp_path, grid)

    with pytest.raises(InputError) as raised:
        read_machine(machine)

    assert said in str(raised.value)
    assert raised.value.line is not None


def wobble_mm(angles_deg: Array) -> Array:
    """How a machine is off that no straight line describes: also both axes together."""
    first, second = np.radians(angles_deg).T
    return 1e-3 * np.stack(
        [
            9.0 * np.sin(first) ** 2 + 4.0 * (1.0 - np.cos(second)),
            6.0 * np.sin(first) * np.sin(second),
            3.0 * np.sin(2.0 * second) - 5.0 * np.sin(first),
        ],
        axis=1,
    )


def read_mm(planted: Planted, machine: Machine, angles_deg: Array) -> Array:
    """Read a machine whose axes are where `machine` has them, by own matrices, and wobble."""
    lines = lines_of(machine)
    read = readings(planted.kind, lines, planted.sphere, planted.tip, angles_deg)
    return read + wobble_mm(angles_deg)


def grid_angles(kind: Kind) -> Array:
    axes = [NODES[letter] for letter in kind.axes]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def recorded(folder: Path, kind: Kind, seed: int, drop: int = 0) -> tuple[Planted, Machine, Result]:
    """Let cycle 453 evaluate what a machine of own matrices reads at the grid, in any order."""
    rng = np.random.default_rng(seed)
    planted = plant(kind, rng)
    machine = described(planted)
    angles = rng.permutation(grid_angles(kind))[drop:]
    rows = np.hstack([angles, read_mm(planted, machine, angles)])
    names = [*(f"{letter.lower()}_deg" for letter in kind.axes), "x_mm", "y_mm", "z_mm"]
    text = "\n".join([",".join(names), *(",".join(f"{v:.9f}" for v in row) for row in rows)])
    (folder / "points.csv").write_text(text + "\n", encoding="utf-8")
    grid = "".join(f"{letter} = {NODES[letter]}\n" for letter in kind.axes)
    description = f"{format_machine(machine)}\n[grid]\n{grid}"
    (folder / "machine.toml").write_text(description, encoding="utf-8")
    result = CliRunner().invoke(
        group,
        [
            *("kinematics", "run", str(program_of(folder, TOOL + cycle(1)))),
            *("--from-points", str(folder / "points.csv"), "--html", str(folder / "log.html")),
            *("--machine", str(folder / "machine.toml"), "--json", str(folder / "out.json")),
            *("--memory", str(folder / "store.bin"), "--corrected", str(folder / "corrected.toml")),
        ],
    )
    return planted, machine, result


def off_mm(planted: Planted, machine: Machine, active: Machine, angles_deg: Array) -> Array:
    """How far the control, with what is active, is off a wobbling machine; shape (n,)."""
    shown = np.zeros((len(angles_deg), 3))
    shown[:, [OWN[letter] for letter in planted.kind.axes]] = angles_deg
    expected = expected_mm(active, Truth(), planted.sphere, shown)
    return np.asarray(np.linalg.norm(read_mm(planted, machine, angles_deg) - expected, axis=1))


@pytest.mark.parametrize("kind", [Kind("AC", ""), Kind("", "CA"), Kind("C", "B")], ids=str)
def test_a_real_machine_is_compensated_at_the_nodes_and_between(tmp_path: Path, kind: Kind) -> None:
    planted, machine, result = recorded(tmp_path, kind, 7)

    assert result.exit_code == 0, (result.output, result.exception)
    active = read_machine(tmp_path / "corrected.toml")
    nodes = grid_angles(kind)
    np.testing.assert_allclose(off_mm(planted, machine, active, nodes), 0.0, atol=1e-6)
    rng = np.random.default_rng(3)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    between = rng.uniform(low, high, (200, 2))
    before = off_mm(planted, machine, machine, between)
    after = off_mm(planted, machine, active, between)
    # A chord of 60° of a sine is off by 13 % of its height at most, of two axes by twice that.
    assert np.sqrt(np.mean(after**2)) < 0.2 * np.sqrt(np.mean(before**2))


def test_what_was_found_is_what_was_planted(tmp_path: Path) -> None:
    planted, _, result = recorded(tmp_path, Kind("AC", ""), 11)

    (found,) = runs_of(tmp_path, result)
    angles = np.array(found["angle_deg"])[:, [0, 2]]
    np.testing.assert_allclose(np.array(found["off_um"]), 1e3 * wobble_mm(angles), atol=1e-3)
    size = np.linalg.norm(1e3 * wobble_mm(angles), axis=1)
    assert found["greatest_um"] == pytest.approx(size.max(), abs=1e-3)
    assert found["deviation_um"] == pytest.approx(np.sqrt(np.mean(size[1:] ** 2)), abs=1e-3)
    assert planted.kind.axes == "AC"


def test_a_real_machine_lacks_no_position_of_the_grid(tmp_path: Path) -> None:
    _, _, result = recorded(tmp_path, Kind("AC", ""), 7, drop=1)

    assert "cycle 453: no recorded position at A " in str(result.exception)
    assert not (tmp_path / "corrected.toml").exists()


def test_cycle_450_leaves_the_table_alone(tmp_path: Path) -> None:
    save, restore = (
        f"12 TCH PROBE 450 X ~\nQ410={mode} ;X ~\nQ409=1 ;X\n" for mode in ("+0", "+1")
    )

    runs_of(tmp_path, play(tmp_path, save + cycle(1) + restore))

    grid = read_machine(tmp_path / "corrected.toml").grid
    assert grid is not None
    assert len(grid.offset_mm) == 15


def test_a_description_is_written_as_it_was_read(tmp_path: Path) -> None:
    runs_of(tmp_path, play(tmp_path, cycle(1)))
    machine = read_machine(tmp_path / "corrected.toml")

    (tmp_path / "again.toml").write_text(format_machine(machine), encoding="utf-8")

    assert read_machine(tmp_path / "again.toml") == machine
