"""Former names of effects' parameters are still read, wherever a user wrote them."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from skiplatch import cli
from skiplatch.campaign import read_nominal
from skiplatch.commands.options import EffectType
from skiplatch.errors import InputError
from skiplatch.former_names import PRESENT, renewed
from skiplatch.places import ROOT
from skiplatch.simulator.effects import Effect, effects

SAMPLE = ROOT / "scripts" / "samples" / "bench_isr_latency"
FOUND: dict[str, Any] = {
    "format": "skiplatch-diagnosis/2",
    "verdict": "explained",
    "effects": [
        {
            "id": "report_delay",
            "stage": "report",
            "params": {"delay_us": 80.0, "direct": 0.25},
            "intervals": {"delay_us": [79.0, 81.0], "direct": [0.2, 0.3]},
            "confidence": 0.9,
            "alternatives": [],
        }
    ],
    "gap": {},
    "models": [[{"id": "report_delay", "params": {"direct": 0.25}}]],
}


def diagnosis(folder: Path) -> Path:
    path = folder / "found.json"
    path.write_text(json.dumps(FOUND), encoding="utf-8")
    return path


def rig(folder: Path, table: str) -> Path:
    text = (SAMPLE / "nominal.toml").read_text(encoding="utf-8")
    path = folder / "nominal.toml"
    path.write_text(f"{text.replace('campaign/1', 'campaign/2')}\n{table}", encoding="utf-8")
    return path


def test_a_former_name_is_no_parameter_and_its_present_name_is_one() -> None:
    known = {parameter.name for row in effects().values() for parameter in row.parameters}

    assert not known & PRESENT.keys()
    assert known >= set(PRESENT.values())


@pytest.mark.parametrize("former", PRESENT)
def test_an_effect_takes_a_former_name(former: str) -> None:
    assert Effect("backlash", {former: 0.5}) == Effect("backlash", {PRESENT[former]: 0.5})


def test_the_command_line_takes_a_former_name() -> None:
    given = EffectType().convert("scan_jitter:jitter_us=9,punctual=0.5", None, None)

    assert given == Effect("scan_jitter", {"jitter_us": 9.0, "on_time_share": 0.5})


def test_nominal_toml_takes_a_former_name_with_its_uncertainty(tmp_path: Path) -> None:
    table = '[[effect]]\nid = "backlash"\nbacklash_um = 2.0\ny_more = {value = 0.5, u = 0.1}\n'

    (believed,) = read_nominal(rig(tmp_path, table)).believed_effects

    assert believed.values == {"backlash_um": 2.0, "y_excess_ratio": 0.5}
    assert believed.uncertainty == {"y_excess_ratio": 0.1}


def test_a_parameter_by_both_names_is_refused(tmp_path: Path) -> None:
    table = '[[effect]]\nid = "backlash"\ny_more = 0.5\ny_excess_ratio = 0.5\n'

    with pytest.raises(InputError, match="y_more is the former name of y_excess_ratio"):
        read_nominal(rig(tmp_path, table))


def test_a_diagnosis_is_read_by_present_names() -> None:
    document = renewed(FOUND)

    assert document["effects"][0]["params"] == {"delay_us": 80.0, "unqueued_share": 0.25}
    assert document["effects"][0]["intervals"]["unqueued_share"] == [0.2, 0.3]
    assert document["models"][0][0]["params"] == {"unqueued_share": 0.25}


def test_a_fitted_belief_is_read_by_its_present_name() -> None:
    former = {"beliefs": {"link_retry.again": {"fitted": 0.5}}}

    assert renewed(former) == {"beliefs": {"link_retry.retry_excess": {"fitted": 0.5}}}


def test_adopt_writes_the_present_name_of_what_an_older_diagnosis_found(tmp_path: Path) -> None:
    out = tmp_path / "adopted.toml"
    words = ["adopt", str(SAMPLE), "--diagnosis", str(diagnosis(tmp_path)), "-o", str(out)]

    result = CliRunner().invoke(cli.group, words)

    assert result.exit_code == 0, result.output
    (believed,) = read_nominal(out).believed_effects
    assert believed.values == {"delay_us": 80.0, "unqueued_share": 0.25}
    assert believed.uncertainty["unqueued_share"] == pytest.approx(0.0304, abs=1e-4)


def test_predict_plays_what_an_older_diagnosis_found_as_the_present_one(tmp_path: Path) -> None:
    older = diagnosis(tmp_path)
    present = tmp_path / "present.json"
    present.write_text(json.dumps(renewed(FOUND)), encoding="utf-8")

    assert predicted(older) == predicted(present)


def predicted(found: Path) -> bytes:
    out = found.with_suffix(".csv")
    conditions = ["--conditions", str(SAMPLE / "touches.csv")]
    words = ["predict", str(SAMPLE), "--diagnosis", str(found), *conditions, "-o", str(out)]
    result = CliRunner().invoke(cli.group, words)
    assert result.exit_code == 0, result.output
    return out.read_bytes()
