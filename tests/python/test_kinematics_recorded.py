"""``skiplatch kinematics run --from-points``: recorded centres instead of a simulated machine."""

import json
from pathlib import Path

import numpy as np
import pytest

from rotary_machines import (
    TABLE_TABLE,
    Array,
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
Q407=+12.5 ;SPHERE RADIUS
"""


def run(folder: Path, monkeypatch: pytest.MonkeyPatch, mode: str) -> int:
    (folder / "program.h").write_text(PROGRAM.format(mode=mode), encoding="utf-8")
    options = {
        "--machine": "machine.toml",
        "--from-points": "points.csv",
        "--corrected": "corrected.toml",
        "--json": "out.json",
    }
    words = [str(word) for key, name in options.items() for word in (key, folder / name)]
    program = str(folder / "program.h")
    monkeypatch.setattr("sys.argv", ["skiplatch", "kinematics", "run", program, *words])
    with pytest.raises(SystemExit) as ended:
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

    assert run(tmp_path, monkeypatch, "+0") == 0

    assert_lines(corrected(tmp_path), planted.believed, planted.believed)
    result = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert result["parameters"].keys() == planted.errors.keys()
    assert not (tmp_path / "TCHPRAUTO.html").exists()


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

    assert "program.h:2:6: Q406: expected 0 to 3, a whole number" in capsys.readouterr().err
    assert not (tmp_path / "corrected.toml").exists()
    assert not (tmp_path / "out.json").exists()
