"""NC programs with cycles 450 and 451, run on the simulated machine, and their log."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree as ET

import pytest
from click.testing import CliRunner

from kinematics_programs import MACHINE, SAMPLES, TRUTH, program_of, run
from refusals import Program
from skiplatch.cli import group
from skiplatch.errors import InputError
from skiplatch.figures import colours
from skiplatch.kinematics.machine import read_machine
from skiplatch.kinematics.points import read_points


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


def test_bad_input_is_one_line_and_status_2(tmp_path: Path, refused: Program) -> None:
    program = program_of(tmp_path, "12 TCH PROBE 450 X ~\nQ410=x\n")

    assert refused("kinematics", "run", program, is_silent=True).startswith(
        f"skiplatch: {program}:2:"
    )


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
    assert result.output.count("Backlash of B, C was not measured (Q432 = 0") == 1


def test_a_coupling_has_no_backlash_to_measure_and_the_log_says_so(tmp_path: Path) -> None:
    machine = tmp_path / "machine.toml"
    text = MACHINE.read_text(encoding="utf-8")
    machine.write_text(f"{text}\n[control]\nhirth_deg = [0, 3, 0]\n", encoding="utf-8")
    program = (SAMPLES / "optimise_positions.h").read_text(encoding="utf-8")
    lifted = program_of(tmp_path, program.replace("Q408=+0", "Q408=+150"))

    result = run(lifted, tmp_path, "--machine", str(machine))

    assert result.exit_code == 0, result.output
    assert "Backlash of B was not measured" in result.output
    assert "Backlash of B was not measured" in (tmp_path / "log.html").read_text(encoding="utf-8")


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
        ("has_kinematics_opt = false", "cycle 451: the cycle needs KinematicsOpt (option 48)"),
        ("is_turning = true", "cycle 451: FUNCTION MODE MILL is not active"),
        ("max_dev_cal_ball_mm = -1", "16:1: control.max_dev_cal_ball_mm: expected a number from 0"),
        ("is_tcpm_on = 1", "16:1: control.is_tcpm_on: expected true or false"),
        ("hirth_deg = [0, -3, 0]", "16:1: control.hirth_deg: expected a list of 3 numbers from 0"),
        ("max_modification_mm = 1" + "0" * 400, "16:1: control.max_modification_mm: expected a"),
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
    assert run(SAMPLES / "optimise_positions.h", tmp_path, has_charts=True).exit_code == 0

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
    program = SAMPLES / "optimise_then_check.h"
    assert run(program, tmp_path, *html, has_charts=True).exit_code == 0

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
        assert chart.count(colours.RED) > 2  # the dark scheme's rules have it twice
        assert chart.count(colours.FOURTH) > 2
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


def test_a_range_is_told_in_the_inches_of_the_program(tmp_path: Path) -> None:
    text = (SAMPLES / "save_and_check.h").read_text(encoding="utf-8")
    wide = text.replace("Q407=+12.5", "Q407=+4")
    program = program_of(tmp_path, f"BEGIN PGM X INCH\n{wide}END PGM X INCH\n")

    result = run(program, tmp_path)

    assert "Q407 is above its upper limit (SPHERE RADIUS: 3.93700787e-06 to 3.93700394 inch)" in (
        str(result.exception)
    )


def test_3d_rot_and_track_at_the_end_stand_in_the_log(tmp_path: Path) -> None:
    result = run(SAMPLES / "save_and_check.h", tmp_path)

    assert result.exit_code == 0, result.output
    said = "3-D ROT of the automatic mode active at B 0°, C 90°, as the axes stand; TRACK off"
    assert said in result.output
    assert said in (tmp_path / "log.html").read_text(encoding="utf-8")
    (done,) = json.loads((tmp_path / "out.json").read_text())["runs"]
    assert done["end"] == {"3d_rot_deg": {"B": 0.0, "C": 90.0}, "track": False}


def test_a_probe_that_is_tracked_has_no_lobes(tmp_path: Path) -> None:
    """Four touches around see lobes of 3 µm as a shift of the sphere, the same everywhere."""
    machine = tmp_path / "machine.toml"
    text = MACHINE.read_text(encoding="utf-8")
    lobes = ("--effect", "pretravel_lobing:amplitude_um=3")
    off_um = {}
    for track in ("false", "true"):
        machine.write_text(f"{text}\n[control]\ntrack = {track}\n", encoding="utf-8")
        result = run(SAMPLES / "save_and_check.h", tmp_path, *lobes, "--machine", str(machine))
        assert result.exit_code == 0, result.output
        (done,) = json.loads((tmp_path / "out.json").read_text())["runs"]
        off_um[track] = abs(done["parameters"]["XOC"]["value"] - 120.0)

    assert off_um["false"] > 1.0
    assert off_um["true"] < 0.5


def test_the_same_seed_gives_the_same_result(tmp_path: Path) -> None:
    results = []
    for seed in ("3", "3", "4"):
        assert run(SAMPLES / "save_and_check.h", tmp_path, "--seed", seed).exit_code == 0
        results.append((tmp_path / "out.json").read_text())

    assert results[0] == results[1] != results[2]


def duration_s(folder: Path, **changed: str) -> float:
    text = (SAMPLES / "save_and_check.h").read_text(encoding="utf-8")
    for name, value in changed.items():
        text = re.sub(rf"{name}=\S+", f"{name}={value}", text)
    result = run(program_of(folder, text), folder)
    assert result.exit_code == 0, result.output
    found: float = json.loads((folder / "out.json").read_text())["runs"][0]["duration_s"]
    return found


def test_the_duration_is_that_of_the_motions(tmp_path: Path) -> None:
    usual = duration_s(tmp_path)
    slow = duration_s(tmp_path, Q253="+75")
    high = duration_s(tmp_path, Q408="+200")

    assert 60.0 < usual < 600.0  # 5 spheres of 5 touches, 540° at 750°/min; no calibration
    turned_deg = 2.0 * (90.0 + 180.0 + 90.0)  # B and C there and back: at least so much
    assert slow - usual > turned_deg * 60.0 / 75.0 * 0.6
    assert high > usual + 4.0 * 200.0 / 750.0 * 60.0  # up before every turn


def test_positions_of_axes_are_told_from_the_spindle_nose(tmp_path: Path) -> None:
    machine = tmp_path / "machine.toml"
    text = MACHINE.read_text(encoding="utf-8")
    machine.write_text("spindle_mm = [10, 20, 300]\n" + text, encoding="utf-8")

    result = run(SAMPLES / "save_and_check.h", tmp_path, "--machine", str(machine))

    assert result.exit_code == 0, result.output
    log = (tmp_path / "log.html").read_text(encoding="utf-8")
    assert "X -10.0000, Y -20.0000, Z -300.0000 mm" in log
