"""``skiplatch design`` as the user meets it."""

import csv
import json
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch import cli
from skiplatch.campaign import Touches, format_touches, read_conditions
from skiplatch.errors import InputError

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
BENCH = SAMPLES / "bench_isr_latency"
LATE = {"id": "trigger_delay", "params": {"delay_us": 800.0, "jitter_us": 0, "tail_us": 0}}


def run(*arguments: str) -> str:
    result = CliRunner().invoke(cli.group, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_help_has_an_example() -> None:
    assert "Example:\n    skiplatch design " in run("design", "--help")


@pytest.mark.long
def test_the_conditions_are_read_again_and_played(tmp_path: Path) -> None:
    conditions, document = tmp_path / "next.csv", tmp_path / "next.json"
    options = ("--out", str(conditions), "--touches", "25", "--json", str(document))
    text = run("design", str(BENCH), *options)

    again = read_conditions(conditions)
    names = conditions.read_text().splitlines()[0].split(",")
    assert format_touches(again, names) == conditions.read_text()
    assert not {"latch_us", "report_us", "deviation_um", "status"} & set(names)
    assert len(again) == 25
    assert np.array_equal(again.touch, np.arange(25))
    experiment = json.loads(document.read_text())
    assert sum(touch["count"] for touch in experiment["touches"]) == 25
    assert experiment["why"] in text
    assert f"{conditions}: 25 touches" in text

    predicted = tmp_path / "predicted.csv"
    play = ("--conditions", str(conditions), "--out", str(predicted), "--replicates", "3")
    run("predict", str(BENCH), *play)
    rows = list(csv.DictReader(predicted.read_text().splitlines()))
    assert len(rows) == 75
    assert all(row["status"] == "ok" for row in rows)


def test_a_campaign_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        run("design", str(tmp_path / "none"), "--out", str(tmp_path / "next.csv"))

    assert not (tmp_path / "next.csv").exists()


def left_by_a_diagnosis(path: Path, *models: Mapping[str, object]) -> Path:
    found = {"format": "skiplatch-diagnosis/2", "verdict": "explained", "effects": []}
    path.write_text(json.dumps({**found, "models": [[model] for model in models]}))
    return path


def test_a_diagnosis_that_is_there_is_not_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    believed = left_by_a_diagnosis(tmp_path / "d.json", LATE)
    monkeypatch.setattr("skiplatch.commands.design.diagnose", None)
    machine = tmp_path / "machine"
    shutil.copytree(SAMPLES / "machine_no_gap", machine)
    nominal = machine / "nominal.toml"
    text = nominal.read_text().replace("skiplatch-campaign/1", "skiplatch-campaign/2")
    nominal.write_text(text.replace("[axis]", "[axis]\nmin_mm = 20.0\nmax_mm = 60.0"))
    keep(machine, path="plc")
    out = tmp_path / "next.csv"
    words = ("--diagnosis", str(believed), "--gcode", "linuxcnc", "--touches", "25")

    said = run("design", str(machine), *words, "-o", str(out))

    made = read_conditions(out)
    start = made.position_mm - made.sign * made.approach_mm
    assert ((made.position_mm >= 20.0) & (made.position_mm <= 60.0)).all()
    assert ((start >= 20.0 - 1e-9) & (start <= 60.0 + 1e-9)).all()
    texts = [path.read_text() for path in tmp_path.glob("next-*.ngc")]
    assert sum(text.count("\nG38.2") for text in texts) == 25
    assert len(texts) == len({(axis, sign, place) for axis, sign, place in surfaces(made)})
    assert f"next-{len(texts)}.ngc: 25 touches\nThen: skiplatch import linuxcnc next-1.txt" in said
    assert f"--path plc --nominal {machine / 'nominal.toml'} -o made" in said


def test_a_diagnosis_of_other_touches_is_taken_only_when_asked_to(tmp_path: Path) -> None:
    out, believed = tmp_path / "next.csv", left_by_a_diagnosis(tmp_path / "d.json", LATE)
    of_others = {**json.loads(believed.read_text()), "fingerprint": "of others"}
    believed.write_text(json.dumps(of_others))
    words = ("design", str(BENCH), "--diagnosis", str(believed), "--touches", "5", "-o", str(out))

    with pytest.raises(InputError, match="a diagnosis of other touches than those of"):
        run(*words)

    assert not out.exists()
    run(*words, "--other-touches")
    assert out.exists()


def keep(machine: Path, **wanted: str) -> None:
    """Leave only the touches with these cells."""
    head, *rows = (machine / "touches.csv").read_text().splitlines()
    cells = [dict(zip(head.split(","), row.split(","), strict=True)) for row in rows]
    kept = [row for row, c in zip(rows, cells, strict=True) if wanted.items() <= c.items()]
    (machine / "touches.csv").write_text("\n".join([head, *kept]) + "\n")


def test_a_plan_for_klipper_asks_for_feeds_that_its_log_prints(tmp_path: Path) -> None:
    machine, out = tmp_path / "machine", tmp_path / "next.csv"
    shutil.copytree(SAMPLES / "machine_no_gap", machine)
    keep(machine, path="plc", axis="X", sign="-1")
    touches = (machine / "touches.csv").read_text()
    (machine / "touches.csv").write_text(touches.replace(",X,-1,", ",Z,-1,"))
    believed = left_by_a_diagnosis(tmp_path / "d.json", LATE)
    words = ("--diagnosis", str(believed), "--gcode", "klipper", "--touches", "25")

    said = run("design", str(machine), *words, "-o", str(out))

    speeds = re.findall(r"PROBE_SPEED=(\S+)", (tmp_path / "next.gcode").read_text())
    feeds = sorted(read_conditions(out).feed_mm_min)
    assert feeds == pytest.approx(sorted(float(speed) * 60.0 for speed in speeds))
    assert "Feeds are multiples of 6 mm/min, as klipper's log prints no finer ones.\n" in said


def surfaces(touches: Touches) -> Iterator[tuple[float, float, float]]:
    yield from zip(touches.axis, touches.sign, touches.position_mm, strict=True)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("pa(ren).csv", 'expected a name of A-Z, a-z, 0-9, _ and - alone, which .*"pa\\(ren\\)"'),
        ("next.csv", "no program for grbl: expected touches of one path"),
    ],
)
def test_what_no_program_can_be_is_refused_before_the_diagnosis(
    name: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("skiplatch.commands.design.diagnose", None)
    machine = str(SAMPLES / "machine_no_gap")

    with pytest.raises(InputError, match=message):
        run("design", machine, "--gcode", "grbl", "-o", str(tmp_path / name))


@pytest.mark.parametrize("text", ["{}", "[]", '{"verdict": "sure", "models": []}', '{"models": 3}'])
def test_what_is_no_diagnosis_is_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "d.json").write_text(text)

    with pytest.raises(InputError, match=r"d\.json: expected a diagnosis"):
        run("design", str(BENCH), "--diagnosis", str(tmp_path / "d.json"), "-o", "next.csv")
