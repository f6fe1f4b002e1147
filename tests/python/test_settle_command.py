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
    Nominal,
    Status,
    Touches,
    read_campaign,
    write_campaign,
)
from skiplatch.campaign.datum import Datum
from skiplatch.diagnosis import Diagnosis
from skiplatch.diagnosis.experiment import outcome, rivals
from skiplatch.diagnosis.reported.diagnosis import Ranked
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.errors import CampaignWarning, InputError
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

DELAY = (Effect("trigger_delay", {"delay_us": 150.0, "jitter_us": 0.0}),)
FILTER = (Effect("input_filter", {"delay_us": 150.0, "jitter_us": 0.0}),)
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
