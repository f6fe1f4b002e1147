"""``skiplatch kinematics run --from-points``: recorded centres instead of a simulated machine."""

import json
from pathlib import Path

import numpy as np
import pytest

from rotary_machines import TABLE_TABLE, centres, plant, positions, write_machine, write_points
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


@pytest.mark.parametrize(
    ("mode", "points_corrected", "directions_corrected"),
    [("+0", False, False), ("+1", True, False), ("+2", True, True), ("+3", True, True)],
)
def test_the_mode_says_what_is_corrected(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    mode: str,
    points_corrected: bool,
    directions_corrected: bool,
) -> None:
    rng = np.random.default_rng(1)
    planted = plant(TABLE_TABLE, rng)
    angles = positions(TABLE_TABLE)
    write_machine(tmp_path / "machine.toml", planted)
    write_points(tmp_path / "points.csv", planted, angles, centres(planted, angles, rng, 1e-4))

    assert run(tmp_path, monkeypatch, mode) == 0

    result = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert result["parameters"].keys() == planted.errors.keys()
    for axis in read_machine(tmp_path / "corrected.toml").axes:
        true, before = planted.actual[axis.letter], planted.believed[axis.letter]
        wanted_point = true.point if points_corrected else before.point
        wanted_direction = true.direction if directions_corrected else before.direction
        assert np.allclose(axis.point_mm, wanted_point, atol=3e-4)
        assert np.allclose(axis.direction, wanted_direction, atol=3e-6)
    assert not (tmp_path / "TCHPRAUTO.html").exists()


def test_a_mode_that_is_none_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(2)
    planted = plant(TABLE_TABLE, rng)
    angles = positions(TABLE_TABLE)
    write_machine(tmp_path / "machine.toml", planted)
    write_points(tmp_path / "points.csv", planted, angles, centres(planted, angles, rng, 1e-4))

    assert run(tmp_path, monkeypatch, "+4") == 2

    assert "program.h:2:6: Q406: expected a mode from 0 to 3" in capsys.readouterr().err
    assert not (tmp_path / "corrected.toml").exists()
    assert not (tmp_path / "out.json").exists()
