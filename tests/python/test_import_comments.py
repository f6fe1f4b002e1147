"""Comments of programs within logs: nothing in them is taken for a command, whatever the log."""

from pathlib import Path

import pytest

from skiplatch.errors import InputError
from skiplatch.importing.gcode import without_comments
from skiplatch.importing.grbl import read_grbl
from skiplatch.importing.grbl_dialogue import command_in
from skiplatch.importing.klipper import read_klipper
from skiplatch.importing.linuxcnc import read_linuxcnc
from skiplatch.importing.marlin import read_marlin
from skiplatch.importing.model import Touch

SAID = [
    "; surface X- at 0 mm, program 6 of 6",
    "(M6 T2 comes next, at X5)",
    "; then $H, as Grbl 1.1h does at its start",
    "; $110=40 $13=1 would be slower",
    "(set G20 G91, F5)",
    "(G38.2 Z-9 F20",
]
TOUCH = "G38.2 Z-9 F100\n[PRB:0.000,0.000,-5.000:1]\nok\n"


def write(folder: Path, text: str) -> Path:
    path = folder / "log.txt"
    path.write_text(text)
    return path


def told(touches: list[Touch]) -> list[tuple[object, ...]]:
    return [(t.axis, t.sign, t.coordinate, t.feed, t.start, t.session, t.place) for t in touches]


@pytest.mark.parametrize("said", SAID)
@pytest.mark.parametrize("before", ["", ">>> ", "G4 P1 "])
def test_comment_to_grbl_changes_nothing(tmp_path: Path, said: str, before: str) -> None:
    again = TOUCH.replace("-9 F100", "-9")
    head = "G21 G90\nok\nG53 G0 Z5\nok\n"
    plain = read_grbl(write(tmp_path, f"{head}{TOUCH}{before}\nok\n{again}"), None)

    path = write(tmp_path, f"{head}{TOUCH}{before}{said}\nok\n{again}")
    commented = read_grbl(path, None)

    assert told(commented.touches) == told(plain.touches)
    assert commented.known == plain.known
    assert commented.figures == plain.figures


@pytest.mark.parametrize("said", ["; not G53 M6 G20", "(G53 M6 G20)", "(to X9 F7)"])
def test_comment_behind_a_command_of_grbl_changes_nothing(tmp_path: Path, said: str) -> None:
    head, again = f"G21 G90\nok\nG53 G0 Z5\nok\n{TOUCH}", TOUCH.replace("-9 F100", "-9")
    plain = read_grbl(write(tmp_path, f"{head}G53 G0 Z5\nok\n{again}"), None)

    commented = read_grbl(write(tmp_path, f"{head}G53 G0 Z5 {said}\nok\n{again}"), None)

    assert told(commented.touches) == told(plain.touches)


def test_answer_behind_a_commented_command_is_still_read(tmp_path: Path) -> None:
    log = "[ G91 G38.2 X62 F80 ; along, not G38.2 Z1 ] [PRB:60.000,0.000,0.000:1]\nok\n"

    (touch,) = read_grbl(write(tmp_path, log), None).touches

    assert (touch.axis, touch.sign, touch.feed) == ("X", 1, 80.0)


def test_comment_is_no_command() -> None:
    assert [command_in(said) for said in SAID] == [None] * len(SAID)
    assert without_comments("G1 (never closed X5").strip() == "G1"


@pytest.mark.parametrize(
    "said",
    [
        "PROBE ; PROBE_SPEED=9",
        "PROBE ; METHOD=tap",
        "; PROBE_SPEED=9",
        "T0 ; M6",
        "; Making the following Z adjustments",
    ],
)
def test_comment_to_klipper_changes_nothing(tmp_path: Path, said: str) -> None:
    touch = "// probe at 97.000,2.000 is z=1.320000\n"
    command = said.split(";", maxsplit=1)[0].strip()
    plain = read_klipper(write(tmp_path, f"{touch}{command}\n{touch}"), None)

    commented = read_klipper(write(tmp_path, f"{touch}{said}\n{touch}"), None)

    assert told(commented.touches) == told(plain.touches)


@pytest.mark.parametrize(
    "said", ["; M851 Z-9", "G4 P1 ; M92 Z50", "; M201 Z7", "; like M48 X9 Y8", "G4 (M851 Z-9)"]
)
def test_comment_to_marlin_changes_nothing(tmp_path: Path, said: str) -> None:
    head = "M851 Z-1.5\nM92 Z400\nM201 Z100\nM48 P4 X10 Y20 V4\n"
    touches = ["1 of 2: z: 0.185\n", "2 of 2: z: 0.187\n"]
    plain = read_marlin(write(tmp_path, head + "".join(touches)), 300.0)

    commented = read_marlin(write(tmp_path, head + f"{said}\n".join(touches)), 300.0)

    assert told(commented.touches) == told(plain.touches)
    assert commented.figures == plain.figures


def test_comment_to_linuxcnc_is_no_move_left_out(tmp_path: Path) -> None:
    log, program = write(tmp_path, "1.0 2.0 3.0 0 0 0 0 0 0\n"), tmp_path / "a.ngc"
    program.write_text("(G38.2 Z-9 F20)\nG0 X1 ; G38.2 Z-9\nM2\n")

    with pytest.raises(InputError) as refused:
        read_linuxcnc(log, program, None, None, inch=False)

    assert str(refused.value).endswith("expected moves by G38.2 to G38.5, found none")
