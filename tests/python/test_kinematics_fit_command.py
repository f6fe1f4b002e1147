"""``skiplatch kinematics fit``: the contract for outside scripts, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from rotary_machines import (
    HEAD_HEAD,
    TABLE_TABLE,
    Kind,
    Planted,
    centres,
    plant,
    positions,
    write_machine,
    write_points,
)
from skiplatch.cli import main

GOOD_MACHINE = """table = ["A", "C"]
head = []

[axes.A]
direction = [1, 0, 0]
point_mm = [0, 0, 0]
[axes.C]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
"""
GOOD_POINTS = "a_deg,c_deg,x_mm,y_mm,z_mm\n0,0,100,0,10\n0,90,0,100,10\n0,180,-100,0,10\n"


def run(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    monkeypatch.setattr("sys.argv", ["skiplatch", "kinematics", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def written(folder: Path, kind: Kind, seed: int) -> Planted:
    rng = np.random.default_rng(seed)
    planted = plant(kind, rng)
    write_machine(folder / "machine.toml", planted)
    angles = positions(kind)
    write_points(folder / "points.csv", planted, angles, centres(planted, angles, rng, 1e-3))
    return planted


def fitted(folder: Path, monkeypatch: pytest.MonkeyPatch, *options: str) -> dict[str, object]:
    out = folder / "out.json"
    arguments = (folder / "points.csv", "--machine", folder / "machine.toml", "--json", out)
    assert run(monkeypatch, "fit", *arguments, *options) == 0
    return dict(json.loads(out.read_text(encoding="utf-8")))


def test_the_contract_for_outside_scripts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planted = written(tmp_path, TABLE_TABLE, 1)
    result = fitted(tmp_path, monkeypatch)

    parameters = result["parameters"]
    assert isinstance(parameters, dict)
    assert parameters.keys() == planted.errors.keys()
    for name, parameter in parameters.items():
        assert parameter.keys() == {"value", "uncertainty", "unit"}
        assert parameter["unit"] == ("µm" if name[0] in "XYZ" else "arcsec")
        assert abs(parameter["value"] - planted.errors[name]) <= 3.0 * parameter["uncertainty"]
    assert result["residual_um"] == pytest.approx(1.0, rel=0.2)
    undetermined = result["undetermined"]
    assert isinstance(undetermined, list)
    assert undetermined[1] == "COC"
    assert undetermined[0].startswith("AOA")
    assert "recommended" not in result


def test_a_head_leaves_its_pivot_open_and_says_what_would_tell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    written(tmp_path, HEAD_HEAD, 2)
    result = fitted(tmp_path, monkeypatch, "--recommend")

    assert {"XOC", "ZOA"} <= set(result["undetermined"])  # type: ignore[call-overload]
    assert result["recommended"]["positions"] == []  # type: ignore[index]
    assert "tool_mm would say it" in capsys.readouterr().out


def test_a_known_tip_determines_the_pivot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planted = written(tmp_path, HEAD_HEAD, 3)
    path = tmp_path / "machine.toml"
    text = path.read_text(encoding="utf-8")
    path.write_text(f"tool_mm = {planted.tip.tolist()}\n{text}", encoding="utf-8")
    parameters = fitted(tmp_path, monkeypatch)["parameters"]

    assert isinstance(parameters, dict)
    assert parameters.keys() == planted.errors.keys()
    for name, parameter in parameters.items():
        assert abs(parameter["value"] - planted.errors[name]) <= 4.0 * parameter["uncertainty"]


def test_positions_are_recommended_within_the_travel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = GOOD_MACHINE.replace("[axes.C]", "range_deg = [-20, 45]\n[axes.C]")
    (tmp_path / "machine.toml").write_text(machine, encoding="utf-8")
    (tmp_path / "points.csv").write_text(GOOD_POINTS, encoding="utf-8")
    recommended = fitted(tmp_path, monkeypatch, "--recommend")["recommended"]

    assert isinstance(recommended, dict)
    assert recommended["undetermined"] == []
    assert len(recommended["positions"]) >= 2
    assert all(-20.0 <= p["a_deg"] <= 45.0 for p in recommended["positions"])
    assert "further positions to measure" in capsys.readouterr().out


def test_columns_may_stand_in_any_order_among_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "machine.toml").write_text(GOOD_MACHINE, encoding="utf-8")
    rows = [line.split(",") for line in GOOD_POINTS.split()]
    text = "\n".join(",".join([*reversed(row), "note"]) for row in rows)
    (tmp_path / "points.csv").write_text(text, encoding="utf-8")
    parameters = fitted(tmp_path, monkeypatch)["parameters"]

    assert isinstance(parameters, dict)
    assert parameters["XOC"]["value"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("x_mm", "x_m", 'points.csv:1: x_mm: column missing; did you mean "x_m"?'),
        ("a_deg,", "", "points.csv:1: a_deg: column missing"),
        ("a_deg", "b_deg", "points.csv:1: b_deg: the machine has no axis B"),
        ("y_mm", "x_mm", "points.csv:1: x_mm: the column stands here twice"),
        (
            "0,90,0",
            "0,90,nan",
            'points.csv:3: x_mm: expected a number in mm, at most 1e+06, got "n',
        ),
        ("0,90,0", "0,inf,0", "points.csv:3: c_deg: expected a number in deg"),
        ("0,90,0", "0,90,1e7", "points.csv:3: x_mm: expected a number in mm"),
        ("0,90,0", "0,90,", "points.csv:3: x_mm: expected a number in mm"),
        ("0,90,0,", "0,90,", "points.csv:3: expected 5 cells, got 4"),
        ("0,90,0,100,10\n0,180,-100,0,10\n", "", "points.csv:2: 1 position: too few"),
        (GOOD_POINTS, "a_deg,c_deg,x_mm,y_mm,z_mm\n", "points.csv:1: 0 positions: too few"),
        (GOOD_POINTS, "", "points.csv: empty; expected a header"),
        ("180,-100,0,10", "180,-90000,0,10", "points.csv:4: the points fit no machine"),
        (
            "[1, 0, 0]",
            "[1, 0, 0.1]",
            "machine.toml:5:13: axes.A.direction: expected a unit vector, go",
        ),
        (
            "[1, 0, 0]",
            "[0, 0, 1]",
            "machine.toml:5:13: axes.A.direction: axis A has to turn about X",
        ),
        ("[1, 0, 0]", "[1, 0]", "machine.toml:5:13: axes.A.direction: expected a list of 3"),
        (
            "[1, 0, 0]",
            "[nan, 0, 0]",
            "machine.toml:5:13: axes.A.direction: expected a list of 3 fini",
        ),
        (
            "[1, 0, 0]",
            '["1", 0, 0]',
            "machine.toml:5:13: axes.A.direction: expected a list of 3 fini",
        ),
        (
            "[0, 0, 0]",
            "[0, 0, 1e6]",
            "machine.toml:6:12: axes.A.point_mm: expected coordinates of at",
        ),
        ("point_mm", "points_mm", "axes.A.points_mm: unknown key; did you mean"),
        ("direction = [1, 0, 0]\n", "", 'machine.toml:4:2: axes.A: missing key "direction"'),
        ('["A", "C"]', '["A", "D"]', "machine.toml:1:9: table: expected a list of"),
        (
            '["A", "C"]',
            '["A", "C", "A"]',
            "machine.toml:1:9: table: axis A stands in the chain twice",
        ),
        ("head = []", 'head = ["C"]', "axis C stands in the chain twice"),
        ('["A", "C"]', '["A"]', 'machine.toml:7:2: axes.C: axis "C" is neither in "table" nor'),
        ("head = []", 'head = ["B"]', "axes.B: axis B has no table [axes.B]"),
        ('["A", "C"]', "[]", "machine.toml:1:9: table: expected at least one axis"),
        (
            "point_mm",
            "datum_deg = 400\npoint_mm",
            "machine.toml:6:13: axes.A.datum_deg: expected a number of at most 360",
        ),
        (
            "point_mm",
            f"datum_deg = 1{'0' * 400}\npoint_mm",
            "machine.toml:6:13: axes.A.datum_deg: expected a number of at most 360",
        ),
        ("head = []", "tool_mm = 3", "machine.toml:2:11: tool_mm: expected a list of 3"),
        ("head = []", "heads = []", "machine.toml:2:9: heads: unknown key; did you mean"),
        (
            "head = []",
            'sphere = "blue"',
            "machine.toml:2:10: sphere: unknown key; expected one of ",
        ),
        ("point_mm", "colour = 3\npoint_mm", "axes.A.colour: unknown key; expected one of direc"),
        ("head = []", "head = [", "machine.toml:4"),
        (
            "[axes.C]",
            "range_deg = [10, -10]\n[axes.C]",
            "machine.toml:7:13: axes.A.range_deg: expected the lowest and the highest",
        ),
    ],
)
def test_bad_input_is_named(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    old: str,
    new: str,
    message: str,
) -> None:
    """In the points, or where it does not stand in them, in the machine."""
    points, machine = (
        (GOOD_POINTS.replace(old, new, 1), GOOD_MACHINE)
        if old in GOOD_POINTS
        else (GOOD_POINTS, GOOD_MACHINE.replace(old, new, 1))
    )
    (tmp_path / "machine.toml").write_text(machine, encoding="utf-8")
    (tmp_path / "points.csv").write_text(points, encoding="utf-8")
    out = tmp_path / "out.json"
    arguments = (tmp_path / "points.csv", "--machine", tmp_path / "machine.toml", "--json", out)

    assert (points, machine) != (GOOD_POINTS, GOOD_MACHINE)
    assert run(monkeypatch, "fit", *arguments) == 2
    assert not out.exists()
    text = capsys.readouterr().err
    assert text.count("\n") == 1
    assert message in text
