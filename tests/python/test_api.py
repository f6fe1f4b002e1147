"""What `skiplatch` exports: docs/API.md runs as it stands, and says the same as the commands."""

import contextlib
import csv
import inspect
import io
import json
import re
import subprocess
import sys
import types
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import skiplatch
from skiplatch.campaign import Axis
from skiplatch.cli import group
from skiplatch.dataframes import Library
from skiplatch.stand_ins import playable

ROOT = Path(__file__).parents[2]
EXAMPLE = re.compile(r"```python\n(.*?)```\n(?:\n```\n(.*?)```\n)?", re.DOTALL)
DELAY = {"id": "isr_latency", "params": {"latency_us": 40.0, "jitter_us": 0.0}}


def in_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scripts").symlink_to(ROOT / "scripts")
    (tmp_path / "build").mkdir()
    monkeypatch.chdir(tmp_path)


def run_examples(text: str) -> list[tuple[str, str, str]]:
    """Run the blocks one after the other; give each with what it printed and what it should."""
    known: dict[str, Any] = {}
    done = []
    for code, expected in EXAMPLE.findall(text):
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(compile(code, "API.md", "exec"), known)  # noqa: S102 - the page's own
        done.append((code, said.getvalue(), expected))
    return done


@pytest.mark.long
def test_examples_of_the_page_print_what_stands_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_checkout(tmp_path, monkeypatch)

    done = run_examples((ROOT / "docs" / "API.md").read_text())

    assert len(done) >= 5
    for _, said, expected in done:
        assert said == expected
    assert len(skiplatch.read_campaign("build/late").touches) > 100


def test_first_examples_of_the_page_print_what_stands_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_checkout(tmp_path, monkeypatch)
    quick, _, _ = (ROOT / "docs" / "API.md").read_text().partition("## Diagnose")

    done = run_examples(quick)

    assert [said for _, said, _ in done] == [expected for _, _, expected in done]
    assert len(done) == 2


def test_every_name_is_there_and_documented() -> None:
    for name in skiplatch.__all__:
        assert getattr(skiplatch, name).__doc__
    assert set(skiplatch.__all__) <= set(dir(skiplatch))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = skiplatch.nothing


@pytest.mark.parametrize(
    "kind",
    [one for name in skiplatch.__all__ if is_dataclass(one := getattr(skiplatch, name))],
)
def test_docstrings_name_every_attribute_that_is_stable(kind: type) -> None:
    told = inspect.getdoc(kind) or ""
    _, _, listed = told.partition("Attributes:")
    names = set(re.findall(r"\w+", " ".join(re.findall(r"^ +([\w, ]+):", listed, re.M))))

    assert names >= {field.name for field in fields(kind) if not field.name.startswith("_")}
    assert not re.search(r"`[A-Z]{3,}", told)  # what is not exported


def test_import_loads_nothing_that_it_does_not_need() -> None:
    code = "import skiplatch, sys; print(sorted({'numpy', 'scipy', 'click'} & set(sys.modules)))"

    assert subprocess.check_output([sys.executable, "-c", code], text=True) == "[]\n"


def test_simulate_gives_what_the_command_writes(bench_sample: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["simulate", "--nominal", str(bench_sample / "nominal.toml"), "--conditions",
             str(bench_sample / "touches.csv"), "-o", str(out), "--seed", "7",
             "--effect", "isr_latency:latency_us=40"]  # fmt: skip
    assert CliRunner().invoke(group, words, catch_exceptions=False).exit_code == 0
    slow = skiplatch.Effect("isr_latency", {"latency_us": 40.0})

    made = skiplatch.simulate(skiplatch.read_campaign(bench_sample), effects=[slow], seed=7)

    written = skiplatch.read_campaign(out).touches
    assert made.touches.latch_us == pytest.approx(written.latch_us, abs=1e-3, nan_ok=True)
    assert made.touches.deviation_um == pytest.approx(written.deviation_um, abs=1e-3, nan_ok=True)


def test_simulated_touches_of_a_rotary_axis_are_angles(machine_sample: Path) -> None:
    recorded = skiplatch.read_campaign(machine_sample)
    n = len(recorded.touches)
    turning = replace(
        recorded.touches,
        axis=np.full(n, Axis.C, dtype=np.int8),
        position_deg=recorded.touches.position_mm,
        deviation_arcsec=np.full(n, 1e6),
    )

    made = skiplatch.simulate(replace(recorded, touches=turning))

    latched = made.touches.ok
    assert latched.any()
    assert made.touches.deviation_arcsec[latched].max() < 1e5
    assert playable(made).touches.deviation_um == pytest.approx(
        made.touches.deviation_um, nan_ok=True
    )


def document(**changes: object) -> dict[str, Any]:
    effect = {
        **DELAY,
        "stage": "latch",
        "intervals": {"latency_us": [39.0, 41.0], "jitter_us": [0.0, 0.5]},
        "since": 3,
        "confidence": 0.9,
        "alternatives": ["trigger_delay"],
    }
    gap = {"unit": "µs", "before": 20.0, "after": 0.5, "noise_floor": 0.4, "shrink": 0.99,
           "shrink_interval": [0.98, 1.0]}  # fmt: skip
    whole = {
        "format": "skiplatch-diagnosis/2",
        "verdict": "explained",
        "effects": [effect],
        "gap": {"latch_after_edge_us": gap},
        "models": [[DELAY]],
    }
    return whole | changes


def test_diagnosis_is_read_from_its_document() -> None:
    diagnosis = skiplatch.Diagnosis.of_document(document())

    (found,) = diagnosis.effects
    assert (found.effect.id, found.stage, found.effect.span.since) == ("isr_latency", "latch", 3)
    assert found.intervals["latency_us"] == (39.0, 41.0)
    assert diagnosis.gaps["latch_after_edge_us"].reduction == 0.99


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"verdict": "sure"}, "verdict: expected no_gap, "),
        ({"gap": {"a": {}}}, "gap.a.unit: missing from the diagnosis"),
        ({"format": "1"}, "expected a diagnosis of the format "),
    ],
)
def test_what_is_no_diagnosis_is_told_with_its_file(
    changes: dict[str, Any], told: str, tmp_path: Path
) -> None:
    (tmp_path / "d.json").write_text(json.dumps(document(**changes)))

    with pytest.raises(skiplatch.InputError, match=rf"d\.json: {told}"):
        skiplatch.read_diagnosis(tmp_path / "d.json")


def test_predict_plays_the_effects_of_the_diagnosis(bench_sample: Path) -> None:
    campaign = skiplatch.read_campaign(bench_sample)
    always = {**document()["effects"][0], "since": None}
    diagnosis = skiplatch.Diagnosis.of_document(document(effects=[always]))

    plain = skiplatch.predict(campaign, replicates=2)
    late = skiplatch.predict(campaign, diagnosis=diagnosis, replicates=2)

    skip = campaign.touches.on_skip
    later_us = (late.latch_us - plain.latch_us)[:, skip]
    assert late.latch_us.shape == (2, len(campaign.touches))
    assert later_us == pytest.approx(40.0, abs=1.0)


def test_predict_gives_what_the_command_writes(bench_sample: Path, tmp_path: Path) -> None:
    out = tmp_path / "p.csv"
    words = ["predict", str(bench_sample), "--conditions", str(bench_sample / "touches.csv"),
             "--replicates", "3", "-o", str(out)]  # fmt: skip
    assert CliRunner().invoke(group, words, catch_exceptions=False).exit_code == 0
    campaign = skiplatch.read_campaign(bench_sample)

    columns = skiplatch.predict(campaign.nominal, campaign.touches, replicates=3).columns()

    with out.open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(columns)
    assert [int(row["replicate"]) for row in rows] == columns["replicate"].tolist()
    latch_us = [float(row["latch_us"] or "nan") for row in rows]
    assert latch_us == pytest.approx(columns["latch_us"].tolist(), abs=1e-3, nan_ok=True)


def test_design_takes_a_diagnosis_that_is_there(bench_sample: Path) -> None:
    diagnosis = skiplatch.Diagnosis.of_document(document())

    experiment = skiplatch.design(skiplatch.read_campaign(bench_sample), diagnosis, touches=12)

    assert len(experiment.touches) == 12


def test_a_nominal_alone_has_no_conditions(bench_sample: Path) -> None:
    with pytest.raises(TypeError, match="conditions are missing"):
        skiplatch.simulate(skiplatch.read_campaign(bench_sample).nominal)


def test_missing_data_frames_are_named(bench_sample: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    monkeypatch.setitem(sys.modules, "polars", None)
    touches = skiplatch.read_campaign(bench_sample).touches

    with pytest.raises(ImportError, match=r"needs pandas or polars, .* 'skiplatch\[pandas\]'"):
        touches.to_dataframe()
    with pytest.raises(ImportError, match=r"needs polars, .* 'skiplatch\[polars\]'"):
        touches.to_dataframe("polars")
    with pytest.raises(ValueError, match="expected pandas or polars, got 'arrow'"):
        touches.to_dataframe("arrow")  # type: ignore[arg-type]


def test_polars_is_taken_where_pandas_is_not(
    bench_sample: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    monkeypatch.setitem(sys.modules, "polars", types.SimpleNamespace(DataFrame=dict))
    touches = skiplatch.read_campaign(bench_sample).touches

    frame = touches.to_dataframe()

    assert set(frame["path"]) <= {"skip", "plc"}
    assert frame["latch_us"] is touches.latch_us
    assert frame["session"][0] is None


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_data_frames_hold_what_was_recorded(library: Library, bench_sample: Path) -> None:
    pytest.importorskip(library, reason=f"{library} is not installed: make dataframes")
    campaign = skiplatch.read_campaign(bench_sample)

    touches = campaign.touches.to_dataframe(library)
    found = skiplatch.Diagnosis.of_document(document()).to_dataframe(library)
    none = skiplatch.Diagnosis.of_document(document(effects=[])).to_dataframe(library)
    played = skiplatch.predict(campaign, replicates=2).to_dataframe(library)

    assert len(touches) == len(campaign.touches)
    assert list(touches["feed_mm_min"]) == campaign.touches.feed_mm_min.tolist()
    assert set(touches["status"]) <= {"ok", "missed"}
    assert list(found["parameter"]) == ["latency_us", "jitter_us"]
    assert list(found["low"]) == [39.0, 0.0]
    assert (len(none), list(none.columns)) == (0, list(found.columns))
    assert len(played) == 2 * len(campaign.touches)
