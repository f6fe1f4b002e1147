"""Walls that each lie anywhere: what goes with the feed there is no scale of the axis."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import MACHINE, played
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Campaign, Touches
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split
from skiplatch.stand_ins import playable

WALL_MM = 9.517
DELAY_US = 4000.0
COUNT = 120


def of_two_walls(off_um: FloatArray) -> Campaign:
    """Give touches of a bore along X, slow and fast, either wall a session of its own."""
    campaign = played(MACHINE)
    walls = np.tile([1.0, -1.0], COUNT // 2)
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom.SESSION))
    touches = Touches.from_columns(
        touch=np.arange(COUNT),
        axis=np.full(COUNT, Axis.X),
        sign=walls,
        feed_mm_min=np.tile([100.0, 100.0, 300.0, 300.0], COUNT // 4),
        position_mm=WALL_MM * walls,
        deviation_um=off_um,
        session=np.where(walls > 0.0, "right", "left"),
    )
    return replace(campaign, nominal=nominal, touches=touches)


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
def test_a_delay_between_two_walls_is_no_scale_error() -> None:
    """The place where it was latched has the delay in it, and would explain it by 100 %."""
    rng = np.random.default_rng(3)
    feed = np.tile([100.0, 100.0, 300.0, 300.0], COUNT // 4)
    late_um = DELAY_US * feed / 60.0 * 1e-3
    campaign = playable(of_two_walls(late_um - late_um.mean() + rng.normal(0.0, 1.0, COUNT)))
    scene = Scene.of(campaign)

    ranked = Judge(scene, split(COUNT, seed=1)).singles(["scale_error", "trigger_delay"])

    gains = {scored.ids[0]: scored.score for scored in ranked}
    assert gains["trigger_delay"] > 50.0
    assert gains["scale_error"] < 0.2 * gains["trigger_delay"]


@pytest.mark.parametrize(
    "parameters", [(1e6, 0.0, 0.0, 0.0), (-1e6, 0.0, 0.0, 0.0), (1.0, 1e6, 1e6, 0.0)]
)
def test_no_scale_moves_a_place_by_more_than_the_largest(parameters: tuple[float, ...]) -> None:
    campaign = played(MACHINE)
    scene = Scene.of(campaign)

    change = CANDIDATES["scale_error"].change(scene, np.array(parameters))

    most_um = 5e-3 * np.abs(np.nan_to_num(scene.latched_mm)) * 1e3
    assert np.all(np.abs(change.position_um) <= most_um + 1e-9)
