"""Which effects a campaign can show at all."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played_again
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis.candidates.applicable import shows_lobes
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import NOTHING
from skiplatch.diagnosis.fit.believed import scene_of
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.search.tasks import fit_plainly
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


@pytest.mark.parametrize(
    ("elevations_deg", "are_shown"),
    [((0.0,), False), ((30.0,), False), ((0.0, 90.0), False), ((0.0, 45.0), True)],
)
def test_four_sides_show_lobes_by_how_they_fall_with_the_elevation(
    elevations_deg: tuple[float, ...], *, are_shown: bool
) -> None:
    assert shows_lobes(scene_of(on_four_sides(*elevations_deg))) is are_shown


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
