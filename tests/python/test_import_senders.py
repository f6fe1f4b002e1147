"""``skiplatch import grbl``: what senders write before commands, and what logs do not tell."""

from pathlib import Path

import numpy as np
import pytest

from test_import_logs import Run

STUDIO = r"""[INFO]18:36:05.212 - Normal info: G53 G0 Z-3.000\r\n
[INFO]18:36:12.861 - Tool change confirmed by user.
[INFO]18:36:13.206 - Normal info: G38.6 Z-108.000 F500.000\r\n
[INFO]18:36:22.294 - Normal info: [PRB:-9.259,-12.709,-77.726:1]\n
[INFO]18:36:22.295 - Normal info: G91 G0 Z1.000\r\n
[INFO]18:36:22.295 - Normal info: G38.6 Z-2.000 F100.000\r\n
[INFO]18:36:23.021 - Normal info: [PRB:-9.259,-12.709,-77.654:1]\n
"""


def test_commands_and_times_behind_words_of_a_studio_are_read(tmp_path: Path) -> None:
    (tmp_path / "s.log").write_text(STUDIO)

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    touches = run.campaign.touches
    assert run.coordinates() == [-77.726, -77.654]
    assert touches.feed_mm_min.tolist() == [500.0, 100.0]
    # Sent at 13.206 s and 22.295 s; a reply comes when the move is over.
    assert np.diff(touches.time_s) == pytest.approx(22.295 - 13.206, abs=0.1)
    assert touches.approach_mm[1] == pytest.approx(0.964)  # to the reference
    assert not any("no command before" in line for line in run.said["assumed"])


@pytest.mark.parametrize(("mode", "is_told"), [("", False), ("G91", True)])
def test_sense_that_no_command_tells_is_said(tmp_path: Path, mode: str, is_told: bool) -> None:
    text = f"{mode}G38.2F300Y-30\n[PRB:-260.815,-166.358,-80.158:1]\nok\n"
    (tmp_path / "s.log").write_text(text)

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    said = any(line.startswith("the sense of 1 touch is not") for line in run.said["assumed"])
    assert said is not is_told
    assert np.isfinite(run.campaign.touches.sign).all() == is_told


@pytest.mark.parametrize("word", ["INFO: Probing", "ERR: Alarm", "WARN: low", "DBG: state"])
def test_words_of_fluidnc_tell_its_controller(tmp_path: Path, word: str) -> None:
    text = f"[MSG:{word}]\nG91G38.2Z-9F60\n[PRB:0.000,0.000,-5.123:1]\nok\n"
    (tmp_path / "s.log").write_text(text)

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert any("'grblhal'" in line for line in run.said["assumed"])


@pytest.mark.parametrize(
    ("line", "is_hal"),
    [
        ("Grbl 1.1f ['$' or '$HELP' for help]", True),
        ("$341=0", True),
        (">>> $$\n$376 = 0    (Invert jog, mask)", True),
        ("Grbl 1.1h ['$' for help]", False),
        ("$132=200.000", False),
    ],
)
def test_greeting_and_settings_tell_grbl_hal(tmp_path: Path, line: str, *, is_hal: bool) -> None:
    (tmp_path / "s.log").write_text(f"{line}\nG91G38.2Z-9F60\n[PRB:0.000,0.000,-5.123:1]\nok\n")

    run = Run(tmp_path, "grbl", str(tmp_path / "s.log"))

    assert any("'grblhal'" in line for line in run.said["assumed"]) is is_hal
