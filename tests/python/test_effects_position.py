"""Physics of the effects on the position that is latched. Stamps are another test's business."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from effects_rig import (
    MACHINE,
    POSITION_TOLERANCE_UM,
    RESOLUTION_UM,
    Trace,
    assert_close,
    assert_follows,
    mixed_touches,
    run,
    trace,
)
from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath
from skiplatch.simulator.effects import Effect

SKIP, PLC = InputPath.SKIP, InputPath.PLC

SCALE = {"scale_ppm": 60.0}

both_paths = pytest.mark.parametrize("path", list(InputPath))


def coordinate_mm(played: Trace) -> FloatArray:
    """Of the axis, where the nominal chain latches."""
    way_mm = played.nominal.deviation_um[0] / 1e3
    return np.asarray(played.touches.position_mm + played.touches.sign * way_mm)


@both_paths
def test_servo_hold_reads_the_position_of_the_last_update(path: InputPath) -> None:
    period_us = 2500.0
    phases = []
    for seed in (1, 2, 3):
        played = trace(path, "servo_hold", n=1000, seed=seed, period_us=period_us)
        fast = played.speed_um_us > 0.01  # 1 nm of resolution is less than 0.1 µs
        age_us = -(played.deviation_shift_um / played.speed_um_us)[fast]
        read_us = played.nominal.latch_us[0, fast] - age_us

        assert age_us.min() > -0.1
        assert age_us.max() < period_us + 0.1
        phase_us = read_us[0] % period_us
        assert_close((read_us - phase_us + 1.0) % period_us, 1.0, 0.3)
        phases.append(phase_us)
        if path == SKIP:
            assert_follows(age_us, stats.uniform(0.0, period_us))
    assert np.ptp(phases) > 50.0


@both_paths
def test_servo_hold_updates_at_its_phase_on_the_clock(path: InputPath) -> None:
    for seed in (1, 2, 3):
        played = trace(path, "servo_hold", seed=seed, period_us=2500.0, phase_deg=90.0)
        fast = played.speed_um_us > 0.01
        read_us = played.nominal.latch_us[0] + played.deviation_shift_um / played.speed_um_us

        assert_close((read_us[fast] - 0.25 * 2500.0 + 1.0) % 2500.0, 1.0, 0.3)


@both_paths
def test_servo_hold_updates_by_a_device_clock_that_drifts(path: InputPath) -> None:
    touches = mixed_touches(400, seed=1, path=path)
    drift = Effect("timer_drift", {"drift_ppm": 50.0})
    hold = Effect("servo_hold", {"period_us": 2500.0, "phase_deg": 90.0})
    before, after = run(touches, drift, seed=1), run(touches, drift, hold, seed=1)
    speed_um_us = touches.feed_mm_min / 6e4
    fast = speed_um_us > 0.01
    age_us = (before.deviation_um[0] - after.deviation_um[0]) / speed_um_us

    read_us = (before.latch_us[0] - age_us)[fast]
    assert_close((read_us - 0.25 * 2500.0 + 1.0) % 2500.0, 1.0, 0.5)


@both_paths
@pytest.mark.parametrize("lag_us", [-80.0, 300.0])
def test_following_error_reads_ahead_by_the_way_of_the_lag(path: InputPath, lag_us: float) -> None:
    played = trace(path, "following_error", lag_us=lag_us)

    assert_close(played.deviation_shift_um, played.speed_um_us * lag_us, POSITION_TOLERANCE_UM)


@both_paths
def test_following_error_may_scatter_by_a_time(path: InputPath) -> None:
    played = trace(path, "following_error", lag_us=300.0, scatter_us=50.0)

    lags_us = played.deviation_shift_um / played.speed_um_us

    assert np.mean(lags_us) == pytest.approx(300.0, abs=4.0 * 50.0 / np.sqrt(len(lags_us)))
    assert np.std(lags_us) == pytest.approx(50.0, rel=4.0 / np.sqrt(2.0 * len(lags_us)))


def test_no_lag_scatters_by_more_than_itself() -> None:
    assert not trace(SKIP, "following_error", scatter_us=50.0).deviation_shift_um.any()

    played = trace(SKIP, "following_error", lag_us=30.0, scatter_us=500.0)

    lags_us = played.deviation_shift_um / played.speed_um_us
    assert np.std(lags_us) == pytest.approx(30.0, rel=4.0 / np.sqrt(2.0 * len(lags_us)))


@both_paths
@pytest.mark.parametrize("backlash_um", [-2.0, 3.5])
def test_backlash_shifts_the_negative_sense_alone(path: InputPath, backlash_um: float) -> None:
    played = trace(path, "backlash", backlash_um=backlash_um)
    expected_um = np.where(played.touches.sign < 0.0, -backlash_um, 0.0)

    assert_close(played.deviation_shift_um, expected_um, POSITION_TOLERANCE_UM)


def test_transmission_error_is_periodic_in_the_coordinate_with_harmonics() -> None:
    played = trace(
        SKIP,
        "transmission_error",
        amplitude_um=4.0,
        period_mm=5.0,
        phase_deg=70.0,
        amplitude2_um=1.5,
        phase2_deg=200.0,
        amplitude3_um=0.7,
        phase3_deg=40.0,
    )
    turn_deg = 360.0 * coordinate_mm(played) / 5.0
    orders = ((1.0, 4.0, 70.0), (2.0, 1.5, 200.0), (3.0, 0.7, 40.0))
    error_um = sum(um * np.sin(np.deg2rad(k * turn_deg + deg)) for k, um, deg in orders)

    assert_close(
        played.deviation_shift_um, played.touches.sign * error_um, 1.1 * POSITION_TOLERANCE_UM
    )


def test_each_axis_may_have_a_transmission_error_of_its_own() -> None:
    own = {
        "y_excess_ratio": 0.5,
        "z_excess_ratio": -0.25,
        "y_ahead_deg": 40.0,
        "z_ahead_deg": 190.0,
    }
    effect = Effect("transmission_error", {"amplitude_um": 4.0, "period_mm": 5.0, **own})
    touches = mixed_touches(300, seed=11, path=SKIP)
    touches = replace(touches, axis=(np.arange(300) % 3).astype(np.int8))
    played = Trace(touches, run(touches, seed=11), run(touches, effect, seed=11))
    size_um = np.array([4.0, 6.0, 3.0])[played.touches.axis]
    ahead_deg = np.array([0.0, 40.0, 190.0])[played.touches.axis]
    turn = 2.0 * np.pi * coordinate_mm(played) / 5.0 + np.deg2rad(ahead_deg)

    assert_close(
        played.deviation_shift_um,
        played.touches.sign * size_um * np.sin(turn),
        1.2 * POSITION_TOLERANCE_UM,
    )


@both_paths
def test_scale_error_grows_with_the_coordinate(path: InputPath) -> None:
    played = trace(path, "scale_error", scale_ppm=-250.0)
    error_um = coordinate_mm(played) * 1e3 * -250e-6

    assert_close(played.deviation_shift_um, played.touches.sign * error_um, POSITION_TOLERANCE_UM)


def test_encoder_quantisation_rounds_to_the_nearest() -> None:
    played = trace(SKIP, "encoder_quantisation", resolution_um=1.5)
    counts = played.changed.deviation_um[0] / 1.5

    assert_close(counts, np.rint(counts), 1e-9)
    assert np.abs(played.deviation_shift_um).max() < 0.75 + RESOLUTION_UM
    assert np.abs(played.deviation_shift_um).max() > 0.7


def test_encoder_quantisation_has_the_lines_of_the_coordinate_where_they_are_said_to_be() -> None:
    played = trace(SKIP, "encoder_quantisation", resolution_um=1.5, is_coordinate=1.0, origin=0.3)
    way_um = played.touches.sign * played.changed.deviation_um[0]
    counts = (played.touches.position_mm * 1e3 + way_um) / 1.5 - 0.3

    assert_close(counts, np.rint(counts), RESOLUTION_UM)
    assert np.abs(played.deviation_shift_um).max() < 0.75 + RESOLUTION_UM
    assert np.abs(played.deviation_shift_um).max() > 0.7


@pytest.mark.parametrize("is_coordinate", [0.0, 1.0])
def test_an_encoder_keeps_its_lines_whatever_is_believed_and_goes_before(
    is_coordinate: float,
) -> None:
    step_um, coarse = 1.13, replace(MACHINE, axis=replace(MACHINE.axis, resolution_um=0.2))
    touches = mixed_touches(400, seed=11)
    origin = 0.5 * is_coordinate
    parameters = {"resolution_um": step_um, "is_coordinate": is_coordinate, "origin": origin}
    encoder, scale = Effect("encoder_quantisation", parameters), Effect("scale_error", SCALE)

    plain, read = (run(touches, *e, nominal=coarse) for e in ([scale], [scale, encoder]))

    surface_um = touches.position_mm * 1e3 * touches.sign * is_coordinate
    counts = (surface_um + read.deviation_um[0]) / step_um - touches.sign * origin
    assert_close(counts, np.rint(counts), 0.002)  # positions are told to a hundredth of 0.2 µm
    off_um = read.deviation_um[0] - plain.deviation_um[0]
    assert_follows(off_um / step_um, stats.uniform(-0.5, 1.0))


def lagged_c(time_s: FloatArray, temp_c: FloatArray, lag_s: float) -> FloatArray:
    """A first-order lag that settles on the first reading and takes each one as held before it."""
    lagged = [float(temp_c[0])]
    for elapsed_s, now_c in zip(np.diff(time_s), temp_c[1:], strict=True):
        lagged.append(now_c + (lagged[-1] - now_c) * float(np.exp(-elapsed_s / lag_s)))
    return np.array(lagged)


@pytest.mark.parametrize("lag_s", [0.0, 60.0, 900.0])
def test_thermal_drift_follows_the_temperature_with_its_lag(lag_s: float) -> None:
    played = trace(SKIP, "thermal_drift", drift_um_k=2.0, lag_s=lag_s)
    touches = played.touches
    temp_c = lagged_c(touches.time_s, touches.temp_c, lag_s) if lag_s else touches.temp_c

    expected_um = touches.sign * 2.0 * (temp_c - 20.0)
    assert_close(played.deviation_shift_um, expected_um, POSITION_TOLERANCE_UM)


@pytest.mark.parametrize("number", [1, 4])
def test_thermal_drift_follows_whichever_thermometer_it_is_told(number: int) -> None:
    touches = mixed_touches(200, seed=4)
    rng = np.random.default_rng(7)
    places = {f"at_{i}": rng.uniform(15.0, 35.0, len(touches)) for i in range(1, 6)}
    warmed = replace(touches, thermometers=places)
    drift = Effect("thermal_drift", {"drift_um_k": 2.0, "thermometer": float(number)})

    shift_um = run(warmed, drift).deviation_um[0] - run(warmed).deviation_um[0]

    expected_um = touches.sign * 2.0 * (places[f"at_{number}"] - 20.0)
    assert_close(shift_um, expected_um, POSITION_TOLERANCE_UM)
    assert not (run(touches, drift).deviation_um[0] - run(touches).deviation_um[0]).any()


def test_a_scale_that_grows_is_off_by_how_far_the_axis_is_from_its_zero() -> None:
    played = trace(SKIP, "thermal_drift", expansion_ppm_k=11.5)
    touches = played.touches

    expected_um = touches.sign * 11.5e-3 * coordinate_mm(played) * (touches.temp_c - 20.0)
    assert np.ptp(expected_um) > 100.0 * POSITION_TOLERANCE_UM
    assert_close(played.deviation_shift_um, expected_um, POSITION_TOLERANCE_UM)


def test_a_probe_that_grows_is_late_in_either_sense() -> None:
    played = trace(SKIP, "thermal_drift", drift_um_k=2.0, along_approach=1.0)
    touches = played.touches

    assert set(touches.sign) == {-1.0, 1.0}
    expected_um = 2.0 * (touches.temp_c - 20.0)
    assert_close(played.deviation_shift_um, expected_um, POSITION_TOLERANCE_UM)


@both_paths
@pytest.mark.parametrize(
    ("effect_id", "parameters"),
    [
        ("thermal_drift", {"drift_um_k": 2.0, "along_approach": 1.0}),
        ("thermal_drift", {"drift_um_k": -2.0, "lag_s": 300.0}),
        ("rotary_pivot", {"x_um": 20.0, "y_um": -15.0}),
        ("backlash", {"backlash_um": 15.0, "positive_um": 2.0}),
        ("scale_error", {"scale_ppm": -60.0}),
        ("transmission_error", {"amplitude_um": 8.0, "period_mm": 20.0, "at_surface": 1.0}),
    ],
)
def test_a_surface_that_moves_is_met_so_much_later(
    path: InputPath, effect_id: str, parameters: dict[str, float]
) -> None:
    """What it moves by is what the same effect is read off by where the surface stays."""
    read_off = trace(path, effect_id, n=400, seed=5, **parameters)

    moved = trace(path, effect_id, n=400, seed=5, **parameters, moves_surface=1.0)

    way_um = read_off.deviation_shift_um
    assert np.ptp(way_um) > 10.0
    assert not read_off.edge_shift_us.any()
    # A scale errs by where the axis is when it is latched, or by where the surface should be.
    close_um = POSITION_TOLERANCE_UM + (0.02 if effect_id == "scale_error" else 0.0)
    assert_close(moved.edge_shift_us * moved.speed_um_us, way_um, close_um)
    if path == InputPath.SKIP:
        assert_close(moved.deviation_shift_um, way_um, close_um)


def test_thermal_drift_remembers_in_the_order_of_time_not_of_the_rows() -> None:
    touches = mixed_touches(200, seed=4)
    drift = Effect("thermal_drift", {"drift_um_k": 3.0, "lag_s": 600.0})
    backwards = np.arange(len(touches))[::-1]

    in_order, turned = run(touches, drift), run(touches.select(backwards), drift)

    np.testing.assert_array_equal(in_order.deviation_um[:, backwards], turned.deviation_um)


def test_rotary_pivot_carries_the_workpiece_round_the_wrong_centre() -> None:
    played = trace(SKIP, "rotary_pivot", x_um=12.0, y_um=-7.0)
    touches = played.touches
    angle, alpha = np.deg2rad(touches.rotary_deg), np.deg2rad(touches.alpha_deg)
    centre = 12.0 - 7.0j
    shift = centre + np.exp(1j * angle) * (0.0 - centre)  # of the point believed to be the centre
    along_um = (shift * np.exp(-1j * alpha)).real * np.cos(np.deg2rad(touches.beta_deg))

    assert_close(played.deviation_shift_um, along_um, POSITION_TOLERANCE_UM)
    at_rest = touches.rotary_deg == 0.0
    np.testing.assert_array_equal(played.deviation_shift_um[at_rest], 0.0)
