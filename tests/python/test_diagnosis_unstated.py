"""What nobody stated of the positions: touches of one surface tell their scatter, and its step."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played_again
from skiplatch.campaign import Campaign, InputPath, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.fit.beliefs import REPEATABILITY, believing
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.fit.unstated import RESOLUTION, with_unstated
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import Effect

SIGMA_UM = 2.0
TIMES = 4
"""That each surface is touched."""


@pytest.fixture(name="silent", scope="module")
def fixture_silent() -> Campaign:
    """A machine whose probe scatters by 2 µm, and rounds, of which nothing is stated."""
    return silent_of()


def silent_of(*effects: Effect) -> Campaign:
    machine = read_campaign(MACHINE)
    skip = np.flatnonzero(machine.touches.path == InputPath.SKIP)[:40]
    touches = machine.touches.select(np.repeat(skip, TIMES))
    count = np.arange(len(touches))
    touches = replace(touches, touch=count, time_s=np.linspace(10.0, 2_000.0, len(touches)))
    chain = believing(machine.nominal, {REPEATABILITY: SIGMA_UM})
    recorded = played_again(replace(machine, nominal=chain, touches=touches), *effects)
    stated = believing(chain, {REPEATABILITY: 0.0, RESOLUTION: 0.001})
    unknown = frozenset({REPEATABILITY, RESOLUTION})
    return replace(recorded, nominal=replace(stated, unknown=unknown))


def test_scatter_and_step_of_positions_are_what_touches_of_one_surface_show(
    silent: Campaign,
) -> None:
    nominal = scene_of(silent).nominal

    assert nominal.axis.resolution_um == pytest.approx(0.5)
    assert nominal.probe.repeatability_um == pytest.approx(SIGMA_UM, rel=0.2)


def test_what_is_stated_stays(silent: Campaign) -> None:
    stated = replace(silent, nominal=replace(silent.nominal, unknown=frozenset()))

    assert with_unstated(stated).nominal == stated.nominal


@pytest.fixture(name="touched_once", scope="module")
def fixture_touched_once(silent: Campaign) -> Campaign:
    """Each surface once, of which one touch in ten is far off."""
    touches = silent.touches
    once = touches.position_mm + 0.1 * np.arange(len(touches))
    off_um = np.where(np.arange(len(touches)) % 10 == 0, 40.0, 0.0)
    moved = replace(touches, position_mm=once, deviation_um=touches.deviation_um + off_um)
    return replace(silent, touches=moved)


def test_surfaces_that_were_touched_once_scatter_as_most_of_them_do(touched_once: Campaign) -> None:
    nominal = with_unstated(touched_once).nominal

    assert nominal.probe.repeatability_um == pytest.approx(SIGMA_UM, rel=0.3)


def test_a_few_touches_tell_no_scatter(touched_once: Campaign) -> None:
    few = replace(touched_once, touches=touched_once.touches.select(np.arange(4)))

    assert with_unstated(few).nominal.probe.repeatability_um == 0.0


def test_a_scatter_that_nobody_stated_is_no_gap(silent: Campaign) -> None:
    found = diagnose(silent, seed=1)

    assert found.verdict is Verdict.NO_GAP
    assert any("probe.repeatability_um is not stated" in note for note in found.notes)


@pytest.mark.long
def test_what_is_no_scatter_is_found_beside_one_that_nobody_stated() -> None:
    found = diagnose(silent_of(Effect("backlash", {"backlash_um": 12.0})), seed=1)

    assert [one.effect.id for one in found.effects] == ["backlash"]
    assert found.effects[0].effect.parameters["backlash_um"] == pytest.approx(12.0, abs=1.5)
