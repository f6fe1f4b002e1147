"""What commands say of slips: what, where, and what was expected."""

import re
import shutil
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from skiplatch import cli
from skiplatch.cli import group
from skiplatch.commands.numbers import CountType
from skiplatch.errors import InputError

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
BENCH = SAMPLES / "bench_isr_latency"
LOGS = Path(__file__).parent / "data" / "logs"


def simulate(nominal: Path, effect: str, out: Path) -> str:
    words = ["simulate", "--nominal", str(nominal), "--conditions", str(BENCH / "touches.csv")]
    result = CliRunner().invoke(group, [*words, "--effect", effect, "-o", str(out)])
    assert result.exit_code == 2, result.output
    assert not out.exists()
    return result.output


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        ("isr_latency:40", 'expected NAME=VALUE, such as latency_us=…, got "40"'),
        ("isr_latency:latency=40", 'no parameter "latency"'),
        ("trigger_delay:delay_us=40", "an effect of the probe, which a bench has none of"),
    ],
)
def test_effect_that_cannot_be_is_told(effect: str, message: str, tmp_path: Path) -> None:
    assert message in simulate(BENCH / "nominal.toml", effect, tmp_path / "out")


@pytest.mark.parametrize("command", ["compare", "diagnose", "predict"])
def test_figure_that_cannot_be_simulated_is_named(command: str, tmp_path: Path) -> None:
    shutil.copytree(BENCH, tmp_path / "bench")
    nominal = tmp_path / "bench" / "nominal.toml"
    lines = nominal.read_text().splitlines()
    nominal.write_text("\n".join("scan_us = 2" if "scan_us" in x else x for x in lines))
    words = [command, str(tmp_path / "bench")]
    if command == "predict":
        words += ["--conditions", str(BENCH / "touches.csv"), "-o", str(tmp_path / "x.csv")]

    result = CliRunner().invoke(group, words)

    assert isinstance(result.exception, InputError)
    expected = "plc.scan_us: expected 100 to 20000, which is what can be simulated, got 2"
    assert str(result.exception) == f"{nominal}: {expected}"


def test_all_that_is_wrong_with_a_rig_is_told_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(BENCH, tmp_path / "bench")
    nominal = tmp_path / "bench" / "nominal.toml"
    nominal.write_text(
        'format = "skiplatch-campaign/2"\nkind = "bench"\n'
        "plc.scan_us = 2\naxis.resolution_um = 1e5\n"
        "[[effect]]\nid = 'backlahs'\n[[effect]]\nid = 'isr_latency'\nlatency_s = 4\ntail_us = -1\n"
    )
    monkeypatch.setattr(sys, "argv", ["skiplatch", "compare", str(tmp_path / "bench")])

    with pytest.raises(SystemExit) as ended:
        cli.main()

    assert ended.value.code == cli.BAD_INPUT
    beginnings = [line.split(":")[:3] for line in capsys.readouterr().err.splitlines()]
    assert beginnings == [
        ["skiplatch", f" {nominal}", f" {key}"]
        for key in (
            "plc.scan_us",
            "axis.resolution_um",
            "effect.id",
            "effect.isr_latency.latency_s",
            "effect.isr_latency.tail_us",
        )
    ]
    odd = CliRunner().invoke(group, ["check", str(tmp_path / "bench")]).output
    assert odd.count(f"  {nominal}: ") == len(beginnings)


def test_a_log_that_cannot_be_repeated_is_told_by_its_own_name() -> None:
    log = LOGS / "grbl_serial.log"

    result = CliRunner().invoke(group, ["repeat", str(log)])

    assert str(result.exception).startswith(f"{log}: expected a surface that was touched 3 times")


@pytest.mark.parametrize("number", ["9" * 400 + ".5", "nan"])
@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("grbl", "grbl_serial.log"),
        ("klipper", "klippy.log"),
        ("marlin", "marlin_m48.log"),
        ("linuxcnc", "linuxcnc_probe.txt"),
        ("edges", "saleae.csv"),
    ],
)
def test_a_log_of_numbers_without_bounds_is_refused(
    kind: str, name: str, number: str, tmp_path: Path
) -> None:
    log, out = tmp_path / name, tmp_path / "out"
    log.write_text(re.sub(r"\d+\.\d+", number, (LOGS / name).read_text()))

    result = CliRunner().invoke(group, ["import", kind, str(log), "--out", str(out)])

    assert isinstance(result.exception, InputError), result.exception
    assert re.match(re.escape(str(log)) + r"(?::\d+: |: expected )", str(result.exception))
    assert not out.exists()


def diagnosis_with(parameter: str) -> str:
    effect = f'{{"id": "isr_latency", "params": {{"latency_us": {parameter}}}}}'
    found = f'"effects": [{effect}], "models": [[{effect}]], "verdict": "explained"'
    return f'{{"format": "skiplatch-diagnosis/2", {found}, "beliefs": {{}}}}'


@pytest.mark.parametrize("command", ["predict", "adopt", "design"])
@pytest.mark.parametrize(
    ("parameter", "told"),
    [
        ("1e15", "effects[0].params.latency_us: expected -1000 to 5000, got 1e+15"),
        ("NaN", "effects[0].params.latency_us: expected a number from -1e+15 to 1e+15, got nan"),
        ("9" * 400, "no JSON: a whole number beyond 64 bits: "),
    ],
)
def test_a_diagnosis_that_cannot_be_played_is_told_by_file(
    command: str, parameter: str, told: str, tmp_path: Path
) -> None:
    diagnosis, out = tmp_path / "found.json", tmp_path / "out"
    diagnosis.write_text(diagnosis_with(parameter))
    words = [command, str(BENCH), "--diagnosis", str(diagnosis), "--out", str(out)]
    words += ["--conditions", str(BENCH / "touches.csv")] if command == "predict" else []

    result = CliRunner().invoke(group, words)

    assert isinstance(result.exception, InputError), result.exception
    assert str(result.exception).startswith(f"{diagnosis}: {told}")
    assert not out.exists()


def test_an_interval_without_bounds_is_not_adopted(tmp_path: Path) -> None:
    diagnosis, out = tmp_path / "found.json", tmp_path / "out.toml"
    wide = '"intervals": {"latency_us": [-1e308, 1e308]}, "params"'
    diagnosis.write_text(diagnosis_with("41.7").replace('"params"', wide))
    words = ["adopt", str(BENCH), "--diagnosis", str(diagnosis), "--out", str(out)]

    result = CliRunner().invoke(group, words)

    told = "effects[0].intervals.latency_us: expected two numbers from -1e+15 to 1e+15, low first"
    assert str(result.exception) == f"{diagnosis}: {told}, got -1e+308 and 1e+308"
    assert not out.exists()


@pytest.mark.parametrize("command", ["latch", "plan"])
def test_a_rig_that_cannot_be_simulated_is_told_by_file_and_key(
    command: str, tmp_path: Path
) -> None:
    nominal = tmp_path / "nominal.toml"
    nominal.write_text('format = "skiplatch-campaign/2"\n[skip]\njitter_us = 1e15\n')
    words = [command, "--nominal", str(nominal)]
    words += ["--path", "plc", "--uncertainty-um", "2"] if command == "plan" else []

    result = CliRunner().invoke(group, words)

    assert isinstance(result.exception, InputError)
    expected = "skip.jitter_us: expected 0 to 1e+09, which is what can be simulated, got 1e+15"
    assert str(result.exception) == f"{nominal}: {expected}"


@pytest.mark.parametrize(
    ("text", "count"), [("1e5", 100_000), ("250", 250), ("2.5e3", 2500), ("1e+3", 1000)]
)
def test_counts_may_have_powers_of_ten(text: str, count: int) -> None:
    assert CountType(100, 10**9).convert(text, None, None) == count


@pytest.mark.parametrize("text", ["1e1", "1.5", "many", "", "nan", "inf", "1e999", "-1e5"])
def test_counts_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(click.BadParameter):
        CountType(100, 10**9).convert(text, None, None)


def test_what_a_library_quotes_of_a_long_input_is_cut() -> None:
    message = str(InputError(Path("log.csv"), 3, None, "no number: " + "9" * 5000))
    assert message.startswith("log.csv:3: no number: 999")
    assert message.endswith("…")
    assert len(message) < 1100


def test_a_stop_without_end_is_told_by_file_and_key(tmp_path: Path) -> None:
    slow, conditions, out = tmp_path / "slow.toml", BENCH / "touches.csv", tmp_path / "out"
    slow.write_text('format = "skiplatch-campaign/2"\nkind = "bench"\naxis.accel_mm_s2 = 1e-3\n')
    words = ["simulate", "--nominal", str(slow), "--conditions", str(conditions), "-o", str(out)]

    result = CliRunner().invoke(group, words)

    assert isinstance(result.exception, InputError), result.exception
    assert str(result.exception).startswith(f"{slow}: axis.accel_mm_s2: expected so much that ")
    assert not out.exists()


def test_a_campaign_of_one_touch_is_diagnosed_without_a_warning(tmp_path: Path) -> None:
    (tmp_path / "nominal.toml").write_text('format = "skiplatch-campaign/2"\n')
    row = "touch,time_s,path,axis,sign,feed_mm_min,approach_mm,position_mm,deviation_um\n"
    (tmp_path / "touches.csv").write_text(f"{row}0,0,plc,X,1,300,3.5,10,1.5\n")

    result = CliRunner().invoke(group, ["diagnose", str(tmp_path)])

    assert result.exit_code == 0, result.exception
    assert "Too few touches to tell whether there is a gap." in result.stdout
    assert result.stderr == ""
