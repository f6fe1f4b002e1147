"""``skiplatch import marlin``: an attempt that failed counts once, however often that is said."""

from pathlib import Path

import pytest

from test_import_logs import Run

TOUCH = "Bed X: 50.00 Y: 50.00 Z: -0.12{}\nok\n"
FAILED = "Error:Probing Failed\n"
AGAIN = f"[ERROR] {FAILED}"
PRONTERFACE = ">>> G30\nSENDING:G30\n"


def missed(tmp_path: Path, text: str) -> list[bool]:
    (tmp_path / "console.txt").write_text(text)
    found: list[bool] = Run(
        tmp_path, "marlin", str(tmp_path / "console.txt")
    ).campaign.touches.missed.tolist()
    return found


def console(command: str, replies: list[str]) -> str:
    return "".join(command + reply for reply in replies)


TOUCHES = [TOUCH.format(digit) for digit in "1859"]


@pytest.mark.parametrize("command", ["", PRONTERFACE, "Send: N12 G30*55\n"])
def test_error_that_a_sender_shows_again_is_one_attempt(tmp_path: Path, command: str) -> None:
    text = console(command, [*TOUCHES, FAILED + AGAIN])

    assert missed(tmp_path, text) == [False] * 4 + [True]


def test_error_told_again_later_is_one_attempt_of_the_one_command(tmp_path: Path) -> None:
    text = console(PRONTERFACE, [*TOUCHES, f"{FAILED}T:24.9 B:60.0\n{FAILED}", TOUCHES[0]])

    assert missed(tmp_path, text) == [False] * 4 + [True, False]


def test_error_that_is_shown_again_is_none_of_a_command_without_a_reply(tmp_path: Path) -> None:
    text = console(PRONTERFACE, [*TOUCHES, "", FAILED + AGAIN])

    assert missed(tmp_path, text) == [False] * 4 + [True]


def test_errors_at_two_times_are_two(tmp_path: Path) -> None:
    text = console("", TOUCHES) + f"10:00:01 {FAILED}10:00:09 {FAILED}"

    assert missed(tmp_path, text) == [False] * 4 + [True] * 2


@pytest.mark.parametrize("command", ["", PRONTERFACE])
def test_errors_of_several_attempts_are_several(tmp_path: Path, command: str) -> None:
    text = console(command, [*TOUCHES, FAILED, FAILED])

    assert missed(tmp_path, text) == [False] * 4 + [True] * 2


def test_commands_that_wait_fail_one_by_one(tmp_path: Path) -> None:
    text = console(PRONTERFACE, TOUCHES) + "Send: G30\nSend: G30 X1\n" + FAILED * 2

    assert missed(tmp_path, text) == [False] * 4 + [True] * 2


def test_what_only_repeats_is_said(tmp_path: Path) -> None:
    (tmp_path / "console.txt").write_text(console(PRONTERFACE, [*TOUCHES, FAILED + AGAIN]))

    said = Run(tmp_path, "marlin", str(tmp_path / "console.txt")).said

    assert any(
        line.startswith("errors that only repeat the one before") for line in said["assumed"]
    )
    assert any("1 of 5 attempts" in line for line in said["known"])
