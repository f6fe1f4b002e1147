"""``skiplatch kinematics run --from-points``: recorded centres instead of a simulated machine."""

import json
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from kinematics_programs import SAMPLES, TRUTH, without_charts
from rotary_machines import (
    TABLE_TABLE,
    Array,
    Kind,
    Line,
    Planted,
    best_offsets,
    centres,
    plant,
    positions,
    readings,
    write_machine,
    write_points,
)
from skiplatch.cli import main
from skiplatch.kinematics.machine import read_machine

PROGRAM = """11 TCH PROBE 451 MEASURE KINEMATICS ~
Q406={mode} ;MODE ~
Q407=+12.5 ;SPHERE RADIUS ~
{more}
Q411=-90 ;START ANGLE A AXIS ~
Q412=+90 ;END ANGLE A AXIS ~
Q414=+{points_a} ;MEAS. POINTS A AXIS ~
Q419=+45 ;START ANGLE C AXIS ~
Q420=+315 ;END ANGLE C AXIS ~
Q422=+7 ;MEAS. POINTS C AXIS
"""


def run(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    mode: str,
    *words: str,
    points_a: int = 7,
    more: str = "",
    has_charts: bool = False,
) -> int:
    text = PROGRAM.format(mode=mode, points_a=points_a, more=more)
    (folder / "program.h").write_text(text, encoding="utf-8")
    options = {
        "--machine": "machine.toml",
        "--from-points": "points.csv",
        "--corrected": "corrected.toml",
        "--json": "out.json",
    }
    files = [str(word) for key, name in options.items() for word in (key, folder / name)]
    program = str(folder / "program.h")
    monkeypatch.setattr("sys.argv", ["skiplatch", "kinematics", "run", program, *files, *words])
    charts = nullcontext() if has_charts else without_charts()
    with charts, pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def recorded(folder: Path, seed: int) -> tuple[Planted, Array, Array]:
    rng = np.random.default_rng(seed)
    planted = plant(TABLE_TABLE, rng)
    angles = positions(TABLE_TABLE)
    read_mm = centres(planted, angles, rng, 1e-4)
    write_machine(folder / "machine.toml", planted)
    write_points(folder / "points.csv", planted, angles, read_mm)
    return planted, angles, read_mm


def corrected(folder: Path) -> dict[str, Line]:
    axes = read_machine(folder / "corrected.toml").axes
    return {a.letter: Line(np.array(a.point_mm), np.array(a.direction)) for a in axes}


def assert_lines(found: dict[str, Line], points: dict[str, Line], turns: dict[str, Line]) -> None:
    for letter, line in found.items():
        assert np.allclose(line.point, points[letter].point, atol=3e-4)
        assert np.allclose(line.direction, turns[letter].direction, atol=3e-6)


def test_a_check_corrects_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planted, _, _ = recorded(tmp_path, 1)

    assert run(tmp_path, monkeypatch, "+0", has_charts=True) == 0

    assert_lines(corrected(tmp_path), planted.believed, planted.believed)
    result = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert result["parameters"].keys() == planted.errors.keys()
    log = (tmp_path / "TCHPRAUTO.html").read_text(encoding="utf-8")
    assert "14 recorded positions" in log  # of A and C, with one reference for each
    assert "42 of 56 positions measure no axis" in log
    assert (tmp_path / "TCHPRAUTO-1-EYC.svg").exists()


def test_mode_1_is_the_best_that_offsets_alone_can_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted, angles, read_mm = recorded(tmp_path, 1)

    assert run(tmp_path, monkeypatch, "+1") == 0

    # A centre's height comes from one touch, its place in the plane from four around it.
    best = best_offsets(TABLE_TABLE, planted.believed, angles, read_mm, weight_z=np.sqrt(0.5))
    found = corrected(tmp_path)
    for letter, line in best.items():
        assert found[letter].point == pytest.approx(line.point, abs=1e-6)
        assert found[letter].direction == pytest.approx(planted.believed[letter].direction)
        # Tilts of ±0.05° are not negligible: the true offsets would be something else.
        assert np.max(np.abs(line.point - planted.actual[letter].point)) > 0.002


def test_mode_2_corrects_points_and_directions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted, _, _ = recorded(tmp_path, 1)

    assert run(tmp_path, monkeypatch, "+2") == 0

    assert_lines(corrected(tmp_path), planted.actual, planted.actual)


@pytest.mark.parametrize("tilts_were_corrected", [False, True])
def test_mode_3_sets_the_datum_of_the_carrier_instead_of_a_tilt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, tilts_were_corrected: bool
) -> None:
    planted, angles, read_mm = recorded(tmp_path, 1)
    if tilts_were_corrected:
        assert run(tmp_path, monkeypatch, "+2") == 0
        (tmp_path / "corrected.toml").replace(tmp_path / "machine.toml")

    assert run(tmp_path, monkeypatch, "+3") == 0

    a, c = read_machine(tmp_path / "corrected.toml").axes
    assert c.direction[1] == pytest.approx(0.0, abs=1e-12)  # no AOC
    assert a.datum_deg * 3600.0 == pytest.approx(planted.errors["AOC"], abs=1.0)
    assert c.datum_deg == 0.0
    shown = angles + np.array([a.datum_deg, 0.0])  # the axes stand where they were measured
    lines = corrected(tmp_path)

    def read_from(sphere_mm: Array) -> Array:
        return readings(TABLE_TABLE, lines, sphere_mm, np.zeros(3), shown)

    origin = read_from(np.zeros(3))
    images = np.stack([np.ravel(read_from(e) - origin) for e in np.eye(3)], axis=1)
    left = np.linalg.lstsq(images, np.ravel(read_mm - origin), rcond=None)[1]
    assert np.sqrt(left[0] / read_mm.size) == pytest.approx(1e-4, rel=0.2)  # the noise


def test_a_mode_that_is_none_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    recorded(tmp_path, 2)

    assert run(tmp_path, monkeypatch, "+4") == 2

    said = capsys.readouterr().err
    assert "program.h:2:6: cycle 451: Q406 is above its upper limit (MODE: 0 to 3)" in said
    assert not (tmp_path / "corrected.toml").exists()
    assert not (tmp_path / "out.json").exists()


def refusal(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], mode: str
) -> str:
    assert run(folder, monkeypatch, mode) == 2
    assert not (folder / "corrected.toml").exists()
    assert not (folder / "TCHPRAUTO.html").exists()
    return capsys.readouterr().err


def test_mode_3_wants_stacked_axes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(1)
    planted = plant(Kind("C", "A"), rng)
    angles = positions(planted.kind)
    write_machine(tmp_path / "machine.toml", planted)
    write_points(tmp_path / "points.csv", planted, angles, centres(planted, angles, rng, 1e-4))

    said = refusal(tmp_path, monkeypatch, capsys, "+3")

    assert "mode 3 needs one rotary axis upon another" in said


@pytest.mark.parametrize(
    ("row", "mode", "phrase"),
    [
        ("has_kinematics_comp = false", "+2", "KinematicsComp (option 52)"),
        ("is_tcpm_on = true", "+1", "M128 or TCPM is on"),
        ("max_modification_mm = 0.01", "+1", "maxModification (204801) was not acknowledged"),
    ],
)
def test_the_rules_of_the_cycle_hold(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    row: str,
    mode: str,
    phrase: str,
) -> None:
    recorded(tmp_path, 1)
    with (tmp_path / "machine.toml").open("a", encoding="utf-8") as file:
        file.write(f"[control]\n{row}\n")

    assert phrase in refusal(tmp_path, monkeypatch, capsys, mode)


def test_a_large_change_is_made_once_acknowledged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted, _, _ = recorded(tmp_path, 1)
    with (tmp_path / "machine.toml").open("a", encoding="utf-8") as file:
        file.write("[control]\nmax_modification_mm = 0.01\n")

    assert run(tmp_path, monkeypatch, "+2", "--acknowledge") == 0

    assert_lines(corrected(tmp_path), planted.actual, planted.actual)
    assert "exceeds maxModification" in (tmp_path / "TCHPRAUTO.html").read_text(encoding="utf-8")


def test_an_axis_without_points_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted, _, _ = recorded(tmp_path, 1)

    assert run(tmp_path, monkeypatch, "+2", points_a=0) == 0

    found = corrected(tmp_path)
    assert np.array_equal(found["A"].point, planted.believed["A"].point)
    assert np.array_equal(found["A"].direction, planted.believed["A"].direction)
    assert not np.array_equal(found["C"].point, planted.believed["C"].point)


def test_one_point_an_axis_is_enough_for_the_offsets(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted = plant(TABLE_TABLE, np.random.default_rng(5))
    angles = np.array([[0.0, 0.0], [90.0, 0.0], [0.0, 90.0]])
    write_machine(tmp_path / "machine.toml", planted)
    read_mm = centres(planted, angles, np.random.default_rng(5), 1e-4)
    write_points(tmp_path / "points.csv", planted, angles, read_mm)

    assert run(tmp_path, monkeypatch, "+1") == 0

    for letter, line in corrected(tmp_path).items():  # all but what tilts of 0.05° make
        assert line.point == pytest.approx(planted.actual[letter].point, abs=0.3)


def test_results_and_backlash_come_from_the_sense_of_approach(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    backlash_deg = 0.01
    planted = plant(TABLE_TABLE, np.random.default_rng(7), scale=0.1)
    turns = np.array([45.0, 90.0, 180.0, 270.0])
    angles = np.array([[0.0, 0.0], *([0.0, t] for t in turns), *([0.0, t] for t in turns)])
    approach = np.array([1] * 5 + [-1] * 4)
    true_deg = angles + np.array([[0.0, backlash_deg]]) * (approach[:, None] < 0)
    read_mm = centres(planted, true_deg, np.random.default_rng(7), 1e-5)
    write_machine(tmp_path / "machine.toml", planted)
    rows = np.hstack([angles, read_mm, approach[:, None]])
    head = "a_deg,c_deg,x_mm,y_mm,z_mm,approach"
    np.savetxt(tmp_path / "points.csv", rows, fmt="%.9g", delimiter=",", header=head, comments="")

    assert run(tmp_path, monkeypatch, "+1", points_a=0, more="Q432=+0.5 ;BACKLASH ~") == 0

    one = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))["runs"][0]
    assert one["axes"]["C"]["backlash_arcsec"] == pytest.approx(3600.0 * backlash_deg, rel=2e-3)
    assert one["axes"]["C"]["scatter_after_um"] < 5.0  # of the first sense alone
    assert one["q"]["Q143"] > one["q"]["Q146"] > 0.0
    assert one["q"]["Q141"] == one["q"]["Q142"] == -1.0


def test_a_missing_reference_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    planted = plant(TABLE_TABLE, np.random.default_rng(5))
    angles = np.array([[0.0, 45.0], [0.0, 90.0], [0.0, 135.0]])
    write_machine(tmp_path / "machine.toml", planted)
    read_mm = centres(planted, angles, np.random.default_rng(5), 1e-4)
    write_points(tmp_path / "points.csv", planted, angles, read_mm)

    assert run(tmp_path, monkeypatch, "+1", points_a=0) == 2

    assert "axis C: no position at 0°, the reference" in capsys.readouterr().err


def test_what_a_simulated_cycle_wrote_is_evaluated_alike(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    played = ["--truth", str(TRUTH), "--html", str(tmp_path / "log.html")]
    common = ["--memory", str(tmp_path / "store.bin"), "--json"]
    points = str(tmp_path / "points.csv")
    program = str(SAMPLES / "optimise_positions.h")
    runs = []
    for name, more in (
        ("played", [*played, "--points", points]),
        ("again", ["--html", str(tmp_path / "log2.html"), "--from-points", points]),
    ):
        out = tmp_path / f"{name}.json"
        words = ["kinematics", "run", program, *more, *common, str(out)]
        monkeypatch.setattr("sys.argv", ["skiplatch", *words])
        with without_charts(), pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code in (0, None)
        runs.append(json.loads(out.read_text(encoding="utf-8"))["runs"][0])

    for letter in "BC":
        first, second = (one["axes"][letter] for one in runs)
        for name in ("scatter_before_um", "scatter_after_um", "backlash_arcsec", "radius_mm"):
            assert second[name] == pytest.approx(first[name], abs=2e-3)
