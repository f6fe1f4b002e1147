"""The JSON of a diagnosis is read by one rule, whichever command reads it."""

import json
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from conftest import SAMPLES
from refusals import refusal
from skiplatch.api.diagnosed import read_diagnosis
from skiplatch.campaign import read_campaign, read_nominal
from skiplatch.cli import group
from skiplatch.diagnosis import rig_from_json
from skiplatch.diagnosis.experiment import models_from_json
from skiplatch.diagnosis.reported.adoption import adopted
from skiplatch.diagnosis.reported.schema import read_diagnosis_json
from skiplatch.errors import InputError
from skiplatch.fleet.diagnosed import diagnosed
from skiplatch.places import ROOT

WRITTEN = ROOT / "tests" / "fuzz" / "corpus" / "readers" / "diagnosis" / "seed.json"
NOMINAL = read_nominal(SAMPLES / "bench_isr_latency" / "nominal.toml")
TOUCHES = read_campaign(SAMPLES / "bench_isr_latency").touches
READERS: dict[str, Callable[[Path], object]] = {
    "adopt": lambda path: read_diagnosis_json(path, adopted),
    "predict": lambda path: read_diagnosis_json(path, lambda read: rig_from_json(read, NOMINAL)),
    "design": lambda path: read_diagnosis_json(path, models_from_json),
    "fleet add": lambda path: diagnosed(path.parent, TOUCHES),
    "read_diagnosis": read_diagnosis,
}
NUMBER = "a number from -1e+15 to 1e+15"
PAIR = "two numbers from -1e+15 to 1e+15, low first"
DAMAGES: dict[str, tuple[tuple[str | int, ...], object, str]] = {
    "a number for the next experiment": (("next_experiment",), 7, "expected an object, got 7"),
    "a number for its touches": (("next_experiment", "touches"), 7, "expected a list, got 7"),
    "a text for what is left": (("left",), "little", 'expected a list, got "little"'),
    "a text for the touches": (("touches",), "all", 'expected a whole number or null, got "all"'),
    "no effects": (("effects",), None, "expected a list, got null"),
    "a reversed interval": (
        ("effects", 0, "intervals", "latency_us"),
        [4.0, 2.0],
        f"expected {PAIR}, got 4 and 2",
    ),
    "an interval of NaN": (
        ("effects", 0, "intervals", "latency_us"),
        [float("nan"), 2.0],
        f"expected {PAIR}, got nan and 2",
    ),
    "true": (("effects", 0, "params", "latency_us"), True, f"expected {NUMBER}, got true"),
    "text": (("effects", 0, "params", "latency_us"), "41.7", f'expected {NUMBER}, got "41.7"'),
    "range": (("effects", 0, "params", "latency_us"), 1e6, "expected -1000 to 5000, got 1e+06"),
    "parameter": (("effects", 0, "params", "colour"), 1.0, "no such parameter"),
    "interval of nothing": (("effects", 0, "intervals", "colour"), [0, 1], "no such parameter"),
    "effect": (("effects", 0, "id"), "backlsh", 'no effect is called "backlsh"; did you mean '),
    "touch": (("effects", 0, "since"), -3, "expected the number of a touch or null, got -3"),
    "confidence": (("effects", 0, "confidence"), 1.5, "expected a number from 0 to 1, got 1.5"),
    "models": (("models",), {}, "expected a list, got an object"),
    "parameter of a model": (("models", 0, 0, "params"), [], "expected an object, got a list"),
    "verdict": (("verdict",), "sure", "expected no_gap, explained, "),
    "gap": (("gap", "deviation_um", "before"), None, f"expected {NUMBER}, got null"),
    "belief": (("beliefs", "skip.jitter_us", "fitted"), "5", f'expected {NUMBER}, got "5"'),
}


def document() -> dict[str, Any]:
    written: dict[str, Any] = json.loads(WRITTEN.read_text(encoding="utf-8"))
    return {"next_experiment": {}} | written


def changed(where: tuple[str | int, ...], value: object) -> dict[str, Any]:
    whole: Any = document()
    inner = whole
    for part in where[:-1]:
        inner = inner[part]
    inner[where[-1]] = value
    return dict(whole)


def kept(folder: Path, found: dict[str, Any]) -> Path:
    path = folder / "diagnosis.json"
    path.write_text(json.dumps(found), encoding="utf-8")
    return path


def key(where: tuple[str | int, ...]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in where)[1:]


@pytest.mark.parametrize("reader", READERS)
def test_what_diagnose_wrote_is_read(reader: str, tmp_path: Path) -> None:
    assert READERS[reader](kept(tmp_path, document()))


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("damage", DAMAGES)
def test_every_reader_refuses_a_damage_by_file_and_key(
    damage: str, reader: str, tmp_path: Path
) -> None:
    where, value, told = DAMAGES[damage]
    path = kept(tmp_path, changed(where, value))

    assert refusal(READERS[reader], path, folder=tmp_path).startswith(
        f"diagnosis.json: {key(where)}: {told}"
    )


@pytest.mark.parametrize("reader", READERS)
def test_an_effect_named_twice_is_refused(reader: str, tmp_path: Path) -> None:
    twice = document()
    twice["effects"].append(deepcopy(twice["effects"][0]))

    told = refusal(READERS[reader], kept(tmp_path, twice), folder=tmp_path)

    assert told == "diagnosis.json: effects[1].id: isr_latency stands there a second time"


@pytest.mark.parametrize("reader", READERS)
def test_an_effect_that_ends_before_it_begins_is_refused(reader: str, tmp_path: Path) -> None:
    backwards = document()
    backwards["effects"][0] |= {"since": 20, "until": 5}

    told = refusal(READERS[reader], kept(tmp_path, backwards), folder=tmp_path)

    assert told == "diagnosis.json: effects[0].until: expected a touch from since = 20 on, got 5"


@pytest.mark.parametrize(
    ("reader", "missing"),
    [
        ("design", "models"),
        ("design", "verdict"),
        ("fleet add", "gap"),
        ("fleet add", "where"),
        ("read_diagnosis", "gap"),
        *((reader, "effects") for reader in READERS),
    ],
)
def test_what_a_command_needs_and_is_not_there_is_named(
    reader: str, missing: str, tmp_path: Path
) -> None:
    found = document()
    del found[missing]

    told = refusal(READERS[reader], kept(tmp_path, found), folder=tmp_path)

    assert told == f"diagnosis.json: {missing}: missing from the diagnosis"


@pytest.mark.parametrize("reader", ["fleet add", "read_diagnosis"])
def test_a_parameter_without_an_interval_is_named(reader: str, tmp_path: Path) -> None:
    found = document()
    del found["effects"][0]["intervals"]["tail_us"]

    told = refusal(READERS[reader], kept(tmp_path, found), folder=tmp_path)

    assert told == "diagnosis.json: effects[0].intervals.tail_us: missing from the diagnosis"


@pytest.mark.parametrize("belief", ["backlash.nope", "backlash.backlash_um", "probe.colour"])
def test_a_belief_that_the_rig_has_not_is_refused(belief: str, tmp_path: Path) -> None:
    path = kept(tmp_path, changed(("beliefs", belief), {"fitted": 3.0}))

    told = refusal(READERS["predict"], path, folder=tmp_path)

    assert told == f"diagnosis.json: beliefs.{belief}: no such belief about the rig in nominal.toml"


def test_a_datum_out_of_this_world_is_told_with_its_file(tmp_path: Path) -> None:
    path = kept(tmp_path, changed(("beliefs", "datum.X.surface_um"), {"fitted": 1e14}))
    conditions, out = SAMPLES / "bench_isr_latency" / "touches.csv", tmp_path / "out.csv"
    words = ["predict", str(SAMPLES / "bench_isr_latency"), "--diagnosis", str(path)]

    result = CliRunner().invoke(group, [*words, "--conditions", str(conditions), "-o", str(out)])

    assert isinstance(result.exception, InputError)
    assert str(result.exception).startswith(f"{path}: beliefs.datum.X.surface_um: expected ")
    assert not out.exists()
