"""Error motions of a rotary axis, told from sphere centres that own matrices turn."""

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from skiplatch.kinematics.error_motions import ErrorMotion, error_motions
from skiplatch.kinematics.machine import Machine, RotaryAxis
from skiplatch.kinematics.points import Points

ANGLES_DEG = np.arange(0.0, 360.0, 30.0)
TRAVEL = (-360.0, 360.0)
A = RotaryAxis("A", False, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), TRAVEL)
C = RotaryAxis("C", False, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), TRAVEL)
SPHERE_MM = np.array([90.0, 40.0, 25.0])
CENTRE_MM = np.array([3.0, -7.0, 0.0])


def about_z(angle_deg: float) -> FloatArray:
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def about_x(angle_deg: float) -> FloatArray:
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def planted_um(theta: FloatArray) -> FloatArray:
    """EXC three times a turn, EYC and EZC four and two times: no circle and no plane has that."""
    return np.column_stack(
        [2.0 * np.cos(3.0 * theta), -1.5 * np.sin(4.0 * theta), 0.8 * np.cos(2.0 * theta)]
    )


def measured(machine: Machine, a_deg: float, repeats: tuple[float, ...] = (0.0,)) -> ErrorMotion:
    theta = np.radians(ANGLES_DEG)
    still = np.array([about_z(angle) @ SPHERE_MM + CENTRE_MM for angle in ANGLES_DEG])
    moved = still + planted_um(theta) / 1000.0
    centres = (
        np.vstack([moved + np.array([0.0, 0.0, um / 1000.0]) for um in repeats]) @ about_x(a_deg).T
    )
    c_deg = np.tile(ANGLES_DEG, len(repeats))
    tilt = [np.full(len(c_deg), a_deg)] if len(machine.axes) > 1 else []
    (found,) = error_motions(machine, Points(np.column_stack([*tilt, c_deg]), centres))
    return found


@pytest.mark.parametrize(("axes", "a_deg"), [((C,), 0.0), ((A, C), 0.0), ((A, C), 35.0)])
def test_planted_motions_come_back(axes: tuple[RotaryAxis, ...], a_deg: float) -> None:
    found = measured(Machine(axes, None), a_deg)

    wanted_um = planted_um(np.radians(ANGLES_DEG))
    assert found.letter == "C"
    assert found.radius_mm == pytest.approx(np.hypot(90.0, 40.0), abs=1e-3)
    np.testing.assert_allclose(found.motion_um, wanted_um @ about_x(a_deg).T, atol=1e-6)
    np.testing.assert_allclose(found.face_um, wanted_um[:, 2], atol=1e-6)
    towards = np.array([about_z(angle) @ SPHERE_MM for angle in ANGLES_DEG])[:, :2]
    towards /= np.hypot(90.0, 40.0)
    radial_um = np.sum(wanted_um[:, :2] * towards, axis=1)
    np.testing.assert_allclose(found.radial_um, radial_um, atol=1e-6)
    assert found.values_um["radial"] == pytest.approx(np.ptp(radial_um), abs=1e-6)
    assert found.asynchronous_um is None


def test_what_does_not_repeat_is_told_apart() -> None:
    found = measured(Machine((C,), None), 0.0, repeats=(0.3, -0.3))

    assert found.asynchronous_um == pytest.approx(0.6, abs=1e-6)
    wanted_um = planted_um(np.radians(ANGLES_DEG))
    np.testing.assert_allclose(found.motion_um, wanted_um, atol=1e-6)


def test_location_errors_are_no_error_motion() -> None:
    """A line that lies elsewhere and leans: the mean circle and plane take it."""
    lean = about_x(0.01)
    centres = np.array([lean @ about_z(angle) @ SPHERE_MM + CENTRE_MM for angle in ANGLES_DEG])

    (found,) = error_motions(Machine((C,), None), Points(ANGLES_DEG[:, None], centres))

    assert found.values_um["face"] < 1e-3
    assert found.values_um["radial"] < 1e-2  # of the second order: 100 mm · (0.01°)²/4


def test_four_angles_are_too_few() -> None:
    centres = np.array([about_z(angle) @ SPHERE_MM for angle in ANGLES_DEG[:4]])

    assert error_motions(Machine((C,), None), Points(ANGLES_DEG[:4, None], centres)) == []


def test_a_sphere_on_the_axis_shows_no_motion() -> None:
    still = Points(np.array(ANGLES_DEG, dtype=float)[:, None], np.zeros((len(ANGLES_DEG), 3)))

    assert error_motions(Machine((C,), None), still) == []
