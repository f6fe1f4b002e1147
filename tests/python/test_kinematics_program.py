"""NC programs with touch-probe cycles, as they are read."""

import re
from pathlib import Path

import pytest

from kinematics_programs import SAMPLES, program_of
from skiplatch.errors import InputError
from skiplatch.kinematics.program import Program, read_program, texts


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


ISO = """%KINE MATICS G71 *
N10 T "TOUCH PROBE" G17 *
N20 G450 Q410=+0 QS409="old one" *
N30 G451 MEASURE KINEMATICS ~
Q406=+1 ;MODE ~
  Q407=+12.5 ;SPHERE RADIUS *
N40 G451 Q406=0 Q407=10 ;CHECK
N99999999 %KINE MATICS G71 *
"""


def test_an_iso_program_says_the_same(tmp_path: Path) -> None:
    program = read_program(program_of(tmp_path, ISO))

    assert (program.tool, program.is_inch) == ("TOUCH PROBE", False)
    assert list(texts(program)) == [
        "TCH PROBE 450 Q410=+0 Q409=old one",
        "TCH PROBE 451 Q406=+1 Q407=+12.5",
        "TCH PROBE 451 Q406=+0 Q407=+10",
    ]
    radius = program.cycles[2].parameters[407]
    assert (radius.line, radius.column) == (7, 22)
    assert read_program(program_of(tmp_path, ISO.replace("G71", "G70"))).is_inch


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("N20 G450", "N20 G454", ":3:5: expected cycle 450, 451, 452 or 453, got 454"),
        ("Q407=10", "Q407=x", ':7:22: expected a number, got "x"'),
        ("N10 T", "N10 G0 X", ":2:5: expected a block T, G450 to G453 or %"),
    ],
)
def test_a_slip_in_an_iso_program_is_named(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        read_program(program_of(tmp_path, ISO.replace(old, new)))


def test_a_program_may_have_a_name_with_spaces(tmp_path: Path) -> None:
    text = "0 BEGIN PGM my old one INCH\n12 TCH PROBE 450 X ~\nQ410=+0\n9 END PGM my old one INCH\n"

    assert read_program(program_of(tmp_path, text)).is_inch


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no TCH PROBE cycle"),
        ("12 TCH PROBE 454 X\n", ":1:4: expected cycle 450, 451, 452 or 453, got 454"),
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
