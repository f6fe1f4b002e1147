"""Surfaces of one height at several places: each has a program of its own that says where."""

import json
import re
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch.campaign import Axis, InputPath, Touches, read_campaign
from skiplatch.cli import group
from skiplatch.diagnosis.experiment.logged import as_imported
from skiplatch.probing_program import KINDS, Programs, programs

PLACES = {(0.0, 0.0): -10.0, (50.0, 0.0): -10.2, (50.0, 40.0): -9.9}
"""X and Y, and the height there: all within what one surface may vary by."""
LATE = {"id": "trigger_delay", "params": {"delay_us": 2000.0, "jitter_us": 0, "tail_us": 0}}


def run(*words: str | Path) -> str:
    done = CliRunner().invoke(group, list(map(str, words)), catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


def latched(z: float, feed: float) -> float:
    return z - feed / 60.0 * 0.004


def log_of(at: Sequence[tuple[float, float, float]]) -> str:
    return "".join(f"{x:f} {y:f} {z:f} 0.0 0.0 0.0 0.0 0.0 0.0\n" for x, y, z in at)


def recorded(folder: Path) -> Path:
    """A campaign of what PROBEOPEN logged at three places, by turns at two feeds."""
    program, at = ["G21 G90", "(PROBEOPEN p.txt)"], []
    for turn in range(8):
        feed = (30.0, 300.0)[turn % 2]
        for (x, y), z in PLACES.items():
            program += ["G0 Z0", f"G0 X{x:g} Y{y:g}", f"G38.2 Z-20 F{feed:g}"]
            at.append((x, y, latched(z, feed) + 0.001 * (turn % 3)))
    (folder / "p.ngc").write_text("\n".join([*program, "(PROBECLOSE)", "M2"]) + "\n")
    (folder / "p.txt").write_text(log_of(at))
    words = ("--program", folder / "p.ngc", "-o", folder / "mill")
    run("import", "linuxcnc", folder / "p.txt", *words)
    return folder / "mill"


def carried_out(text: str) -> str:
    """Give the log of a program, the probe set where its first line says."""
    title = re.search(r"; surface Z- at \S+ mm, X(\S+) Y(\S+), program", text)
    assert title
    x, y = float(title[1]), float(title[2])
    moves = re.findall(r"^G38\.2 Z\S+ F(\S+)$", text, re.MULTILINE)
    return log_of([(x, y, latched(PLACES[x, y], float(feed))) for feed in moves])


@pytest.mark.filterwarnings("ignore:.*time_s. not recorded")
def test_each_place_of_a_log_has_a_program_that_is_imported_as_that_place(tmp_path: Path) -> None:
    mill, left = recorded(tmp_path), tmp_path / "left.json"
    found = {"format": "skiplatch-diagnosis/2", "verdict": "explained", "effects": []}
    left.write_text(json.dumps({**found, "models": [[LATE]]}))

    words = ("--diagnosis", left, "--gcode", "linuxcnc", "-o", tmp_path / "next.csv")
    said = run("design", mill, *words)

    texts = {path.stem: path.read_text() for path in sorted(tmp_path.glob("next-*.ngc"))}
    assert len(texts) == len(PLACES)
    for name, text in texts.items():
        (tmp_path / f"{name}.txt").write_text(carried_out(text))
    command = next(line for line in said.splitlines() if line.startswith("Then: "))
    then = shlex.split(command.removeprefix("Then: skiplatch "))
    files = [str(tmp_path / w) if re.match(r"next-|made", w) else w for w in then]
    run(*files)
    before, made = (read_campaign(folder).touches for folder in (mill, tmp_path / "made"))
    assert sorted(made.session_names) == sorted(before.session_names)
    assert np.abs(made.deviation_um).max() < 20.0


def at_places(*sessions: str, position_mm: Sequence[float] = (-10.0, -9.9)) -> Touches:
    turn = np.arange(8)
    return Touches.from_columns(
        touch=turn,
        path=np.full(8, InputPath.SKIP),
        axis=np.full(8, Axis.Z),
        sign=np.full(8, -1.0),
        feed_mm_min=np.full(8, 60.0),
        approach_mm=np.full(8, 2.0),
        position_mm=np.array(position_mm)[turn % 2],
        session=[sessions[i % len(sessions)] for i in turn],
    )


def made_of(kind: str, touches: Touches) -> Programs:
    return programs(kind, touches, [1.0] * 8, (-20.0, 20.0), "next", Path("mill"))


@pytest.mark.parametrize("kind", KINDS)
def test_programs_of_every_controller_name_the_places(kind: str) -> None:
    made = made_of(kind, at_places("Z- at 5 0", "after homing 2 Z- at 50 40.5 #1"))

    text = "\n".join(made.texts.values())
    assert "surface Z- at -10 mm, X5 Y0" in text
    assert "surface Z- at -9.9 mm, X50 Y40.5" in text
    assert not made.doubts


def test_a_place_that_was_touched_after_homing_anew_is_the_same_one() -> None:
    made = made_of("grbl", at_places("Z- at 50 40", "after homing 2 Z- at 50 40"))

    assert list(made.texts) == ["next.nc"]


def test_linuxcnc_ends_a_program_that_is_begun_at_another_place() -> None:
    (text,) = made_of("linuxcnc", at_places("Z- at 50 40 0 0 30")).texts.values()

    (condition,) = re.findall(r"^o1 if (.*)$", text, re.MULTILINE)
    for part in ("#5061 - [50]", "#5062 - [40]", "#5066 - [30]"):
        assert f"[ABS[{part}] LE 0.5]" in condition
    assert condition.count("[") == condition.count("]")
    assert "(MSG, this is not surface Z- at -10 mm, X50 Y40 C30, or not in its" in text


def test_azimuths_of_a_table_are_no_coordinates() -> None:
    ring = replace(at_places("Z- at 90 0", "Z- at 180 0"), alpha_deg=np.tile([90.0, 180.0], 4))

    made = made_of("linuxcnc", ring)

    assert "; surface Z- at -10 mm, place 90 0, program 1 of 2" in made.texts["next-1.ngc"]
    assert "#5061" not in made.texts["next-1.ngc"]


@pytest.mark.parametrize("session", ["", "morning", "X- at noon"])
def test_places_that_nobody_recorded_are_said_to_count_as_one(session: str) -> None:
    made = made_of("grbl", at_places(session))

    assert list(made.texts) == ["next.nc"]
    (said,) = made.doubts
    assert said == (
        "surface Z- at -10 mm: places within 0.5 mm along Z count as one, as the campaign does not "
        "say where they lie on the other axes"
    )


def test_places_of_the_very_same_height_are_of_a_datum_each(tmp_path: Path) -> None:
    touches = at_places("Z- at 0 0", "Z- at 50 0", position_mm=(-10.0, -10.0))

    _, apart = as_imported(read_campaign(recorded(tmp_path)).nominal, touches)

    assert len(set(apart.session.tolist())) == 2
