"""Effects that only the simulator knows are considered by the diagnosis."""

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played
from skiplatch.campaign import Datum, DatumFreedom, InputPath
from skiplatch.diagnosis.candidates.played_changes import _shift
from skiplatch.diagnosis.candidates.simulated import admitted_values, catalogue, simulated
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.fit.fit import fit
from skiplatch.diagnosis.fit.forms import polish
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect, effects

CASES = {
    "feed_error": [3.0, 0.0, 0.0],
    "unfinished_acceleration": [0.3, 0.5],
    "pretravel_lobing": [3.0, 30.0, 1.0, -0.5, 1.0],
    "trigger_delay": [300.0, 0.0, 0.0],
    "input_filter": [100.0, 20.0, 0.0],
    "contact_bounce": [0.2, 300.0, 0.0, 0.0],
    "lost_trigger": [0.05],
    "isr_latency": [20.0, 5.0, 0.0],
    "isr_blocking": [0.2, 200.0, 0.0, 50.0],
    "input_image_delay": [1.0],
    "scan_jitter": [100.0, 50.0, 0.0],
    "following_error": [200.0, 0.0, 0.0, 20.0],
    "backlash": [3.0, 0.0, 0.0, 0.0, 0.0],
    "scale_error": [50.0, 0.0, 0.0, 0.0],
    "thermal_drift": [2.0, 0.0, 500.0, *[0.0] * 6],
    "report_delay": [50.0, 20.0, 0.0, 10.0],
}
MACHINE_ONLY = {"pretravel_lobing", "trigger_delay"}
LONG = pytest.mark.long


def half_of(folder: Path, *switched_on: Effect) -> Scene:
    scene = Scene.of(played(folder, *switched_on))
    return scene.select(np.arange(len(scene)) % 2 == 0)


def gain(scene: Scene, change: Change) -> float:
    return likelihood(scene, change).total - likelihood(scene, Change()).total


@pytest.mark.parametrize(
    ("effect_id", "folder"),
    [(name, MACHINE) for name in CASES]
    + [(name, BENCH) for name in sorted(CASES.keys() - MACHINE_ONLY)],
)
def test_a_play_says_of_an_effect_what_its_surrogate_says(effect_id: str, folder: Path) -> None:
    surrogate, values = CANDIDATES[effect_id], np.array(CASES[effect_id])
    effect = Effect(effect_id, dict(zip(surrogate.names, CASES[effect_id], strict=True)))
    scene = half_of(folder, effect)

    found = gain(scene, simulated(effect_id).change(scene, values))

    assert found == pytest.approx(gain(scene, surrogate.change(scene, values)), rel=0.05, abs=2.0)


@pytest.mark.parametrize(
    ("effect_id", "values", "tolerance"),
    [
        pytest.param("trigger_delay", [300.0, 0.0, 0.0], 0.03, marks=LONG),  # a shift
        ("backlash", [3.0, 0.0, 0.0, 0.0, 0.0], 0.1),  # that depends on the sense
        pytest.param("contact_bounce", [0.2, 300.0, 0.0, 0.0], 0.5, marks=LONG),  # now and then
        pytest.param("link_slotting", [300.0, 0.0], 0.15, marks=LONG),  # scatter alone
        ("lost_trigger", [0.05], 0.3),
    ],
)
def test_the_search_finds_parameters_from_the_table_alone(
    effect_id: str, values: list[float], tolerance: float
) -> None:
    candidate = simulated(effect_id)
    effect = Effect(effect_id, dict(zip(candidate.names, values, strict=True)))
    scene = half_of(MACHINE, effect)
    # Beside a datum that may be anywhere, other numbers of these effects do the same.
    scene = scene.with_nominal(replace(scene.nominal, datum=Datum(DatumFreedom.NONE)))

    found = fit(scene, [candidate], candidate.starts(scene, Change()))

    named = admitted_values(effects()[effect_id], found.parameters[0])
    assert next(iter(named.values())) == pytest.approx(values[0], rel=tolerance)


def test_scatter_without_a_shift_is_scatter() -> None:
    """Slots of 300 µs: a wait of U(0, 300 µs), which has a standard deviation of 87 µs."""
    scene = Scene.of(played(MACHINE))

    change = simulated("link_slotting").change(scene, np.array([300.0, 0.0]))

    (extra,) = change.pin_extra
    assert np.mean(change.pin_us) == pytest.approx(150.0, rel=0.05)
    assert np.mean(extra.sigma) == pytest.approx(300.0 / np.sqrt(12.0), rel=0.1)


def test_what_is_as_fine_as_can_be_played_is_played_no_finer() -> None:
    scene = Scene.of(played(BENCH))
    nominal = scene.nominal
    finest = replace(
        nominal,
        axis=replace(nominal.axis, resolution_um=1e-4),
        skip=replace(nominal.skip, tick_us=1e-3),
    )

    values = np.array([3.0, 0.0, 0.0, 0.0, 0.0])
    change = simulated("backlash").change(scene.with_nominal(finest), values)

    expected = CANDIDATES["backlash"].change(scene, values)
    np.testing.assert_allclose(change.position_um, expected.position_um, atol=0.01)


def test_plays_that_hardly_differ_are_a_small_shift_without_a_warning() -> None:
    differences_um = np.array([[0.009, 0.001], [-0.009, 0.006]])

    shift_um, _ = _shift(differences_um)

    assert np.all(np.abs(shift_um) < 0.01)


def test_what_came_before_is_played_though_only_some_touches_are_looked_at() -> None:
    scene = Scene.of(played(BENCH))
    values = np.array([2.0, 0.0, 500.0, *[0.0] * 6])  # a drift with a lag
    whole = simulated("thermal_drift").change(scene, values)

    late = scene.select(np.arange(len(scene)) >= 300).select(np.arange(100) % 2 == 0)
    part = simulated("thermal_drift").change(late, values)

    np.testing.assert_array_equal(part.position_um, np.asarray(whole.position_um)[300::2])


def test_the_catalogue_holds_every_effect_of_the_table() -> None:
    assert catalogue().keys() == effects().keys()


def test_a_candidate_travels_to_another_process() -> None:
    candidate = simulated("backlash")

    assert pickle.loads(pickle.dumps(candidate)) is candidate  # noqa: S301


@pytest.mark.parametrize("effect_id", CANDIDATES)
def test_starts_are_admitted_and_nowhere_0(effect_id: str) -> None:
    row = effects()[effect_id]
    starts = simulated(effect_id).starts(Scene.of(played(MACHINE)), Change())

    for start in starts:
        assert list(admitted_values(row, start).values()) == pytest.approx(start, rel=1e-4)
        assert all(start)
    for i, parameter in enumerate(row.parameters):
        signs = {np.sign(start[i]) for start in starts}
        assert signs == ({-1.0, 1.0} if parameter.low < 0.0 else {1.0})


def test_parameters_out_of_range_are_brought_into_it() -> None:
    row = effects()["pretravel_lobing"]  # 0 … 50 µm, 0 … 120°, -50 … 50 µm, and more

    low = admitted_values(row, [-3.0, 130.0, -60.0, 0.0, 0.0])
    high = admitted_values(row, [70.0, -10.0, 0.0, 0.0, 5.0])

    assert (low["amplitude_um"], low["azimuth_deg"], low["second_um"]) == (3.0, 10.0, -50.0)
    assert (high["amplitude_um"], high["azimuth_deg"]) == (50.0, 110.0)
    assert high["elevation_power"] == 4.0


def test_a_stretch_that_each_edge_starts_is_told_from_no_bounce() -> None:
    """On the skip path alone both come late now and then, by the same law."""
    campaign = played(BENCH, Effect("isr_blocking", {"probability": 0.25, "least_us": 150.0}))
    on_skip = campaign.touches.select(campaign.touches.path == InputPath.SKIP)
    scene = Scene.of(replace(campaign, touches=on_skip))

    gains = {}
    for name in ("isr_blocking", "contact_bounce"):
        found = fit(scene, [CANDIDATES[name]], CANDIDATES[name].starts(scene, Change()))
        gains[name] = gain(scene, polish(scene, found).change(scene))

    assert gains["isr_blocking"] > 100.0
    assert gains["isr_blocking"] == pytest.approx(gains["contact_bounce"], abs=3.0)
