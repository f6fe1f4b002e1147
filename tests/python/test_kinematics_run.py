"""NC programs with cycles 450 and 451, run on the simulated machine, and their log."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from click.testing import CliRunner, Result

from rotary_machines import Kind, Line, best_offsets, readings
from skiplatch.cli import group
from skiplatch.errors import InputError
from skiplatch.figures import theme
from skiplatch.kinematics.machine import RotaryAxis, read_machine
from skiplatch.kinematics.memory import Memory, StoreRefusedError, format_machine, pack, unpack
from skiplatch.kinematics.points import read_points
from skiplatch.kinematics.program import Program, read_program, texts

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples" / "kinematics"
MACHINE = SAMPLES / "machine_bc.toml"
LOCATIONS = SAMPLES / "truth_bc_locations.toml"
TRUTH = SAMPLES / "truth_bc.toml"
TABLE_BC = Kind("BC", "")


def program_of(folder: Path, text: str) -> Path:
    path = folder / "program.h"
    path.write_text(text, encoding="utf-8")
    return path


def run(program: Path, folder: Path, *more: str, truth: Path = LOCATIONS) -> Result:
    files = {"--html": "log.html", "--memory": "store.bin", "--json": "out.json"}
    options = [text for flag, name in files.items() for text in (flag, str(folder / name))]
    arguments = ["kinematics", "run", str(program), "--truth", str(truth), *options, *more]
    return CliRunner().invoke(group, arguments)


def axes_of(path: Path) -> tuple[RotaryAxis, ...]:
    return read_machine(path).axes


def test_programs_are_read_as_the_document_prints_them() -> None:
    first = read_program(SAMPLES / "save_and_check.h")
    second = read_program(SAMPLES / "optimise_positions.h")

    assert first.tool == second.tool == "TOUCH_PROBE"
    assert [cycle.number for cycle in first.cycles] == [450, 451]
    assert next(texts(first)) == "TCH PROBE 450 Q410=+0 Q409=+5"
    expected = (
        "TCH PROBE 451 Q406=+1 Q407=+12.5 Q320=+0 Q408=+0 Q253=+750 Q380=+0 Q411=-90 Q412=+90 "
        "Q413=+0 Q414=+0 Q415=-90 Q416=+90 Q417=+0 Q418=+4 Q419=+90 Q420=+270 Q421=+0 Q422=+3 "
        "Q423=+3 Q431=+1 Q432=+0.5"
    )
    assert list(texts(second)) == [expected]


def test_parameters_may_stand_with_their_comment_or_without(tmp_path: Path) -> None:
    text = '12 TCH PROBE 450 SAVE ~\n  Q410=+0 ;MODE ~\nQS409="old one"~\nQ9=-.5\n'

    program: Program = read_program(program_of(tmp_path, text))

    (cycle,) = program.cycles
    assert {n: v.value for n, v in cycle.parameters.items()} == {410: 0.0, 409: "old one", 9: -0.5}
    assert (cycle.parameters[410].line, cycle.parameters[410].column) == (2, 8)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no TCH PROBE cycle"),
        ("12 TCH PROBE 452 X\n", ":1:4: expected cycle 450 or 451, got 452"),
        ("12 L X+0\n", ":1:4: expected a block"),
        ("12 TCH PROBE 450 X ~\n", ':1:20: expected a parameter such as "Q406=+0" after "~"'),
        ("12 TCH PROBE 450 X ~\nQ410=1,5\n", ':2:6: expected a number, got "1,5"'),
        ("12 TCH PROBE 450 X ~\nQ410=nan\n", ':2:6: expected a number, got "nan"'),
        ("12 TCH PROBE 450 X ~\nQ410=1 ~\nQ410=2\n", ":3:1: Q410 is given twice, first in line 2"),
        ("12 TCH PROBE 450 X ~\nQ410=1 MODE\n", ':2:7: expected ";" and a comment'),
    ],
)
def test_a_slip_is_named_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        read_program(program_of(tmp_path, text))


def test_limits_are_told_as_exactly_as_they_are(tmp_path: Path) -> None:
    text = (SAMPLES / "optimise_positions.h").read_text(encoding="utf-8")

    result = run(program_of(tmp_path, text.replace("Q419=+90", "Q419=+360")), tmp_path)

    assert "(START ANGLE C AXIS: -359.9999 to 359.9999)" in str(result.exception)


def test_a_refused_parameter_is_named_where_it_stands(tmp_path: Path) -> None:
    text = (SAMPLES / "optimise_positions.h").read_text(encoding="utf-8")
    program = program_of(tmp_path, text.replace("Q423=+3", "Q423=+9"))
    line = text[: text.index("Q423")].count("\n") + 1

    result = run(program, tmp_path)

    assert isinstance(result.exception, InputError)
    assert f":{line}:6: cycle 451: Q423" in str(result.exception)
    assert not (tmp_path / "log.html").exists()


def test_bad_input_is_one_line_and_status_2(tmp_path: Path) -> None:
    program = program_of(tmp_path, "12 TCH PROBE 450 X ~\nQ410=x\n")
    command = [sys.executable, "-m", "skiplatch.cli", "kinematics", "run", str(program)]

    done = subprocess.run(command, capture_output=True, text=True, check=False)

    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1


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
    assert c.direction[0] == pytest.approx(0.0 if in_datum else boc_rad, abs=1e-12 + 3e-6)
    assert b.datum_deg * 3600.0 == pytest.approx(-10.0 if in_datum else 0.0, abs=0.5)
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


def test_backlash_of_each_axis_comes_back(tmp_path: Path) -> None:
    result = run(SAMPLES / "optimise_positions.h", tmp_path, truth=TRUTH)

    assert result.exit_code == 0, result.output
    axes = json.loads((tmp_path / "out.json").read_text())["runs"][0]["axes"]
    assert axes["B"]["backlash_arcsec"] == pytest.approx(6.0, abs=0.8)
    assert axes["C"]["backlash_arcsec"] == pytest.approx(4.0, abs=0.8)


def test_backlash_that_is_measured_does_not_bias_the_location_errors(tmp_path: Path) -> None:
    """B comes to its zero from the same side while C is measured: else BOC would be 6″ off."""
    planted = {"XOB": -45, "ZOB": 70, "AOB": 12, "COB": -18, "XOC": 120, "YOC": -80, "AOC": 20}

    result = run(SAMPLES / "optimise_then_check.h", tmp_path, truth=TRUTH)

    assert result.exit_code == 0, result.output
    measured, checked = json.loads((tmp_path / "out.json").read_text())["runs"]
    for name, value in {**planted, "BOC": -10}.items():
        found = measured["parameters"][name]
        assert abs(found["value"] - value) <= 3.0 * found["uncertainty"], name
    assert measured["parameters"]["BOC"]["uncertainty"] < 0.5
    assert all(measured["axes"][x]["scatter_after_um"] < 1.0 for x in "BC")
    # The check approaches its positions as they come: there the backlash is to be seen.
    assert any(checked["axes"][x]["scatter_before_um"] > 1.5 for x in "BC")
    assert result.output.count("Backlash was not measured (Q432 = 0)") == 1


def test_recorded_points_give_the_same_location_errors(tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    run(SAMPLES / "save_and_check.h", tmp_path, "--points", str(points))

    fit = ["kinematics", "fit", str(points), "--machine", str(MACHINE), "--touches", "4"]
    result = CliRunner().invoke(group, [*fit, "--json", str(tmp_path / "fit.json")])

    assert result.exit_code == 0, result.output
    assert len(read_points(points, read_machine(MACHINE))) == 5
    fitted = json.loads((tmp_path / "fit.json").read_text())["parameters"]
    logged = json.loads((tmp_path / "out.json").read_text())["runs"][0]["parameters"]
    assert fitted.keys() == logged.keys()
    for name, estimate in fitted.items():
        assert estimate["value"] == pytest.approx(logged[name]["value"], abs=0.01)


def test_a_change_above_the_limit_waits_for_nc_start(tmp_path: Path) -> None:
    far = tmp_path / "far.toml"
    far.write_text("[axes.C]\nXOC_um = 2500\n", encoding="utf-8")

    refused = run(SAMPLES / "optimise_positions.h", tmp_path, truth=far)
    pressed = run(SAMPLES / "optimise_positions.h", tmp_path, "--acknowledge", truth=far)

    assert isinstance(refused.exception, InputError)
    assert pressed.exit_code == 0
    assert "exceeds maxModification" in pressed.output


def test_the_store_keeps_restores_and_deletes(tmp_path: Path) -> None:
    machine = read_machine(MACHINE)
    memory = Memory(tmp_path / "store.bin")
    memory.activate(machine)

    memory.run(0.0, "before")
    memory.run(0.0, 5.0)
    assert Memory(tmp_path / "store.bin").names() == ["5", "before"]
    assert memory.run(1.0, "before") == machine
    memory.run(3.0, "before")
    assert memory.names() == ["5"]
    with pytest.raises(StoreRefusedError):
        memory.run(1.0, "before")


def test_a_description_survives_store_and_file(tmp_path: Path) -> None:
    machine = read_machine(MACHINE)
    b, c = machine.axes
    machine = replace(machine, axes=(replace(b, datum_deg=-0.0123), c))
    path = tmp_path / "machine.toml"
    path.write_text(format_machine(machine), encoding="utf-8")

    assert unpack(pack(machine)) == machine
    assert read_machine(path) == machine


def test_a_description_of_another_version_is_refused() -> None:
    with pytest.raises(StoreRefusedError, match="another version"):
        unpack(pack(read_machine(MACHINE))[:-1])


def test_a_foreign_file_is_no_store(tmp_path: Path) -> None:
    path = tmp_path / "store.bin"
    path.write_bytes(b"something else")

    with pytest.raises(InputError, match="no store of kinematics"):
        Memory(path)
    assert path.read_bytes() == b"something else"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[axes.C]\nXOB_um = 1\n", "2:1: axes.C.XOB_um: unknown key"),
        ("[axes.C]\nbacklash_arcsec = -1\n", "axes.C.backlash_arcsec: expected a number of at"),
        ("[axes.A]\nYOA_um = 1\n", "axes.A: expected a table of an axis of the machine"),
        ("sphere_mm = [1, 2]\n", "sphere_mm: expected a list of 3 numbers"),
        ("sphere_radius_mm = 0\n", "sphere_radius_mm: expected a number above 0"),
    ],
)
def test_a_slip_in_the_truth_is_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "truth.toml"
    path.write_text(text, encoding="utf-8")

    result = run(SAMPLES / "save_and_check.h", tmp_path, truth=path)

    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("is_tcpm_on = true", "cycle 451: "),
        ("has_kinematics_comp = false", "cycle 451: Q406"),
        ("max_dev_cal_ball_mm = -1", "16:1: control.max_dev_cal_ball_mm: expected a number from 0"),
        ("is_tcpm_on = 1", "16:1: control.is_tcpm_on: expected true or false"),
        ("hirth_deg = [0, -3, 0]", "16:1: control.hirth_deg: expected a list of 3 numbers from 0"),
        ("hirth_dg = 3", '16:1: control.hirth_dg: unknown key; did you mean "hirth_deg"?'),
    ],
)
def test_the_controller_of_the_machine_file_counts(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "machine.toml"
    machine = MACHINE.read_text(encoding="utf-8")
    path.write_text(f"{machine}\n[control]\n{text}\n", encoding="utf-8")

    result = run(SAMPLES / "optimise_then_check.h", tmp_path, "--machine", str(path))

    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)


class _Page(HTMLParser):
    """What a reader of the log gets: text, names of the pictures, and what it would load."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.pictures: list[str] = []
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag == "svg":
            self.pictures.append(given.get("aria-label") or "")
        if tag in ("script", "img", "iframe"):
            self.loads.append(tag)

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def test_the_log_lists_what_the_document_lists(tmp_path: Path) -> None:
    assert run(SAMPLES / "optimise_positions.h", tmp_path).exit_code == 0

    page = _Page((tmp_path / "log.html").read_text(encoding="utf-8"))

    text = " ".join(" ".join(page.words).split())
    for wanted in (
        "date and time",
        str(SAMPLES / "optimise_positions.h"),
        "TOUCH_PROBE",
        "machine_bc",
        "1 = optimise positions",
        "incidence angles",
        "start angle",
        "end angle",
        "measuring points",
        "radius of the measuring circle",
        "mean backlash",
        "position of the axis before",
        "scatter",
        "greatest error",
        "compensation in X, Y, Z",
        "mean positioning error relative to 0°",
        *(f"Q{q}" for q in range(141, 150)),
    ):
        assert wanted in text, wanted
    names = [picture.split(",")[0] for picture in page.pictures]
    assert names == ["EXB", "EYB", "EZB", "EXC", "EYC", "EZC"]
    assert all("in red" in p and "in green" in p for p in page.pictures)
    assert page.loads == []


def test_the_charts_of_the_log_are_files_beside_it(tmp_path: Path) -> None:
    folder = tmp_path / "a log"
    folder.mkdir()
    html = ("--html", str(folder / "my log.html"))
    assert run(SAMPLES / "optimise_then_check.h", tmp_path, *html).exit_code == 0

    page = (folder / "my log.html").read_text(encoding="utf-8")
    files = [f"my log-{i}-E{x}{axis}.svg" for i in (1, 2) for axis in "BC" for x in "XYZ"]
    assert sorted(path.name for path in folder.iterdir()) == sorted(["my log.html", *files])
    shown = re.findall(r"<svg .*?</svg>", page, flags=re.DOTALL)
    for name, inline in zip(files, shown, strict=True):
        assert f'<a href="{quote(name)}">' in page
        chart = (folder / name).read_text(encoding="utf-8")
        ET.fromstring(chart)  # noqa: S314, it is our own
        # One picture: the same lines, in the page with its names of colours.
        assert re.findall(r' d="([^"]*)"', chart) == re.findall(r' d="([^"]*)"', inline)
        assert chart.count(theme.RED) > 2  # the dark scheme's rules have it twice
        assert chart.count(theme.FOURTH) > 2
        assert "prefers-color-scheme: dark" in chart
        assert name[-7:-4] in chart[: chart.index("</title>")]


def test_an_inch_program_measures_the_same_in_mm(tmp_path: Path) -> None:
    text = (SAMPLES / "save_and_check.h").read_text(encoding="utf-8")
    inches = text.replace("Q407=+12.5", f"Q407=+{12.5 / 25.4:.9f}").replace("Q253=+750", "Q253=+30")
    program = program_of(tmp_path, f"BEGIN PGM X INCH\n{inches}END PGM X INCH\n")

    assert run(program, tmp_path).exit_code == 0
    in_inches = json.loads((tmp_path / "out.json").read_text())["runs"][0]["q"]
    assert run(SAMPLES / "save_and_check.h", tmp_path).exit_code == 0
    in_mm = json.loads((tmp_path / "out.json").read_text())["runs"][0]["q"]

    assert in_inches == pytest.approx(in_mm, abs=1e-6)


def test_the_same_seed_gives_the_same_result(tmp_path: Path) -> None:
    results = []
    for seed in ("3", "3", "4"):
        assert run(SAMPLES / "save_and_check.h", tmp_path, "--seed", seed).exit_code == 0
        results.append((tmp_path / "out.json").read_text())

    assert results[0] == results[1] != results[2]
