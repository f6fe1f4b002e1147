"""``skiplatch diagnose`` and ``skiplatch predict`` as the user meets them."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from played_campaigns import few_of
from skiplatch import cli
from skiplatch.diagnosis import Verdict
from skiplatch.diagnosis.verdict.reliability import reliability
from skiplatch.errors import InputError

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
BENCH = SAMPLES / "bench_isr_latency"
QUIET_BENCH = Path(__file__).parent / "data" / "bench_no_gap"


def run(*arguments: str) -> str:
    result = CliRunner().invoke(cli.group, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def predict(out: Path, *options: str) -> list[dict[str, str]]:
    run(
        "predict",
        str(BENCH),
        "--conditions",
        str(BENCH / "touches.csv"),
        "--out",
        str(out),
        "--replicates",
        "5",
        *options,
    )
    return list(csv.DictReader(out.read_text().splitlines()))


@pytest.mark.parametrize("command", ["diagnose", "predict"])
def test_help_has_an_example(command: str) -> None:
    assert f"Example:\n    skiplatch {command} " in run(command, "--help")


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """What comes of a diagnosis that nobody watches, beside the truth; and its JSON file."""
    path = tmp_path_factory.mktemp("diagnosed") / "diagnosis.json"
    options = ["--truth", "isr_latency:latency_us=41.7", "--json", str(path), "--fail-on-gap"]
    return CliRunner().invoke(cli.group, ["diagnose", str(BENCH), *options]), path


def few_in(folder: Path, sample: Path) -> Path:
    """Copy some touches of a campaign into a folder."""
    copy = folder / sample.name
    shutil.copytree(sample, copy)
    few_of(copy)
    return copy


@pytest.fixture(scope="module")
def without_a_gap(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """What comes of two campaigns without a gap, which nobody watches; and their JSON file."""
    folder = tmp_path_factory.mktemp("without_a_gap")
    quiet = [few_in(folder, sample) for sample in (QUIET_BENCH, SAMPLES / "machine_no_gap")]
    words = ["diagnose", *map(str, quiet), "--fail-on-gap", "--json", str(folder / "several.json")]
    return CliRunner().invoke(cli.group, words), folder / "several.json"


@pytest.mark.long
def test_several_campaigns_are_a_list_in_their_order(without_a_gap: tuple[Result, Path]) -> None:
    result, out = without_a_gap

    said = result.output
    bench, machine = json.loads(out.read_text())
    assert (bench["verdict"], machine["verdict"]) == ("no_gap", "no_gap")
    assert bench["seed"] == machine["seed"] == 1
    assert bench["gap"].keys() > machine["gap"].keys()
    first, second = "bench_no_gap: bench campaign", "machine_no_gap: machine campaign"
    assert said.index(first) < said.index(second)


def test_a_folder_that_is_none_is_refused_before_any_is_diagnosed(tmp_path: Path) -> None:
    out = tmp_path / "several.json"

    result = CliRunner().invoke(
        cli.group, ["diagnose", str(BENCH), str(tmp_path / "none"), "--json", str(out)]
    )

    assert isinstance(result.exception, InputError)
    assert not result.output
    assert not out.exists()


def test_a_page_shows_one_campaign(tmp_path: Path) -> None:
    words = ["diagnose", str(BENCH), str(BENCH), "--html", str(tmp_path / "page.html")]

    result = CliRunner().invoke(cli.group, words)

    assert result.exit_code == 2
    assert "--html shows one campaign" in result.output


def test_a_recorded_interrupt_latency_is_named_and_the_gap_shrinks(
    diagnosed: tuple[Result, Path],
) -> None:
    result, path = diagnosed
    found = json.loads(path.read_text())

    assert found["verdict"] == Verdict.EXPLAINED
    assert "A gap counts from 0.2 of the rig's own spread on." in result.output
    (named,) = found["effects"]
    assert named["id"] == "isr_latency"
    assert named["params"]["latency_us"] == pytest.approx(41.7, abs=0.1)
    assert not named["alternatives"]
    assert named["confidence"] == pytest.approx(reliability(Verdict.EXPLAINED), rel=0.01)
    assert found["where"][0]["stage"] == "latch"
    assert found["where"][0]["paths"] == "skip"
    gap = found["gap"]["latch_after_edge_us"]
    assert gap["before"] == pytest.approx(41.7, abs=0.3)
    assert gap["after"] < 0.3
    assert gap["shrink_interval"][0] > 0.95


def test_diagnosis_and_prediction_go_together(
    diagnosed: tuple[Result, Path], tmp_path: Path
) -> None:
    _, diagnosis = diagnosed
    document = json.loads(diagnosis.read_text())
    assert document["format"] == "skiplatch-diagnosis/2"
    assert document["verdict"] == "explained"
    assert [effect["id"] for effect in document["effects"]] == ["isr_latency"]

    def latency_us(rows: list[dict[str, str]]) -> float:
        return float(np.min([float(r["latch_us"]) - float(r["edge_us"]) for r in rows]))

    nominal = predict(tmp_path / "nominal.csv")
    predicted = predict(tmp_path / "predicted.csv", "--diagnosis", str(diagnosis))

    assert len(nominal) == len(predicted) == 5 * 400
    assert latency_us(nominal) < 10.0
    recorded = list(csv.DictReader((BENCH / "touches.csv").read_text().splitlines()))
    edges = {row["touch"]: float(row["edge_us"]) for row in recorded}
    for row in predicted:
        assert float(row["edge_us"]) == edges[row["touch"]]
    skip = {row["touch"] for row in recorded if row["path"] == "skip"}
    waits = [float(r["latch_us"]) - float(r["edge_us"]) for r in predicted if r["touch"] in skip]
    assert np.median(waits) == pytest.approx(48.7, abs=0.5)


@pytest.mark.long
def test_what_is_below_a_stated_size_is_no_gap(tmp_path: Path) -> None:
    diagnosis = tmp_path / "diagnosis.json"
    few = few_in(tmp_path, BENCH)
    output = run("diagnose", str(few), "--material-us", "60", "--json", str(diagnosis))

    said = "A gap counts from 60 µs on in times, and from 0.2 of the rig's own spread on in lengths"
    assert said in output
    document = json.loads(diagnosis.read_text())
    assert document["verdict"] == "no_gap"
    assert document["effects"] == []
    assert document["material"] == {"fraction": 0.2, "us": 60.0, "um": None}


def test_the_truth_of_a_simulated_campaign_is_an_oracle(diagnosed: tuple[Result, Path]) -> None:
    result, diagnosis = diagnosed

    assert "the truth does" in result.output
    gap = json.loads(diagnosis.read_text())["gap"]["latch_after_edge_us"]
    low, high = gap["oracle_shrink_interval"]
    assert 0.95 < low <= gap["oracle_shrink"] <= high <= 1.0
    assert gap["shrink"] == pytest.approx(gap["oracle_shrink"], abs=0.01)


@pytest.mark.parametrize("option", ["--material-us", "--material-um", "--material-fraction"])
@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf", "wide"])
def test_a_bad_threshold_is_refused(option: str, value: str) -> None:
    result = CliRunner().invoke(cli.group, ["diagnose", str(BENCH), option, value])

    assert result.exit_code == 2
    assert f"Invalid value for '{option}': expected a number from 1e-06 to " in result.output
    assert f', got "{value}"' in result.output


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "diagnosis.json:1:2: no JSON"),
        ("[]", 'expected a diagnosis of the format "skiplatch-diagnosis/2"'),
    ],
)
def test_a_bad_diagnosis_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "diagnosis.json"
    path.write_text(text)

    with pytest.raises(InputError, match=r".*") as caught:
        predict(tmp_path / "out.csv", "--diagnosis", str(path))

    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out.csv").exists()


def test_json_for_stdout_is_alone_there() -> None:
    result = CliRunner().invoke(cli.group, ["check", str(BENCH), "--json", "-"])

    assert json.loads(result.stdout)["kind"] == "bench"
    assert "400 touches" in result.stderr


def test_a_gap_fails_a_run_that_nobody_watches(
    diagnosed: tuple[Result, Path], without_a_gap: tuple[Result, Path]
) -> None:
    assert diagnosed[0].exit_code == 1, diagnosed[0].output
    assert without_a_gap[0].exit_code == 0, without_a_gap[0].output
