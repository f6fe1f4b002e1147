"""A periodic error of an axis gets the order and the shaft of its drive."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from effects_rig import MACHINE, mixed_touches
from made_diagnoses import made
from skiplatch import cli
from skiplatch.campaign import write_campaign
from skiplatch.commands import examining
from skiplatch.diagnosis import Named, Verdict
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.errors import InputError
from skiplatch.simulator.effects import Effect, effects
from skiplatch.transmission.source import periodic_sources, read_axis_train

BELT_AND_SCREW = """
[[stage]]
name = "belt"
driver_teeth = 20
driven_teeth = 50

[screw]
lead_mm = 10.0
"""


def error(period_mm: float, amplitude2_um: float = 0.0) -> Effect:
    parameters = {"amplitude_um": 6.0, "period_mm": period_mm, "phase_deg": 70.0}
    return Effect("transmission_error", {**parameters, "amplitude2_um": amplitude2_um})


@pytest.fixture
def description(tmp_path: Path) -> Path:
    path = tmp_path / "train.toml"
    path.write_text(BELT_AND_SCREW)
    return path


@pytest.mark.parametrize(
    ("period_mm", "order", "part"),
    [
        (10.0, 1.0, "screw"),
        (5.0, 2.0, "screw, harmonic 2"),
        (4.0, 2.5, "shaft 1 (input)"),
        (0.2, 50.0, "mesh of belt"),
        (7.3, 1.37, None),
    ],
)
def test_a_period_is_an_order_of_the_screw_and_has_its_part(
    description: Path, period_mm: float, order: float, part: str | None
) -> None:
    (source,) = periodic_sources([error(period_mm)], read_axis_train(description))

    assert source.order == pytest.approx(order, rel=1e-3)
    assert source.part == part


def test_a_second_order_is_named_by_itself(description: Path) -> None:
    sources = periodic_sources([error(8.0, amplitude2_um=2.0)], read_axis_train(description))

    assert [source.part for source in sources] == [None, "shaft 1 (input)"]


def test_a_train_without_a_screw_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "train.toml"
    path.write_text(BELT_AND_SCREW.split("[screw]", maxsplit=1)[0])

    with pytest.raises(InputError, match="lead_mm"):
        read_axis_train(path)


def test_a_diagnosis_names_the_shaft(
    tmp_path: Path, description: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What finds the error is tested with the pairs; here it is found already."""
    known = effects()["transmission_error"].parameters
    found = Effect("transmission_error", {**{p.name: 0.0 for p in known}, **error(4.0).parameters})
    intervals = {name: (value, value) for name, value in found.parameters.items()}
    named = Named(found, "position", intervals, (), 0.9)
    rigs = Rig(MACHINE), Rig(MACHINE, [found])
    monkeypatch.setattr(
        examining, "diagnose", lambda *_, **__: made(Verdict.EXPLAINED, *rigs, [named])
    )
    write_campaign(tmp_path / "made", MACHINE, mixed_touches(40, seed=5))
    out = tmp_path / "out.json"
    options = ["--train", str(description), "--json", str(out)]

    result = CliRunner().invoke(cli.group, ["diagnose", str(tmp_path / "made"), *options])

    assert result.exit_code == 0, result.output
    document = json.loads(out.read_text())
    assert [effect["id"] for effect in document["effects"]] == ["transmission_error"]
    (source,) = document["transmission"]
    assert source["part"] == "shaft 1 (input)"
    assert source["order"] == pytest.approx(2.5, rel=1e-3)
    assert "order 2.5" in result.output


@pytest.mark.parametrize("name", ["7", "['a']", "''", "' '", '"a\\u0007b"', f'"{"x" * 101}"'])
def test_name_of_a_stage_that_is_none_is_refused(description: Path, name: str) -> None:
    description.write_text(BELT_AND_SCREW.replace('"belt"', name))

    with pytest.raises(InputError, match=r"train.toml: stage 1: expected a name, a text of at "):
        read_axis_train(description)
