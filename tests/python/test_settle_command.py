"""``skiplatch settle`` as the user meets it, and the judging behind it."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from click.testing import CliRunner

from effects_rig import MACHINE, mixed_touches
from skiplatch import cli
from skiplatch.campaign import (
    Campaign,
    DatumFreedom,
    InputPath,
    Nominal,
    Status,
    Touches,
    read_campaign,
    write_campaign,
)
from skiplatch.campaign.datum import Datum
from skiplatch.diagnosis import Diagnosis
from skiplatch.diagnosis.experiment import Standing, borne_out_nats, outcome, rivals, words
from skiplatch.diagnosis.experiment.logged import not_told
from skiplatch.diagnosis.reported.diagnosis import Ranked
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

DELAY = (Effect("trigger_delay", {"delay_us": 150.0, "jitter_us": 0.0}),)
FILTER = (Effect("input_filter", {"delay_us": 150.0, "jitter_us": 0.0}),)
BACKLASH = (Effect("backlash", {"backlash_um": 15.0}),)
LAG = (Effect("following_error", {"lag_us": 150.0, "y_excess_ratio": 0.0, "z_excess_ratio": 0.0}),)


def made(model: tuple[Effect, ...], columns: tuple[str, ...], n: int, seed: int) -> Campaign:
    """A machine that has an effect, and some of the columns that it could have recorded."""
    touches = mixed_touches(n, seed=seed)
    controller = Controller.for_campaign(MACHINE, touches)
    outcomes = play(MACHINE, controller, touches, seed=seed, switched_on=model)
    kept = {name: getattr(outcomes, name)[0] for name in columns}
    status = np.where(outcomes.ok[0], Status.OK, Status.MISSED).astype(np.int8)
    return Campaign(MACHINE, replace(touches, status=status, **kept), Path("rig"))


def left(models: list[tuple[Effect, ...]], truth: tuple[Effect, ...]) -> list[str]:
    tied = made(truth, ("deviation_um",), 150, seed=3)
    further = made(truth, ("latch_us", "deviation_um"), 40, seed=4)
    return [s.model[0].id for s in outcome(tied, further, models, seed=1) if s.is_left]


@pytest.mark.parametrize("truth", [DELAY, LAG])
def test_new_touches_rule_out_what_does_not_play_them(truth: tuple[Effect, ...]) -> None:
    assert left([LAG, DELAY], truth) == [truth[0].id]


def test_what_plays_the_same_stays_tied() -> None:
    assert sorted(left([DELAY, LAG, FILTER], DELAY)) == ["input_filter", "trigger_delay"]


def test_parameters_are_fitted_anew_to_both_campaigns() -> None:
    off = (Effect("trigger_delay", {"delay_us": 120.0, "jitter_us": 0.0}),)

    assert left([LAG, off], DELAY) == ["trigger_delay"]


def of_two_faces(truth: tuple[Effect, ...], free: DatumFreedom, *, seed: int) -> Campaign:
    """Touches of a face for each sense, by a rig with an effect."""
    nominal = replace(MACHINE, datum=Datum(free))
    touches = mixed_touches(60, seed=seed, path=InputPath.SKIP)
    is_plus = touches.sign > 0.0
    touches = replace(
        touches,
        position_mm=np.where(is_plus, 10.0, -10.0),
        alpha_deg=np.where(is_plus, 0.0, 180.0),
        beta_deg=np.zeros(60),
    )
    if free is DatumFreedom.SESSION:
        session = is_plus.astype(touches.session.dtype)
        touches = replace(touches, session=session, session_names=("minus", "plus"))
    controller = Controller.for_campaign(nominal, touches)
    outcomes = play(nominal, controller, touches, seed=seed, switched_on=truth)
    status = np.full(60, Status.OK, dtype=np.int8)
    made = replace(touches, deviation_um=outcomes.deviation_um[0], status=status)
    return Campaign(nominal, made, Path("rig"))


@pytest.mark.parametrize(
    ("free", "is_told"), [(DatumFreedom.AXIS, True), (DatumFreedom.SESSION, False)]
)
def test_touches_of_faces_that_lie_anywhere_tell_no_backlash(
    free: DatumFreedom, *, is_told: bool
) -> None:
    campaign = of_two_faces(BACKLASH, DatumFreedom.AXIS, seed=3)
    further = of_two_faces(BACKLASH, free, seed=4)

    nats = borne_out_nats(campaign, further, BACKLASH)

    assert nats > 100.0 if is_told else abs(nats) < 0.1


@pytest.mark.parametrize("free", [DatumFreedom.AXIS, DatumFreedom.SESSION])
@pytest.mark.parametrize("model", [BACKLASH, DELAY])
def test_a_plan_says_what_the_log_of_its_programs_leaves_tied(
    model: tuple[Effect, ...], free: DatumFreedom
) -> None:
    campaign = of_two_faces(model, free, seed=3)

    tied = not_told(campaign, [model], campaign.touches, seed=1)

    assert tied == ([("backlash", "no effect")] if model is BACKLASH else [])
    assert ("A gauge of known width would" in words.not_told(tied)) is (model is BACKLASH)


@pytest.mark.parametrize(
    ("nats", "said"),
    [
        (0.0, "Left: backlash. That is by the campaign alone. These touches told nothing: "),
        (-9.0, "Left: backlash. These touches speak against it: "),
        (9.0, "Left: backlash.\n"),
    ],
)
def test_no_effect_stands_beside_what_is_left(
    nats: float, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    further = of_two_faces(BACKLASH, DatumFreedom.SESSION, seed=4)
    rig, made = written(tmp_path / "tied", further.nominal, mixed_touches(9, seed=1)), "made"
    monkeypatch.setattr("skiplatch.commands.settle.diagnose", lambda *_, **__: None)
    monkeypatch.setattr("skiplatch.commands.settle.rivals", lambda _: [BACKLASH])
    monkeypatch.setattr(
        "skiplatch.commands.settle.outcome",
        lambda *_, **__: [Standing(BACKLASH, 0.0, is_expected=False)],
    )
    monkeypatch.setattr("skiplatch.commands.settle.borne_out_nats", lambda *_: nats)
    document = tmp_path / "left.json"

    folder = written(tmp_path / made, further.nominal, further.touches)
    text = run("settle", rig, folder, "--json", str(document))

    assert text.startswith(said)
    assert text.splitlines()[-1].split()[:2] == ["no", "effect"]
    assert float(text.split()[-1]) == nats
    assert ("Each surface is met in one sense and may lie anywhere" in text) is (nats < 6.0)
    assert json.loads(document.read_text())["no_effect_behind_nats"] == nats


def test_the_rivals_are_all_that_the_groups_name() -> None:
    ranking = [Ranked(model, nats) for model, nats in ((DELAY, 90.0), (LAG, 84.0))]
    named = [SimpleNamespace(effect=DELAY[0], alternatives=("following_error",))]
    diagnosis = SimpleNamespace(effects=named, rivals=ranking[:1], ranking=ranking)

    assert rivals(cast(Diagnosis, diagnosis)) == [DELAY, LAG]


def run(*arguments: str) -> str:
    result = CliRunner().invoke(cli.group, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def written(folder: Path, nominal: Nominal, touches: Touches) -> str:
    write_campaign(folder, nominal, touches)
    return str(folder)


@pytest.mark.long
def test_the_command_says_what_is_left(tmp_path: Path) -> None:
    tied = made(LAG, ("deviation_um",), 150, seed=3)
    further = made(LAG, ("latch_us", "deviation_um"), 40, seed=4)
    folders = [
        written(tmp_path / "tied", MACHINE, tied.touches),
        written(tmp_path / "made", MACHINE, further.touches),
    ]

    text = run("settle", *folders, "--jobs", "1", "--json", str(tmp_path / "left.json"))

    found = json.loads((tmp_path / "left.json").read_text())
    assert "Left: following_error." in text
    assert found["left"] == [["following_error"]]
    assert len(found["models"]) > 1


def test_touches_of_another_rig_are_refused(tmp_path: Path) -> None:
    tied = made(LAG, ("deviation_um",), 40, seed=3)
    other = replace(MACHINE, plc=replace(MACHINE.plc, scan_us=MACHINE.plc.scan_us + 1.0))

    with pytest.raises(InputError, match=r"another rig; .* with --nominal .*tied/nominal\.toml"):
        run(
            "settle",
            written(tmp_path / "tied", MACHINE, tied.touches),
            written(tmp_path / "made", other, tied.touches),
        )


def test_the_same_touches_twice_are_refused(tmp_path: Path) -> None:
    tied = made(LAG, ("deviation_um",), 40, seed=3)
    folder = written(tmp_path / "tied", MACHINE, tied.touches)

    with pytest.raises(InputError, match="the touches are those of"):
        run("settle", folder, folder)


def test_a_log_imported_with_the_nominal_of_the_rig_is_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its datum goes with its own surfaces."""
    tied = made(LAG, ("deviation_um",), 40, seed=3)
    rig = written(tmp_path / "tied", replace(MACHINE, datum=Datum(DatumFreedom.NONE)), tied.touches)
    nominal_toml = Path(rig, "nominal.toml")
    nominal_toml.write_text(
        nominal_toml.read_text().replace("[probe]", "[probe]\ncalibrated_at_c = 20.0")
    )
    (tmp_path / "p.ngc").write_text("G0 Z1\nG38.2 Z-5 F100\nG0 Z1\nG38.2 Z-5 F200\n")
    (tmp_path / "p.txt").write_text("0 0 -3 0 0 0 0 0 0\n0 0 -3.01 0 0 0 0 0 0\n")
    log = ("linuxcnc", str(tmp_path / "p.txt"), "--program", str(tmp_path / "p.ngc"))
    nominal, out = ("--nominal", f"{rig}/nominal.toml"), str(tmp_path / "made")

    said = run("import", *log, *nominal, "--path", "skip", "-o", out)

    assert "what is believed of the rig is that of" in said
    assert read_campaign(out).touches.on_skip.all()
    assert read_campaign(out).nominal.datum.free is DatumFreedom.AXIS
    monkeypatch.setattr("skiplatch.commands.settle.diagnose", lambda *_, **__: None)
    monkeypatch.setattr("skiplatch.commands.settle.rivals", lambda _: [])
    with pytest.warns(CampaignWarning, match="time_s: not recorded"):
        assert "nothing to settle" in run("settle", rig, out)


def test_the_documents_say_how_much_a_tie_is() -> None:
    text = (Path(__file__).parents[2] / "docs" / "DIAGNOSIS.md").read_text()

    assert f"ruled out if it falls behind the best one by {TIED:g} nats" in " ".join(text.split())
    assert "nats" not in run("settle", "--help")
