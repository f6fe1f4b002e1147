"""``skiplatch adopt``: a finding becomes a belief, and the next diagnosis starts from there."""

import json
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch import cli
from skiplatch.campaign import BelievedEffect, fingerprint, read_campaign, read_nominal
from skiplatch.diagnosis import Diagnosis, diagnose
from skiplatch.diagnosis.candidates.table import candidate
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.beliefs import believing, uncertain, value_of
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.reported.adoption import adopted
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.errors import InputError

BENCH = Path(__file__).parents[2] / "scripts" / "samples" / "bench_isr_latency"
LATENCY = {
    "id": "isr_latency",
    "params": {"latency_us": 41.7, "jitter_us": 0.0, "tail_us": 0.0},
    "intervals": {"latency_us": [41.6, 41.8], "jitter_us": [0.0, 0.0]},
    "since": None,
    "until": None,
}


def diagnosis(folder: Path, effects: Sequence[object]) -> Path:
    document = {"format": "skiplatch-diagnosis/2", "effects": effects}
    path = folder / "diagnosis.json"
    path.write_text(json.dumps(document))
    return path


def adopt(campaign: Path, found: Path, out: Path, *options: str) -> tuple[int, str]:
    arguments = ["adopt", str(campaign), "--diagnosis", str(found), "--out", str(out), *options]
    result = CliRunner().invoke(cli.group, arguments)
    if isinstance(result.exception, InputError):
        return 2, str(result.exception)
    return result.exit_code, result.output


def test_help_has_an_example() -> None:
    shown = CliRunner().invoke(cli.group, ["adopt", "--help"]).output

    assert "Example:\n    skiplatch diagnose " in shown
    assert "    skiplatch adopt " in shown


def test_effect_is_believed_and_all_else_stays(tmp_path: Path) -> None:
    campaign = tmp_path / "campaign"
    shutil.copytree(BENCH, campaign)
    path = campaign / "nominal.toml"
    path.write_text("# as bought\n" + path.read_text() + '\n[notes]\nwho = "me"\n')
    out = tmp_path / "adopted.toml"

    assert adopt(campaign, diagnosis(tmp_path, [LATENCY]), out) == (0, f"{out}: isr_latency\n")

    (effect,) = read_nominal(out).believed_effects
    assert (effect.id, effect.values) == ("isr_latency", LATENCY["params"])
    assert effect.uncertainty == {"latency_us": pytest.approx(0.1 / 1.645, rel=1e-2)}
    kept = out.read_text().splitlines()
    assert [line for line in path.read_text().splitlines() if line not in kept] == [
        line for line in path.read_text().splitlines() if line.startswith("format = ")
    ]


def test_adopting_twice_changes_nothing(tmp_path: Path) -> None:
    campaign = tmp_path / "campaign"
    shutil.copytree(BENCH, campaign)
    found, once, twice = diagnosis(tmp_path, [LATENCY]), tmp_path / "1.toml", tmp_path / "2.toml"
    adopt(campaign, found, once)
    shutil.copy(once, campaign / "nominal.toml")

    adopt(campaign, found, twice)

    assert twice.read_bytes() == once.read_bytes()


def test_what_ended_is_left_out_and_what_began_is_there_now(tmp_path: Path) -> None:
    ended, begun = {**LATENCY, "until": 20}, {**LATENCY, "since": 21}
    out = tmp_path / "adopted.toml"

    assert adopt(BENCH, diagnosis(tmp_path, [ended]), out) == (0, f"{out}: nothing to adopt\n")
    assert adopt(BENCH, diagnosis(tmp_path, [begun]), out) == (0, f"{out}: isr_latency\n")


@pytest.mark.parametrize(
    ("effect", "complaint"),
    [
        ({**LATENCY, "id": "gremlins"}, 'no effect is called "gremlins"'),
        ({**LATENCY, "params": {"latency": 1.0}}, "no such parameter; there are latency_us"),
        ({**LATENCY, "params": {"latency_us": -1e9}}, "expected"),
        ({**LATENCY, "intervals": {"latency_us": [1.0]}}, "latency_us: expected two numbers"),
        ({**LATENCY, "intervals": 3}, "effects[0].intervals: expected an object, got 3"),
        ({"params": {}}, "effects[0].id: missing from the diagnosis"),
    ],
)
def test_what_is_no_finding_is_refused(tmp_path: Path, effect: object, complaint: str) -> None:
    out = tmp_path / "adopted.toml"
    status, said = adopt(BENCH, diagnosis(tmp_path, [effect]), out)

    assert status == 2
    assert complaint in said
    assert str(tmp_path / "diagnosis.json") in said
    assert not out.exists()


def test_likelihood_starts_from_what_is_believed() -> None:
    campaign = read_campaign(BENCH)
    believed = BelievedEffect("isr_latency", {"latency_us": 41.7})
    nominal = replace(campaign.nominal, believed_effects=(believed,))
    plain = Scene.of(replace(campaign, nominal=replace(campaign.nominal, version=2)))
    change = candidate("isr_latency").change(plain, np.array([41.7, 0.0, 0.0]))
    starting, nothing = scene_of(replace(campaign, nominal=nominal)), Change()

    assert likelihood(starting, nothing).total == pytest.approx(likelihood(plain, change).total)
    assert likelihood(starting, nothing).total > likelihood(plain, nothing).total + 100.0
    for some in (starting.select(starting.plc), starting.with_nominal(starting.nominal)):
        assert some.believed.skip_us == pytest.approx(change.skip_us)


def test_parameter_known_to_an_uncertainty_is_a_belief() -> None:
    effect = BelievedEffect("isr_latency", {"latency_us": 41.7, "tail_us": 0.1}, {"tail_us": 0.2})
    nominal = replace(read_campaign(BENCH).nominal, believed_effects=(effect,))

    (belief,) = [belief for belief in uncertain(nominal) if belief.key[0] == "isr_latency"]

    assert (belief.name, belief.value, belief.u) == ("isr_latency.tail_us", 0.1, 0.2)
    assert value_of(belief.applied(nominal, 1.0), belief.key) == pytest.approx(0.3)
    assert value_of(belief.applied(nominal, -2.0), belief.key) == 0.0  # the end of its range
    assert value_of(believing(nominal, {("skip", "tick_us"): 9.0}), ("skip", "tick_us")) == 9.0


def believing_in(latency_us: float) -> Diagnosis:
    campaign = read_campaign(BENCH)
    believed = BelievedEffect("isr_latency", {"latency_us": latency_us}, {"latency_us": 0.1})
    nominal = replace(campaign.nominal, believed_effects=(believed,))
    return diagnose(replace(campaign, nominal=nominal), seed=1)


@pytest.mark.long
def test_next_diagnosis_of_what_is_believed_finds_no_gap() -> None:
    found = believing_in(41.7)

    assert found.verdict == "no_gap"
    (fitted_us,) = [us for belief, us in found.beliefs if belief.name == "isr_latency.latency_us"]
    assert fitted_us == pytest.approx(41.7, abs=0.25)


@pytest.mark.long
def test_next_diagnosis_finds_what_is_left() -> None:
    found = believing_in(30.0)

    (named,) = found.effects
    assert found.verdict == "explained"
    # A delay this much shorter than a scan is as good as any behind the pin.
    assert "isr_latency" in {named.effect.id, *named.alternatives}
    assert next(iter(named.effect.parameters.values())) == pytest.approx(11.7, abs=0.5)


def campaign_of(folder: Path, text: str) -> Path:
    campaign = folder / "campaign"
    campaign.mkdir()
    (campaign / "nominal.toml").write_text(text)
    return campaign


@pytest.mark.parametrize("key", ["format", '"format"', "'format'"])
def test_the_format_is_raised_where_it_stands_and_nowhere_else(tmp_path: Path, key: str) -> None:
    line = 'format = "skiplatch-campaign/1"'
    sample = (BENCH / "nominal.toml").read_text().replace("format", key, 1)
    text = f"{sample}\n[notes]\n{line}\nwas = '''\n{line}\n'''\n# as bought\n"
    out = tmp_path / "adopted.toml"

    status, said = adopt(campaign_of(tmp_path, text), diagnosis(tmp_path, [LATENCY]), out)

    assert status == 0, said
    assert [effect.id for effect in read_nominal(out).believed_effects] == ["isr_latency"]
    assert out.read_text().startswith(text.replace("campaign/1", "campaign/2", 1))


@pytest.mark.parametrize("effects", ["[]", '[{id = "backlash", backlash_um = 2.0}]'])
def test_a_list_that_no_table_can_be_added_to_is_refused(tmp_path: Path, effects: str) -> None:
    campaign = campaign_of(tmp_path, f'format = "skiplatch-campaign/2"\neffect = {effects}\n')
    out = tmp_path / "adopted.toml"

    status, said = adopt(campaign, diagnosis(tmp_path, [LATENCY]), out)

    told = "expected plain keys, and tables [[effect]], so that one can be added"
    assert (status, said) == (2, f"{campaign / 'nominal.toml'}:2: {told}")
    assert not out.exists()


@pytest.mark.parametrize(
    ("is_of_others", "options", "status"),
    [(False, [], 0), (True, [], 2), (True, ["--other-touches"], 0)],
)
def test_a_diagnosis_of_other_touches_is_taken_only_when_asked_to(
    tmp_path: Path, *, is_of_others: bool, options: Sequence[str], status: int
) -> None:
    campaign, out = tmp_path / "campaign", tmp_path / "out.toml"
    shutil.copytree(BENCH, campaign)
    path = diagnosis(tmp_path, [LATENCY])
    known_as = fingerprint(read_campaign(BENCH).touches)
    path.write_text(json.dumps({**json.loads(path.read_text()), "fingerprint": known_as}))
    if is_of_others:
        rows = (campaign / "touches.csv").read_text().splitlines(keepends=True)
        (campaign / "touches.csv").write_text("".join(rows[:-1]))

    ended, said = adopt(campaign, path, out, *options)

    assert (ended, out.exists()) == (status, status == 0)
    assert ("a diagnosis of other touches than those of" in said) is (status == 2)
    assert ("same rig it is taken with --other-touches" in said) is (status == 2)


def test_parameter_of_which_nothing_is_known_stays_as_it_is(tmp_path: Path) -> None:
    intervals = {"backlash_um": [2.9, 3.1], "z_excess_ratio": [-1000.0, 1000.0]}
    found = {"id": "backlash", "params": dict.fromkeys(intervals, 0.0), "intervals": intervals}

    (believed,) = adopted({"format": "skiplatch-diagnosis/2", "effects": [found]})

    assert believed.uncertainty.keys() == {"backlash_um"}
