"""Where the surface is that a datum tells: fitted along with every hypothesis, and no effect."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import optimize

from law_densities import laid_out, law_log_density
from played_campaigns import BENCH, MACHINE, played, played_again, stamped_machine
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Campaign, InputPath, Kind, Touches, read_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.candidates.applicable import acts
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density.change import Change
from skiplatch.diagnosis.density.datum import BY_COORDINATES, BY_STAMPS, WITHOUT_STAMPS
from skiplatch.diagnosis.density.law import Extra, Law
from skiplatch.diagnosis.fit.fit import fit
from skiplatch.diagnosis.likelihood.likelihood import fitted_datum_um, likelihood
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum, met_at
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.verdict.named import named
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.simulator.effects import effects
from skiplatch.simulator.library import connection
from skiplatch.stand_ins import playable

OFF_UM = 12.0
NOISE_UM = 0.3
REACH = 1e3


def moved(campaign: Campaign, off_um: FloatArray | float) -> Campaign:
    """Add something to all deviations."""
    touches = campaign.touches
    return replace(campaign, touches=replace(touches, deviation_um=touches.deviation_um + off_um))


def nats(campaign: Campaign) -> float:
    return likelihood(Scene.of(campaign), Change()).total


def free(campaign: Campaign, freedom: DatumFreedom, u_um: float | None = None) -> Campaign:
    nominal = replace(campaign.nominal, datum=Datum(freedom, u_um))
    return replace(campaign, nominal=nominal)


@cache
def quiet() -> Campaign:
    """Skip touches of three axes in two sessions, of noise of 0.3 µm; 200 an axis."""
    machine = read_campaign(MACHINE)
    nominal = machine.nominal
    probe = replace(nominal.probe, repeatability_um=NOISE_UM)
    axis = replace(nominal.axis, resolution_um=0.01)
    rng, n = np.random.default_rng(4), 600
    skip = replace(nominal.skip, jitter_us=0.0)
    axes = np.resize([Axis.X, Axis.Y, Axis.Z], n)
    touches = Touches.from_columns(
        touch=np.arange(n),
        time_s=10.0 * np.arange(n),
        path=np.full(n, InputPath.SKIP),
        axis=axes,
        sign=rng.choice([-1.0, 1.0], n),
        alpha_deg=np.zeros(n),
        beta_deg=np.zeros(n),
        feed_mm_min=np.full(n, 300.0),
        approach_mm=np.full(n, 3.0),
        position_mm=rng.uniform(-100.0, 100.0, n),
        deviation_um=np.zeros(n),
    )
    campaign = replace(
        machine, nominal=replace(nominal, probe=probe, axis=axis, skip=skip), touches=touches
    )
    return played_again(campaign)


def in_sessions(campaign: Campaign) -> Campaign:
    """The same touches, homed anew after half of them."""
    later = (np.arange(len(campaign.touches)) >= len(campaign.touches) // 2).astype(int)
    touches = replace(campaign.touches, session=later, session_names=("before", "after"))
    return replace(campaign, touches=touches)


def fitted(campaign: Campaign) -> Mapping[str, float]:
    """Data of a campaign that records positions alone, by name."""
    return FittedDatum.of(Scene.of(campaign), Change()).coordinate_um


def test_a_constant_length_is_no_news_of_a_machine_and_much_of_a_bench() -> None:
    machine, bench = played(MACHINE), played(BENCH)

    assert abs(nats(moved(machine, OFF_UM)) - nats(machine)) < 1.0
    assert nats(moved(bench, OFF_UM)) < nats(bench) - 500.0


def test_a_machine_whose_surface_is_said_to_be_known_shows_it() -> None:
    machine = free(played(MACHINE), DatumFreedom.NONE)

    assert nats(moved(machine, OFF_UM)) < nats(machine) - 100.0


def test_the_datum_is_found_to_a_tenth_of_a_micrometre() -> None:
    plain, off = fitted(quiet()), fitted(moved(quiet(), OFF_UM))

    assert plain.keys() == off.keys() == {"X", "Y", "Z"}
    for name, value in off.items():
        assert plain[name] == pytest.approx(0.0, abs=0.1)
        assert value == pytest.approx(OFF_UM, abs=0.1)


def test_every_axis_has_a_datum_of_its_own() -> None:
    by_axis = np.array([5.0, -3.0, 80.0])

    found = fitted(moved(quiet(), by_axis[quiet().touches.axis]))

    assert [found[name] for name in "XYZ"] == pytest.approx(by_axis, abs=0.1)


def test_one_datum_of_the_campaign_takes_up_no_difference_of_its_axes() -> None:
    one = free(quiet(), DatumFreedom.CAMPAIGN)
    by_axis = np.array([1.0, -1.0, 0.0])[one.touches.axis]

    assert fitted(moved(one, OFF_UM)) == {"campaign": pytest.approx(OFF_UM, abs=0.1)}
    assert nats(moved(one, by_axis)) < nats(one) - 100.0
    assert nats(moved(quiet(), by_axis)) == pytest.approx(nats(quiet()), abs=1.0)


def test_an_angle_shares_no_datum_with_a_length() -> None:
    one = free(quiet(), DatumFreedom.CAMPAIGN)
    axis = np.where(one.touches.axis == Axis.Z, np.int8(Axis.C), one.touches.axis)
    mixed = replace(one, touches=replace(one.touches, axis=axis))

    found = fitted(moved(mixed, np.where(axis == Axis.C, 4.0, -7.0)))

    assert found == {
        "campaign": pytest.approx(-7.0, abs=0.15),
        "campaign rotary": pytest.approx(4.0, abs=0.15),
    }


def test_a_datum_of_each_sense_takes_up_backlash_and_one_of_each_axis_does_not() -> None:
    by_sense = free(quiet(), DatumFreedom.AXIS_SENSE)
    backlash_um = 1.0 * quiet().touches.sign

    found = fitted(moved(by_sense, backlash_um))

    assert found.keys() == {f"{axis}{sense}" for axis in "XYZ" for sense in "+-"}
    for name, value in found.items():
        assert value == pytest.approx(1.0 if name.endswith("+") else -1.0, abs=0.15)
    assert nats(moved(quiet(), backlash_um)) < nats(quiet()) - 100.0


def with_senses(campaign: Campaign, axis: Axis, sense: float) -> Campaign:
    """The same touches, those of an axis all made in one sense."""
    touches = campaign.touches
    sign = np.where(touches.axis == axis, sense, touches.sign)
    return replace(campaign, touches=replace(touches, sign=sign))


@pytest.mark.parametrize(
    ("freedom", "like_datum"),
    [
        (DatumFreedom.NONE, {"moves_surface"}),
        (DatumFreedom.CAMPAIGN, {"positive_um", "moves_surface"}),
        (DatumFreedom.AXIS, {"positive_um", "z_excess_ratio", "moves_surface"}),
        (
            DatumFreedom.AXIS_SENSE,
            {"positive_um", "y_excess_ratio", "z_excess_ratio", "moves_surface"},
        ),
    ],
)
def test_play_of_an_axis_that_is_met_in_one_sense_is_like_where_its_surface_lies(
    freedom: DatumFreedom, like_datum: set[str]
) -> None:
    scene = Scene.of(free(with_senses(quiet(), Axis.Z, -1.0), freedom))
    play = CANDIDATES["backlash"]
    found = fit(scene, [play], [[2.0, 0.0, 0.0, 0.0, 0.0]])

    assert {play.names[number] for number in play.taken_up(scene)} == like_datum
    (told,) = named(scene, Finding(Scored(found, 50.0, 50.0), ((),), (0.9,)), ())
    ranges = {p.name: (p.low, p.high) for p in effects()["backlash"].parameters}
    open_to_all = {name for name, ends in told.intervals.items() if ends == ranges[name]}
    assert open_to_all == told.idle == like_datum


def test_a_datum_of_each_session_takes_up_what_changes_between_them() -> None:
    by_session = free(in_sessions(quiet()), DatumFreedom.SESSION)
    later_um = np.where(by_session.touches.session == 1, 7.0, 2.0)

    assert fitted(moved(by_session, later_um)) == {
        f"{axis} session {when}": pytest.approx(um, abs=0.1)
        for axis in "XYZ"
        for when, um in (("before", 2.0), ("after", 7.0))
    }


def test_a_session_moves_the_datum_of_each_axis() -> None:
    campaign = in_sessions(quiet())
    by_axis = np.array([5.0, -3.0, 80.0])[campaign.touches.axis]
    moved_um = np.where(campaign.touches.session == 1, by_axis, 0.0)

    found = fitted(moved(campaign, moved_um))

    assert [found[f"{axis} session before"] for axis in "XYZ"] == pytest.approx([0.0] * 3, abs=0.15)
    assert [found[f"{axis} session after"] for axis in "XYZ"] == pytest.approx(
        [5.0, -3.0, 80.0], abs=0.15
    )


def test_the_zero_of_an_instrument_moves_the_senses_apart_and_is_no_backlash() -> None:
    table = free(quiet(), DatumFreedom.ZERO)
    sign = table.touches.sign
    off = moved(table, OFF_UM * sign)

    assert fitted(off) == {name: pytest.approx(OFF_UM, abs=0.1) for name in "XYZ"}
    assert nats(off) == pytest.approx(nats(table), abs=1.0)
    assert nats(moved(table, np.where(sign < 0.0, 1.0, 0.0))) < nats(table) - 100.0
    assert nats(moved(table, OFF_UM)) < nats(table) - 100.0


def test_plays_have_the_zero_of_an_instrument_where_it_was_fitted() -> None:
    off = moved(free(quiet(), DatumFreedom.ZERO), OFF_UM * quiet().touches.sign)
    believed, fitted_to = Rig(off.nominal), FittedDatum.of(Scene.of(off), Change())

    before, after = (
        rig.play(off.touches, seed=1, replicates=20).deviation_um.mean(axis=0)
        for rig in (believed, replace(believed, datum=fitted_to))
    )

    assert after - before == pytest.approx(OFF_UM * off.touches.sign, abs=0.1)


def test_where_an_axis_rests_only_effects_on_positions_can_act() -> None:
    at_rest, touched = Scene.of(free(quiet(), DatumFreedom.ZERO)), Scene.of(quiet())

    acting = {effect_id for effect_id in effects() if acts(effect_id, at_rest)}

    assert {"backlash", "scale_error", "transmission_error", "thermal_drift"} <= acting
    assert not acting & {"trigger_delay", "following_error", "servo_hold", "pretravel_lobing"}
    assert all(acts(effect_id, touched) for effect_id in effects())


@pytest.mark.parametrize("mean_um", [0.0, pytest.param(3.0, marks=pytest.mark.long)])
def test_backlash_of_a_table_is_its_own_reversal_whatever_the_wave(mean_um: float) -> None:
    """A zero that a straight line misses by half a wave was told as a backlash."""
    rng, place = np.random.default_rng(7), np.tile(np.linspace(5.0, 440.0, 40), 10)
    sign = np.repeat([1.0, -1.0] * 5, 40)
    error = 5.0 * np.sin(2.0 * np.pi * place / 160.0 + 2.0) + rng.normal(0.0, 0.5, 400)
    error -= np.where(sign < 0.0, mean_um, 0.0)
    table = free(quiet(), DatumFreedom.ZERO)
    axis = replace(table.nominal.axis, resolution_um=0.1)
    probe = replace(table.nominal.probe, repeatability_um=0.5, lobe_um=0.0)
    touches = Touches.from_columns(
        touch=np.arange(400),
        time_s=10.0 * np.arange(400),
        axis=np.full(400, Axis.X),
        sign=sign,
        feed_mm_min=np.full(400, 60.0),
        approach_mm=np.full(400, 1.0),
        position_mm=place,
        deviation_um=np.round(sign * error, 1),
    )
    nominal = replace(table.nominal, axis=axis, probe=probe)

    found = diagnose(playable(replace(table, nominal=nominal, touches=touches)), seed=1)

    sizes = {e.effect.id: e.effect.parameters for e in found.effects}
    assert sizes.keys() == {"transmission_error"} | ({"backlash"} if mean_um else set())
    if mean_um:
        # Far along the approach in the negative sense is near by the coordinate.
        assert -sizes["backlash"]["backlash_um"] == pytest.approx(mean_um, abs=0.15)


def test_what_is_known_of_a_datum_holds_it_back() -> None:
    """Ten touches of noise 0.3 µm know it to 0.1 µm; a belief as good as that takes half."""
    few = moved(quiet(), 1.0)
    few = replace(few, touches=few.touches.select(few.touches.axis == Axis.X))
    few = replace(few, touches=few.touches.select(slice(10)))
    anywhere = fitted(few)["X"]
    error_um = NOISE_UM / np.sqrt(10.0)

    half, none = (fitted(free(few, DatumFreedom.AXIS, u_um=u_um))["X"] for u_um in (error_um, 1e-4))

    assert half == pytest.approx(0.5 * anywhere, rel=0.15)
    assert none == pytest.approx(0.0, abs=0.01)


@pytest.mark.long
def test_a_surface_far_off_is_where_the_axis_meets_it_on_its_ramp() -> None:
    """It comes to another speed there, which was taken for a feed that is wrong."""
    machine = read_campaign(MACHINE)
    axis = replace(machine.nominal.axis, accel_mm_s2=300.0)
    slow = replace(machine, nominal=replace(machine.nominal, axis=axis))
    surface = FittedDatum({"X": -98.0, "Y": -79.0, "Z": -60.0})
    off_um, _ = surface.sizes_um(slow.nominal, slow.touches)
    met = replace(slow, touches=met_at(slow.touches, off_um))
    recorded = played_again(met).touches.deviation_um + off_um

    found = diagnose(
        replace(slow, touches=replace(slow.touches, deviation_um=recorded)), seed=1, jobs=2
    )

    assert found.verdict is Verdict.NO_GAP
    assert found.rig.datum.surface_um["X"] == pytest.approx(-98.0, abs=1.0)
    assert abs(found.rig.datum.coordinate_um["X"]) < 1.0


def test_stamps_and_coordinates_tell_of_a_datum_each() -> None:
    stamped = played_again(stamped_machine())
    stamped = replace(stamped, nominal=replace(stamped.nominal, datum=Datum.of_kind(Kind.MACHINE)))
    speed_um_us = Scene.of(stamped).speed
    touches = stamped.touches.in_order_of_time()
    late = replace(
        touches,
        latch_us=touches.latch_us + 40.0 / speed_um_us,
        deviation_um=touches.deviation_um + 40.0 + 9.0,
    )

    found = fitted_datum_um(Scene(stamped.nominal, late), Change())

    np.testing.assert_allclose(found[BY_STAMPS], 40.0, atol=0.5)
    np.testing.assert_allclose(found[BY_COORDINATES], 9.0, atol=0.5)
    assert WITHOUT_STAMPS not in found


# ---- the search of the likeliest length ----------------------------------------------------------


def by_brute_force(
    law: Law,
    values: FloatArray,
    per_length: FloatArray,
    groups: np.ndarray,
    u: float | None,
) -> list[float]:
    """The best of a fine grid of lengths, mended by scipy."""

    def cost(length: float, here: np.ndarray) -> float:
        off = values[here] - length * per_length[here]
        believed = 0.0 if u is None else 0.5 * (length / u) ** 2
        return believed - float(law_log_density(law.select(here), off, REACH).sum())

    best = []
    for group in range(int(groups.max()) + 1):
        here = groups == group
        grid = np.linspace(-20.0, 20.0, 2001)
        near = float(grid[np.argmin([cost(length, here) for length in grid])])
        found = optimize.minimize_scalar(
            cost, args=(here,), bounds=(near - 0.02, near + 0.02), method="bounded"
        )
        best.append(-cost(float(found.x), here))
    return best


N = 90
ONES = np.ones(N)
LAWS = {
    "boxes": Law(0.0 * ONES, 0.1 * ONES, 4.0 * ONES, 1.0 * ONES),
    "Gaussians": Law(0.0 * ONES, np.resize([0.3, 1.0, 3.0], N), 0.0 * ONES, 0.0 * ONES),
    "mixtures": Law(
        0.0 * ONES,
        0.5 * ONES,
        1.0 * ONES,
        0.0 * ONES,
        (Extra(0.2, offset=6.0, sigma=1.0), Extra(0.1, mean=5.0)),
    ),
}


def drawn(law: Law, rng: np.random.Generator) -> FloatArray:
    values = law.offset + law.sigma * rng.normal(size=N)
    values = values + law.box_a * rng.random(N) + law.box_b * rng.random(N)
    kind = rng.random(N)
    if law.extras:
        values = values + np.where(kind < 0.2, 6.0 + rng.normal(size=N), 0.0)
        values = values + np.where(kind > 0.9, rng.exponential(5.0, N), 0.0)
    return np.asarray(values)


def at_best_datum(
    law: Law,
    values: FloatArray,
    per_length: FloatArray,
    groups: NDArray[np.intp],
    u: float | None,
) -> tuple[FloatArray, FloatArray]:
    """Give the likeliest length of each group, and the logarithms of the densities there."""
    ffi, library = connection()
    found, logs = np.zeros(int(groups.max()) + 1), np.full(len(values), -np.inf)
    residuals, _kept = laid_out(law, values, REACH)
    numbers = groups.astype(np.uint32)
    parts = ffi.from_buffer("double[]", per_length), ffi.from_buffer("uint32_t[]", numbers)
    code = library.sim_law_at_best_datum(
        residuals,
        ffi.new("sim_datum_t *", (*parts, len(found), u or 0.0)),
        ffi.from_buffer("double[]", found, require_writable=True),
        ffi.from_buffer("double[]", logs, require_writable=True),
    )
    assert code == 0
    return found, logs


@pytest.mark.parametrize("u", [None, 0.5])
@pytest.mark.parametrize("name", LAWS)
def test_the_likeliest_length_of_each_group_is_that_of_brute_force(
    name: str, u: float | None
) -> None:
    """To a fifth of a nat: parabolas are drawn twice, and boxes are none."""
    rng, law = np.random.default_rng(7), LAWS[name]
    groups, per_length = np.resize([0, 1, 2], N), np.resize([1.0, 0.5], N)
    truth = np.array([0.0, 8.0, -5.0])
    values = drawn(law, rng) + truth[groups] * per_length

    found, logs = at_best_datum(law, values, per_length, groups, u)

    np.testing.assert_allclose(
        logs, law_log_density(law, values - found[groups] * per_length, REACH), atol=1e-9
    )
    believed = 0.0 if u is None else 0.5 * (found / u) ** 2
    reached = np.bincount(groups, logs) - believed
    np.testing.assert_allclose(
        reached, by_brute_force(law, values, per_length, groups, u), atol=0.2
    )


@pytest.mark.parametrize("name", LAWS)
def test_what_is_believed_is_never_likelier_than_the_likeliest_length(name: str) -> None:
    rng, law = np.random.default_rng(5), LAWS[name]
    values, groups = drawn(law, rng), np.zeros(N, dtype=np.intp)

    _, logs = at_best_datum(law, values, ONES, groups, None)

    assert logs.sum() >= law_log_density(law, values, REACH).sum() - 1e-9


def test_the_likeliest_length_is_found_where_the_middle_is_far_from_it() -> None:
    """Most touches are off by more than their laws allow, and no two of these alike."""
    law, rng = Law(0.0 * ONES, ONES, 0.0 * ONES, 0.0 * ONES), np.random.default_rng(3)
    anywhere = np.linspace(-100.0, 300.0, N)
    values = np.where(np.arange(N) % 3 == 0, -80.0 + law.sigma * rng.normal(size=N), anywhere)

    found, _ = at_best_datum(law, values, ONES, np.zeros(N, dtype=np.intp), None)

    assert np.median(values) > 0.0
    assert found[0] == pytest.approx(-80.0, abs=1.0)


def retried(rng: np.random.Generator) -> tuple[Law, FloatArray]:
    """Draw lengths of touches of several speeds, some of them late, and what might be held of them.

    What is held is off by some: a search for it comes by many such.
    """
    n, share, late_us = (
        int(rng.integers(30, 150)),
        rng.uniform(0.02, 0.5),
        10 ** rng.uniform(0, 2.5),
    )
    speed, sigma = rng.choice([1.0, 3.0, 10.0, 50.0], n), np.full(n, rng.uniform(0.2, 3.0))
    is_late = rng.random(n) < share
    values = sigma * rng.normal(size=n) + speed * is_late * late_us * rng.uniform(0.9, 1.1, n)
    held, believed_us = share * rng.uniform(0.5, 1.5), late_us * rng.uniform(0.9, 1.1)
    extras = [
        Extra((1.0 - held) * held**k, offset=k * believed_us * speed, sigma=0.1 * late_us * speed)
        for k in (1, 2)
    ]
    return Law(0.0 * speed, sigma, 0.0 * speed, 0.0 * speed, tuple(extras)), values


@pytest.mark.long
def test_the_likeliest_length_is_found_where_some_touches_come_far_later() -> None:
    """No touch is near the mean of such a law."""
    rng, missed = np.random.default_rng(11), []
    for _ in range(60):
        law, values = retried(rng)
        ones, groups = np.ones(len(values)), np.zeros(len(values), dtype=np.intp)
        moved = values + 3.0
        _, logs = at_best_datum(law, moved, ones, groups, None)
        missed.append(by_brute_force(law, moved, ones, groups, None)[0] - logs.sum())

    assert np.max(missed) < 0.2


def test_where_no_length_is_likely_no_touch_is() -> None:
    law, groups = LAWS["boxes"], np.zeros(N, dtype=np.intp)

    found, logs = at_best_datum(law, np.inf * ONES, ONES, groups, None)

    assert found.tolist() == [0.0]
    assert np.all(logs == -np.inf)
