"""``skiplatch import``: logs of which a piece is lost, and what is said of it.

Shortened from logs that people posted: of LinuxCNC on its forum, of Marlin and Klipper in issues.
"""

from pathlib import Path

import pytest

from test_import_logs import Run

ZEROS = " 0.000000" * 6
OVERWRITTEN = f"""-0.000000 -0.000000 -0.012167{ZEROS}
-0.000000 -0.000000 0.020750{ZEROS}
000000 -0.000000 0.006167{ZEROS}
0.000000 -0.000000 0.021583{ZEROS}
00 0.000000
300.000000 -0.000000 -0.027167{ZEROS}
"""
"""A file of LinuxCNC that was begun anew over an older one, twice."""
THREE_COLUMNS = """19.999999 19.999995 1.015218
429.999989 167.999998 30
101.999997 19.999990 0.940998
"""

BOLD = """**22:08:36.887: N28674 G28**
22:08:58.816: N28676 M48 V4
22:08:58.819: M48 Z-Probe Repeatability Test
22:09:03.495: Bed X: 68.000 Y: 100.000 Z: -0.042
22:09:05.997: 1 of 3: **z: -0.036** mean: -0.0363 sigma: 0.000000 min: -0.036 max: -0.036
22:09:08.501: 2 of 3: z: -0.037 mean: -0.0366 sigma: 0.000236 min: -0.037 max: -0.036
22:09:11.018: `3 of 3: z: -0.037 mean: -0.0368 sigma: 0.000385 min: -0.037 max: -0.036`
"""
ROUNDED = """M48 Z-Probe Repeatability Test
1 of 5: z: 0.043
2 of 5: z: 0.045
3 of 5: z: 0.045
4 of 5: z: 0.045
5 of 5: z: 0.045
Finished!
Mean: 0.044500 Min: 0.043 Max: 0.045 Range: 0.002
Standard Deviation: 0.001000
"""

ACCURACY = """PROBE_ACCURACY SAMPLES=4
// PROBE_ACCURACY at X:155.000 Y:107.000 Z:20.060 (samples=4 retract=2.500 speed=5.0)
// probe at 155.000,107.000 is z=3.434839
// probe at 155.000,107.000 is z=3.453998
// probe at 155.000,107.000 is z=3.435672
// probe at 155.000,107.000 is z=3.436505
"""


def read(folder: Path, kind: str, text: str, *words: str) -> Run:
    (folder / "torn.log").write_text(text)
    return Run(folder, kind, str(folder / "torn.log"), *words)


def test_stump_of_a_row_of_linuxcnc_is_no_touch(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", OVERWRITTEN)

    assert run.coordinates() == [-0.012167, 0.02075, 0.021583, -0.027167]
    lost, stump = run.said["could_not_be_read"]
    assert lost == "1 lines that do not hold 9 numbers: line 5"
    assert stump.startswith("1 rows with a number that is not written with six decimals")
    assert stump.endswith("LinuxCNC writes them: line 3")


def test_number_typed_into_three_columns_is_no_touch(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", THREE_COLUMNS)

    assert run.coordinates() == [1.015218, 0.940998]
    assert "LinuxCNC writes them: line 2" in run.text


def test_stump_with_three_numbers_is_no_row_among_those_of_nine(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", f"{OVERWRITTEN}0.000000 0.000000 0.000000\n")

    assert len(run.campaign.touches) == 4
    assert "2 lines that do not hold 9 numbers: line 5, 7" in run.said["could_not_be_read"]


def test_table_in_digits_of_its_own_is_read_whole(tmp_path: Path) -> None:
    run = read(tmp_path, "linuxcnc", "0 0 -2.501\n0 0 -2.511\n0 0 -2.5\n")

    assert len(run.campaign.touches) == 3
    assert run.said["could_not_be_read"] == []


def test_of_many_lines_a_few_are_named(tmp_path: Path) -> None:
    rows = OVERWRITTEN.splitlines(keepends=True)
    run = read(tmp_path, "linuxcnc", rows[0] * 9 + rows[2] * 7)

    assert "LinuxCNC writes them: line 10, 11, 12, 13, 14 and 2 more" in run.text


def test_samples_in_markdown_are_read(tmp_path: Path) -> None:
    run = read(tmp_path, "marlin", BOLD)

    assert run.coordinates() == pytest.approx([-0.036, -0.037, -0.037], abs=5e-4)
    assert set(run.campaign.touches.time_s.tolist()) == {0.0, 2.504, 5.021}
    assert run.said["could_not_be_read"] == []


@pytest.mark.parametrize(
    ("lost", "said"),
    [
        ([1], "1 of 5, before line 2"),
        ([2, 3], "2 to 3 of 5, before line 3"),
        ([4], "4 of 5, before line 5"),
        ([5], "5 of 5, after line 5"),
        ([1, 5], "1 of 5, before line 2; 5 of 5, after line 4"),
    ],
)
def test_sample_of_m48_that_is_lost_is_named(tmp_path: Path, lost: list[int], said: str) -> None:
    lines = [line for i, line in enumerate(ROUNDED.splitlines(keepends=True)) if i not in lost]

    run = read(tmp_path, "marlin", "".join(lines))

    assert len(run.campaign.touches) == 5 - len(lost)
    assert f"samples of M48 that are missing: {said}" in run.said["could_not_be_read"]
    assert "standard deviations" not in run.text


def test_sample_that_is_lost_before_another_test_is_named(tmp_path: Path) -> None:
    run = read(tmp_path, "marlin", "".join(ROUNDED.splitlines(keepends=True)[:4]) + ROUNDED)

    assert run.said["could_not_be_read"] == [
        "samples of M48 that are missing: 4 to 5 of 5, after line 4"
    ]


def test_samples_after_a_failure_of_marlin_are_not_missing(tmp_path: Path) -> None:
    begun = "".join(ROUNDED.splitlines(keepends=True)[:4])

    run = read(tmp_path, "marlin", f"{begun}Error:Probing failed\n{ROUNDED}")

    assert run.said["could_not_be_read"] == []


def test_standard_deviation_that_marlin_tells_from_more_digits_is_said(tmp_path: Path) -> None:
    run = read(tmp_path, "marlin", ROUNDED)

    said = "more digits than it prints of each z: line 9, 1 µm in place of 0.8 µm"
    assert any(line.endswith(said) for line in run.said["known"])


def test_standard_deviation_that_the_samples_do_not_have_is_told(tmp_path: Path) -> None:
    run = read(tmp_path, "marlin", ROUNDED.replace("0.001000", "0.004000"))

    (said,) = run.said["could_not_be_read"]
    assert said.endswith("those samples do not have: line 9, 4 µm in place of 0.8 µm")


def test_standard_deviation_of_another_test_is_held_against_nothing(tmp_path: Path) -> None:
    other = "M48 Z-Probe Repeatability Test\nFinished!\nStandard Deviation: 0.004000\n"

    run = read(tmp_path, "marlin", ROUNDED + other)

    assert run.said["could_not_be_read"] == []


@pytest.mark.parametrize("left", [50, 45, 41, 37, 31, 27, 19, 11])
def test_touch_of_klipper_that_the_end_of_the_log_cuts_off_is_told(
    tmp_path: Path, left: int
) -> None:
    """Within its z, it would be another one."""
    run = read(tmp_path, "klipper", ACCURACY + "// probe at 155.000,107.000 is z=3.439837"[:left])

    is_cut = left < 41
    assert len(run.campaign.touches) == 5 - is_cut
    said = ["a touch that the end of the log cuts off: line 7"] if is_cut else []
    assert run.said["could_not_be_read"] == said


@pytest.mark.parametrize("behind", ["", "// probe accuracy results: maximum 3.5, minimum 3.4\n"])
def test_touch_of_probe_accuracy_that_is_lost_is_told(tmp_path: Path, behind: str) -> None:
    lines = ACCURACY.splitlines(keepends=True)

    run = read(tmp_path, "klipper", "".join(lines[:3] + lines[4:]) + behind)

    where = "line 6" if behind else "at the end"
    said = f"touches of PROBE_ACCURACY that are missing: 1 of 4, {where}"
    assert said in run.said["could_not_be_read"]


def test_touch_that_ended_probe_accuracy_without_a_trigger_is_not_missing(tmp_path: Path) -> None:
    begun = "".join(ACCURACY.splitlines(keepends=True)[:4])

    run = read(tmp_path, "klipper", f"{begun}!! No trigger on probe after full movement\n")

    assert run.said["could_not_be_read"] == []
