"""Which effects a campaign can show at all."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played_again
from skiplatch.campaign import Campaign, InputPath, read_campaign
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.applicable import shows_lobes
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.diagnosis.search.tasks import fit_in_forms, fit_plainly
from skiplatch.simulator.effects import Effect


def on_four_sides(*elevations_deg: float) -> Campaign:
    """Positions alone, at ±X and ±Y, at these elevations in turn."""
    machine = read_campaign(MACHINE)
    sides, heights = np.divmod(np.arange(len(machine.touches)), len(elevations_deg))
    azimuths_deg = 90.0 * (sides % 4)
    touches = replace(
        machine.touches,
        axis=(sides % 2).astype(machine.touches.axis.dtype),
        sign=np.where(azimuths_deg < 135.0, 1.0, -1.0),
        alpha_deg=azimuths_deg,
        beta_deg=np.array(elevations_deg)[heights],
    )
    return replace(machine, touches=touches)


@pytest.mark.parametrize(("sides", "are_shown"), [(2, False), (3, False), (4, True)])
def test_both_senses_of_two_axes_show_lobes(sides: int, *, are_shown: bool) -> None:
    machine = on_four_sides(0.0)
    few = machine.touches.select(np.arange(len(machine.touches)) % 4 < sides)

    assert shows_lobes(scene_of(replace(machine, touches=few))) is are_shown


@pytest.mark.parametrize("lobe_um", [0.0, 2.0])
def test_directions_that_nobody_recorded_show_no_lobes(lobe_um: float) -> None:
    machine = on_four_sides(0.0)
    probe = replace(machine.nominal.probe, lobe_um=lobe_um)
    unknown = np.full(len(machine.touches), np.nan)
    touches = replace(machine.touches, alpha_deg=unknown, beta_deg=unknown)
    bare = replace(machine, nominal=replace(machine.nominal, probe=probe), touches=touches)

    assert not shows_lobes(scene_of(bare))


def test_lobes_at_four_sides_look_like_backlash() -> None:
    """By three of anything in a turn, or by a length for each axis: the data are free by axis."""
    lobes = Effect("pretravel_lobing", {"amplitude_um": 4.0, "azimuth_deg": 20.0})
    scene = scene_of(played_again(on_four_sides(0.0), lobes))

    def nats(effect_id: str) -> float:
        found = fit_in_forms((scene, fit_plainly((scene, CANDIDATES[effect_id], NOTHING)), NOTHING))
        return likelihood(scene, found.change(scene)).total

    assert nats("pretravel_lobing") == pytest.approx(nats("backlash"), abs=TIED)


@pytest.mark.long
def test_what_four_sides_show_is_a_group() -> None:
    lobes = Effect("pretravel_lobing", {"amplitude_um": 4.0, "azimuth_deg": 20.0})

    machine = on_four_sides(0.0)
    latched = machine.touches.select(machine.touches.path == InputPath.SKIP)
    campaign = played_again(replace(machine, touches=latched), lobes)

    (found,) = diagnose(campaign, seed=1).effects

    assert {found.effect.id, *found.alternatives} == {"backlash", "pretravel_lobing"}


def test_lobes_that_fall_with_the_elevation_are_no_backlash() -> None:
    lobes = Effect("pretravel_lobing", {"amplitude_um": 4.0, "azimuth_deg": 20.0})
    scene = scene_of(played_again(on_four_sides(0.0, 50.0), lobes))

    def nats(effect_id: str) -> float:
        found = fit_plainly((scene, CANDIDATES[effect_id], NOTHING))
        return likelihood(scene, found.change(scene)).total

    assert nats("pretravel_lobing") > nats("backlash") + 100.0


@pytest.mark.parametrize(
    ("directions", "are_told"),
    [(8, set()), (16, {"second_um"}), (24, {"second_um", "third_um"})],
)
def test_further_orders_of_lobes_are_told_by_azimuths_that_take_them_for_no_others(
    directions: int, are_told: set[str]
) -> None:
    """At eight azimuths nine lobes look like one: a backlash makes something like it."""
    machine = read_campaign(MACHINE)
    alpha_deg = 360.0 / directions * (np.arange(len(machine.touches)) % directions)
    flat = np.zeros(len(alpha_deg))
    touches = replace(machine.touches, alpha_deg=np.asarray(alpha_deg), beta_deg=flat)

    lobes = CANDIDATES["pretravel_lobing"]
    taken_up = {lobes.names[i] for i in lobes.taken_up(scene_of(replace(machine, touches=touches)))}

    assert taken_up == {"second_um", "third_um", "elevation_power"} - are_told
