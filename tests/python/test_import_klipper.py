"""``skiplatch import klipper``: which command a touch belongs to, and what moves Z between touches.

The wording is that of Klipper's probe.py, z_tilt.py, quad_gantry_level.py, screws_tilt_adjust.py
and bed_screws.py, from 2018 on, and of touch_mode.py and accuracy.py of Cartographer's plugin.
"""

from pathlib import Path

import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.cli import group
from test_import_logs import Run

TEST = (
    "PROBE_ACCURACY at X:10.000 Y:10.000 Z:5.000 "
    "(samples=2 retract=2.000 speed={} lift_speed=10.0)\n"
)
TOUCH = "probe at 10.000,10.000 is z={}\n"
TOUCHES = TOUCH.format(1.0) + TOUCH.format(1.0025)
RESULTS = "probe accuracy results: maximum 1.002500, minimum 1.000000\n"
CONFIG = """===== Config file =====
[probe]
speed = 8.0
[gcode_macro SLOWLY]
gcode =
	G28
	PROBE PROBE_SPEED=1
=======================
"""


def imported(folder: Path, text: str) -> Run:
    (folder / "k.log").write_text(text)
    return Run(folder, "klipper", str(folder / "k.log"))


@pytest.mark.parametrize(
    "section",
    [
        *("probe_eddy_current my_eddy", "load_cell_probe", "dockable_probe"),
        *("beacon", "cartographer", "scanner"),
    ],
)
def test_speed_of_every_probe_is_read(tmp_path: Path, section: str) -> None:
    config = CONFIG.replace("[probe]", f"[{section}]").replace("8.0", "7")

    run = imported(tmp_path, config + TOUCHES)

    assert feeds(run) == [420.0] * 2
    assert "feeds from the configuration in the log" in run.said["known"]


def feeds(run: Run) -> list[float]:
    return [float(feed) for feed in run.campaign.touches.feed_mm_min]


def sessions(run: Run) -> list[str]:
    """The session of each touch, without where it was."""
    touches = run.campaign.touches
    return [touches.session_names[i].split(" Z-")[0] for i in touches.session]


@pytest.mark.parametrize(
    "command", ["PROBE", "$ probe samples=2", "Send: N7 G29*33", "BED_MESH_CALIBRATE METHOD=x ; m"]
)
def test_speed_of_a_command_does_not_stick_to_the_next(tmp_path: Path, command: str) -> None:
    run = imported(
        tmp_path,
        f"PROBE_ACCURACY PROBE_SPEED=10\n{TEST.format('10.0')}{TOUCHES}{command}\n{TOUCHES}"
        f"PROBE PROBE_SPEED=2\n{TOUCHES}{command}\n{TOUCHES}",
    )

    assert feeds(run) == [600.0] * 2 + [300.0] * 2 + [120.0] * 2 + [300.0] * 2
    assert "feeds from PROBE_ACCURACY and PROBE_SPEED" in run.said["known"]
    assert any(line.startswith("4 touches at Klipper's default") for line in run.said["assumed"])


def test_speed_of_probe_accuracy_ends_with_its_results(tmp_path: Path) -> None:
    run = imported(tmp_path, TEST.format("2.0") + TOUCHES + RESULTS + TOUCHES)

    assert feeds(run) == [120.0] * 2 + [300.0] * 2
    assert run.campaign.touches.approach_mm.tolist()[:2] == pytest.approx([4.0, 2.0], abs=0.01)


def test_speed_of_probe_accuracy_ends_with_its_last_sample(tmp_path: Path) -> None:
    run = imported(tmp_path, TEST.format("2.0") + TOUCHES + TOUCHES)

    assert feeds(run) == [120.0] * 2 + [300.0] * 2


def test_speed_of_probe_accuracy_holds_where_a_delta_prints_other_places(tmp_path: Path) -> None:
    run = imported(tmp_path, TEST.format("2.0") + TOUCHES.replace("10.000,", "9.998,", 1))

    assert feeds(run) == [120.0] * 2


def test_result_that_a_console_has_wrapped_is_read(tmp_path: Path) -> None:
    run = imported(tmp_path, TOUCHES.replace(" is z", "\nis z"))

    assert run.coordinates() == [1.0, 1.0025]


def test_configuration_limits_the_speed(tmp_path: Path) -> None:
    printer = "[printer]\nmax_velocity = 300\nmax_z_velocity = 5\n"
    config = CONFIG.replace("[probe]", f"{printer}[probe]")

    run = imported(tmp_path, f"{config}{TEST.format('2.0')}{TOUCHES}{RESULTS}PROBE\n{TOUCHES}")

    assert feeds(run) == [120.0] * 2 + [300.0] * 2
    said = "2 touches slower than asked for, as [printer] max_z_velocity is 5 mm/s"
    assert said in run.said["known"]


def test_speed_holds_through_what_a_command_prints(tmp_path: Path) -> None:
    printed = "Attaching Probe\nstepper_z = -0.1\nprobe: TRIGGERED\nok B:60.1 /60.0\n"
    run = imported(
        tmp_path,
        f"QUAD_GANTRY_LEVEL PROBE_SPEED=2\n{TOUCHES}Making the following Z adjustments:\n{printed}"
        f"Retries: 0/5 Probed points range: 0.390000 tolerance: 0.007500\n{TOUCHES}",
    )

    assert feeds(run) == [120.0] * 4


def test_attempt_that_fails_ends_its_command(tmp_path: Path) -> None:
    missed = "!! No trigger on probe after full movement\n"
    test = f"{TEST.format('10.0')}{TOUCHES}"
    run = imported(tmp_path, f"{test}{RESULTS}PROBE\n{missed}{test}{missed}{TOUCHES}")

    assert feeds(run) == [600.0, 600.0, 300.0, 600.0, 600.0, 600.0, 300.0, 300.0]
    assert (
        run.campaign.touches.missed.tolist()
        == [False] * 2 + [True, False, False, True] + [False] * 2
    )


def test_commands_in_macros_of_the_configuration_are_not_given(tmp_path: Path) -> None:
    run = imported(tmp_path, f"{TOUCHES}{CONFIG}{TOUCHES}")

    assert feeds(run)[2:] == [480.0] * 2
    assert len(set(sessions(run))) == 1


def test_speed_that_is_printed_with_one_decimal_is_taken_as_typed(tmp_path: Path) -> None:
    typed = f"PROBE_ACCURACY PROBE_SPEED=.25\n{TEST.format('0.2')}{TOUCHES}"
    run = imported(tmp_path, f"{typed}{RESULTS}{TEST.format('10.0')}{TOUCHES}")

    assert feeds(run) == [15.0] * 2 + [600.0] * 2


def test_speed_of_2019_is_read_without_a_closing_bracket(tmp_path: Path) -> None:
    old = TEST.format("2.0").replace(" lift_speed=10.0)", "")
    assert feeds(imported(tmp_path, old + TOUCHES)) == [120.0] * 2


ADJUSTED = [
    "Making the following Z adjustments:\nz = -0.2\nRetries: 0/5 Probed points range: 0.4\n",
    "// Making the following Z tilt adjustments:\n// stepper_z = -0.2\n",
    "Making the following gantry adjustments:\nz = -0.2\n",
    "Recv: // Retries: 1/5 Probed points range: 0.390000 tolerance: 0.007500\n",
]
TURNED = [
    "front left screw (base) : x=-5.0, y=30.0, z=2.48750\nrear : x=1, y=2, z=2.4 : adjust CW 0:15",
    "front left (Base): X -5.0, Y 30.0, Z 2.48750\nrear : X 1.0, Y 2.0, Z 2.4 : Adjust -> CW 01:15",
    "Adjust front left. Then run ACCEPT, ADJUSTED, or ABORT",
]


@pytest.mark.parametrize("printed", ADJUSTED)
def test_adjustment_of_z_begins_a_session(tmp_path: Path, printed: str) -> None:
    run = imported(tmp_path, TOUCHES + printed + TOUCHES + printed + TOUCHES + printed)

    assert sessions(run)[2:] == ["after adjusting Z 1"] * 2 + ["after adjusting Z 2"] * 2
    assert len(run.campaign.touches.session_names) == 3
    assert any(
        "after an adjustment of Z" in line and line.endswith(": 2") for line in run.said["assumed"]
    )


@pytest.mark.parametrize("printed", TURNED)
def test_screws_that_were_to_be_turned_begin_a_session(tmp_path: Path, printed: str) -> None:
    run = imported(tmp_path, f"{TOUCHES}{printed}\n{TOUCHES}")

    assert sessions(run)[2:] == ["after turning screws 1"] * 2
    assert any("how far to turn screws" in line for line in run.said["assumed"])


def test_another_tool_begins_a_session(tmp_path: Path) -> None:
    tools = ("$ T0", "$ T1 ; second", "T1", "T0:24.3 /0.0", "ACTIVATE_EXTRUDER EXTRUDER=extruder")
    run = imported(tmp_path, "".join(f"{tool}\n{TOUCHES}" for tool in tools))

    second = ["after a tool change 1"] * 6
    assert sessions(run)[2:] == [*second, *["after a tool change 2"] * 2]
    said = "sessions of their own after a change of the tool, as each has a length of its own: 2"
    assert said in run.said["assumed"]


def test_homing_after_an_adjustment_begins_no_session_more(tmp_path: Path) -> None:
    run = imported(tmp_path, f"G28\n{TOUCHES}{ADJUSTED[0]}G28 Z\n{TOUCHES}G28\n{TOUCHES}")

    assert sessions(run)[2:] == ["after adjusting Z 1"] * 2 + ["after homing 2"] * 2


@pytest.mark.parametrize(
    ("command", "session"), [("G34", "adjusting Z"), ("G35", "turning screws")]
)
def test_adjustments_of_marlin_begin_sessions(tmp_path: Path, command: str, session: str) -> None:
    (tmp_path / "m.log").write_text(
        "Bed X: 5.00 Y: 5.00 Z: 0.11\n" * 2
        + f">>> {command}\n"
        + "Bed X: 5.00 Y: 5.00 Z: 0.31\n" * 2
    )

    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"), "--feed", "120")

    assert sessions(run)[2:] == [f"after {session} 1"] * 2


def test_passes_of_levelling_are_no_scatter(tmp_path: Path) -> None:
    """Touches of a levelling that goes on stand 60 µm from where the gantry was left."""
    (tmp_path / "k.log").write_text(
        "".join(TOUCH.format(z) + ADJUSTED[0] for z in (1.3, 1.06))
        + TEST.format("5.0")
        + "".join(TOUCH.format(1.0 + i) for i in (0.0, 0.0025, 0.005, 0.0, 0.0025))
    )

    result = CliRunner().invoke(group, ["repeat", str(tmp_path / "k.log")], catch_exceptions=False)

    assert "5 touches of one surface" in result.output
    assert "widest range, µm        5" in result.output
    assert "after an adjustment of Z" in result.output


def test_reading_far_off_at_one_place_is_of_the_same_surface(tmp_path: Path) -> None:
    run = imported(tmp_path, TOUCHES + TOUCH.format(1.001) + TOUCH.format(2.24))

    assert len(run.campaign.touches.session_names) == 1
    assert run.campaign.touches.deviation_um.min() < -1200.0
    assert any("more than 0.5 mm from the others" in line for line in run.said["odd"])


def test_z_that_rises_with_each_g30_is_of_one_surface(tmp_path: Path) -> None:
    touched = [f"Recv: Bed X: 40.00 Y: 50.00 Z: {z:.2f}\n" for z in (1.1, 2.1, 3.1)]
    (tmp_path / "m.log").write_text("".join(touched))
    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"))

    assert list(run.campaign.touches.deviation_um) == [1000.0, 0.0, -1000.0]


def test_reading_of_grbl_that_is_far_off_is_said_to_be_another_surface(tmp_path: Path) -> None:
    heights = (-5.001, -5.002, -5.0, -3.8, -5.001)
    (tmp_path / "g.log").write_text("".join(f"[PRB:1.000,2.000,{z:.3f}:1]\n" for z in heights))
    run = Run(tmp_path, "grbl", str(tmp_path / "g.log"), "--feed", "100")

    said = "met something 1.2 mm away at the same place (Z- at 1 2): taken for another surface"
    assert any(line == f"{said}: touch 3" for line in run.said["assumed"])
    checked = CliRunner().invoke(group, ["check", str(tmp_path / "campaign")])
    assert said in checked.output


STATS = (
    "Stats 100.5: gcodein=0 mcu: mcu_awake=0.001 freq=520 adj=521 raspi: temp=50.5 "
    "EBB_NTC: temp=31.5 5V_Monitor: temp=5.0 unread: temp=0.0 "
    "heater_bed: target=60 temp=59.5 pwm=0\n"
)
SENSORS = """===== Config file =====
[temperature_sensor raspi]
sensor_type = temperature_host
[temperature_sensor EBB_NTC]
sensor_type = Generic 3950
=======================
"""


def test_sensors_are_called_as_columns_may_be_and_those_of_processors_left_out(
    tmp_path: Path,
) -> None:
    run = imported(tmp_path, SENSORS + (STATS + TOUCH.format(1.0)) * 3)

    found = {name: values[0] for name, values in run.campaign.touches.thermometers.items()}
    assert found == {"ebb_ntc": 31.5, "5v_monitor": 5.0, "heater_bed": 59.5}


def test_speed_on_a_line_of_its_own_is_read(tmp_path: Path) -> None:
    """As probe.py printed until 2020."""
    head = "// probe accuracy: at X:10.0 Y:10.0 Z:5.0\n// and read 10 times with speed of 2 mm/s\n"
    run = imported(tmp_path, head + TOUCHES + RESULTS)

    assert feeds(run) == [120.0] * 2
    assert run.campaign.touches.approach_mm[0] == pytest.approx(4.0, abs=0.01)


def test_tap_that_retracts_by_itself_tells_no_approach(tmp_path: Path) -> None:
    run = imported(tmp_path, TEST.format("5.0").replace("retract=2.000", "retract=0.000") + TOUCHES)

    assert run.campaign.touches.approach_mm[1:].tolist() == pytest.approx(
        [float("nan")], nan_ok=True
    )


def test_lines_that_a_page_glued_together_are_read_apart(tmp_path: Path) -> None:
    glued = f"Send: PROBE_ACCURACYRecv: // {TEST.format('2.0')[:-1]}Send: M105Recv: // {TOUCHES}"
    run = imported(tmp_path, glued.replace(" lift_speed=10.0)", ""))

    assert feeds(run) == [120.0] * 2


@pytest.mark.parametrize(("lowest", "is_told"), [("1.000000", False), ("0.997500", True)])
def test_touches_that_the_results_count_and_the_log_lacks_are_told(
    tmp_path: Path,
    lowest: str,
    is_told: bool,
) -> None:
    results = RESULTS.replace("1.000000", lowest)
    run = imported(tmp_path, TOUCHES + TEST.format("2.0") + TOUCHES + results)

    said = "touches that the log's own minimum and maximum count, line 6"
    assert any(line.startswith(said) for line in run.said.get("could_not_be_read", [])) is is_told


def test_times_are_spread_no_further_than_touches_usually_are_apart(tmp_path: Path) -> None:
    seconds = (0, 0, 1, 1, 2, 9, 9)
    log = "".join(f"10:00:0{second} {TOUCH.format(1.0)}" for second in seconds)
    run = imported(tmp_path, log)

    assert run.campaign.touches.time_s.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0, 9.0, 9.5]


def test_first_result_of_marlin_is_counted_once(tmp_path: Path) -> None:
    """As a log shows it that was cut below the title of the test."""
    (tmp_path / "m.log").write_text(
        "Bed X: 1.0 Y: 5.0 Z: -0.0050\n1 of 2: z: -0.005 mean: -0.0050\n"
        "2 of 2: z: -0.003 mean: -0.0038\nFinished!\nMean: -0.003800 Min: -0.009 Max: -0.003\n"
    )
    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"), "--feed", "120")

    assert len(run.campaign.touches) == 2
    assert any(
        "minimum and maximum count, line 5" in line for line in run.said["could_not_be_read"]
    )


def test_summaries_of_marlin_alone_ask_for_samples(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "m.log").write_text("Mean: 0.007667 Min: -0.002 Max: 0.018 Range: 0.020\n")

    assert "type M48 V4" in refused("import", "marlin", tmp_path / "m.log", "-o", tmp_path / "out")


@pytest.mark.parametrize("command", ["PROBE PROBE_METHOD=contact", "PROBE METHOD=tap"])
def test_contact_and_reading_from_above_are_two_surfaces(tmp_path: Path, command: str) -> None:
    contact = "".join(TOUCH.format(z) for z in (-0.025, -0.024))
    run = imported(tmp_path, f"{command}\n{contact}PROBE_ACCURACY\n{TEST.format('5.0')}{TOUCHES}")

    touches = run.campaign.touches
    assert sessions(run) == ["by contact", "by contact", "Z- at 10 10", "Z- at 10 10"]
    assert max(abs(touches.deviation_um)) < 2.0
    assert "touches by contact are none of the surface that others read" in run.said["assumed"]


def test_method_of_a_mesh_parts_no_surface(tmp_path: Path) -> None:
    run = imported(tmp_path, f"BED_MESH_CALIBRATE METHOD=automatic\n{TOUCHES}PROBE\n{TOUCHES}")

    assert len(set(sessions(run))) == 1


@pytest.mark.parametrize("steps", ["15.75", "10160.00"])  # 400/mm by 25.4, and times it
def test_settings_of_marlin_in_inches_tell_no_step(tmp_path: Path, steps: str) -> None:
    settings = f"echo:  G20 ; (in)\necho:; Steps per unit:\necho:  M92 X3.15 Y3.15 Z{steps}\n"
    (tmp_path / "m.log").write_text(f"{settings}1 of 2: z: 0.391\n2 of 2: z: 0.410\n")

    run = Run(tmp_path, "marlin", str(tmp_path / "m.log"), "--feed", "120")

    assert run.campaign.nominal.axis.resolution_um == 2.5
    assert any("settings in inches (G20)" in line for line in run.said["assumed"])


CARTOGRAPHER = """[cartographer] touch accuracy at X:150.000 Y:140.000 Z:3.000 (samples=2 {})
[cartographer] Starting touch sequence for 3 samples within 10 touches...
[cartographer] Touch 1: 0.0125
[cartographer] Touch 2: -0.0100
[cartographer] Touch 3: 0.0150
[cartographer] Acceptable samples found: (0.0125, -0.0100, 0.0150)
range 0.0250 (limit 0.0300), min -0.0100, max 0.0150,
mean 0.0058, median 0.0125
[cartographer] Touch 1: 0.0131
[cartographer] Measurements gathered: 0.012500, 0.013100
[cartographer] touch accuracy results:
maximum 0.013100, minimum 0.012500, range 0.000600,
"""
LISTED = """touch accuracy at X:150.000 Y:140.000 Z:3.000 (samples=3 retract=1.000 lift_speed=5.0)
Measurements gathered: [0.0125, -0.01, np.float64(0.015)]
touch accuracy results: maximum 0.015000, minimum -0.010000, range 0.025
"""
OF_READINGS = "readings of TOUCH_ACCURACY are taken for touches"


def z_um(run: Run) -> list[float]:
    touches = run.campaign.touches
    return [round(float(z), 1) for z in touches.deviation_um[0] - touches.deviation_um]


def test_touches_of_cartographer_are_read_rather_than_the_readings_made_of_them(
    tmp_path: Path,
) -> None:
    text = CARTOGRAPHER.format("retract=1.000 lift_speed=5.0 threshold=2000 speed=2.0")

    run = imported(tmp_path, text)

    assert z_um(run) == [0.0, -22.5, 2.5, 0.6]
    assert feeds(run) == [120.0] * 4
    assert sessions(run) == ["by contact"] * 4
    assert "unread" not in run.said
    assert not any(OF_READINGS in line for line in run.said["assumed"])


def test_touches_of_cartographer_without_a_speed_have_none(tmp_path: Path) -> None:
    run = imported(tmp_path, CARTOGRAPHER.format("retract=1.000 lift_speed=5.0"))

    assert not any("mm/s" in line for line in run.said["assumed"])


def test_readings_of_cartographer_are_touches_where_no_others_show(tmp_path: Path) -> None:
    run = imported(tmp_path, LISTED + LISTED.replace("touch", "scan"))

    assert z_um(run) == [0.0, -22.5, 2.5]
    assert any(line.startswith(f"3 {OF_READINGS}") for line in run.said["assumed"])
    assert "unread" not in run.said


def test_z_is_anew_after_a_touch_of_cartographer_homed_it(tmp_path: Path) -> None:
    home = "[cartographer] Touch home at (150.000, 140.000) adjusted z by -0.012 mm\n"

    first, second = "Touch 1: 0.0125\nTouch 2: 0.0131\n", "Touch 1 of 3: 0.01\nTouch 2 of 3: 0.02\n"

    run = imported(tmp_path, f"{TOUCHES}{first}{home}{second}{TOUCHES}")

    homed = "after homing 1"
    assert sessions(run)[2:] == [*["by contact"] * 2, *[f"{homed} by contact"] * 2, *[homed] * 2]


def test_a_log_of_cartographer_is_told_from_others(tmp_path: Path) -> None:
    log = tmp_path / "k.log"
    log.write_text(LISTED)

    run = CliRunner().invoke(group, ["repeat", str(log)])

    assert run.exit_code == 0
    assert "log of klipper, 3 touches" in run.output


def test_feeds_of_a_session_each_tell_no_slope(tmp_path: Path) -> None:
    log = "".join(f"{TEST.format(feed)}{TOUCHES}{RESULTS}G28\n" for feed in ("5.0", "10.0"))

    run = imported(tmp_path, log)
    repeat = CliRunner().invoke(group, ["repeat", str(tmp_path / "k.log")])

    apart = "one feed a session: a delay and a place look alike; touch at two feeds in one session"
    assert apart in run.said["cannot_be_told_from_it"]
    assert "feeds differ between surfaces or sessions alone" in " ".join(repeat.output.split())


@pytest.mark.parametrize(("touches", "is_next"), [(TOUCH.format(1.0), False), (TOUCHES * 2, True)])
def test_repeat_is_a_next_step_where_touches_repeat(
    tmp_path: Path, touches: str, is_next: bool
) -> None:
    (tmp_path / "k.log").write_text(touches)

    said = CliRunner().invoke(
        group, ["import", "klipper", str(tmp_path / "k.log"), "-o", str(tmp_path / "c")]
    )

    count = "4 touches" if is_next else "1 touch"
    assert f"machine campaign, {count}\n" in said.output
    assert ("skiplatch repeat" in said.output) == is_next
