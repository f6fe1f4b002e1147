"""rotary_pivot and backlash of the catalogue against the physics of the five-axis machine."""

import numpy as np
import pytest

from effects_rig import assert_close, trace
from skiplatch.campaign import InputPath
from skiplatch.kinematics.five_axis import RotaryTruth, Truth, probe_points
from skiplatch.simulator.effects import Effect
from skiplatch.units import UM_PER_MM
from test_kinematics_five_axis import PLAIN_BC, quiet_rig

TOUCHES = 40
CENTRE_UM = (12.0, -7.0)


@pytest.mark.parametrize("mirrored", [0.0, 1.0])
def test_rotary_pivot_is_what_a_shifted_table_does_to_a_sphere(mirrored: float) -> None:
    x_um, y_um = CENTRE_UM
    played = trace(InputPath.SKIP, "rotary_pivot", x_um=x_um, y_um=y_um, mirrored=mirrored)
    touches = played.touches
    sense = -1.0 if mirrored else 1.0
    angles_deg = np.zeros((TOUCHES, 3))
    angles_deg[:, 2] = sense * touches.rotary_deg[:TOUCHES]
    shifted = Truth(axes={"C": RotaryTruth(offset_um=(x_um, y_um, 0.0))})

    shift_um = UM_PER_MM * (
        probe_points(PLAIN_BC, shifted, angles_deg, seed=1, rig=quiet_rig())
        - probe_points(PLAIN_BC, Truth(), angles_deg, seed=1, rig=quiet_rig())
    )

    alpha, beta = np.deg2rad(touches.alpha_deg[:TOUCHES]), np.deg2rad(touches.beta_deg[:TOUCHES])
    along_um = np.cos(beta) * (shift_um[:, 0] * np.cos(alpha) + shift_um[:, 1] * np.sin(alpha))
    assert np.ptp(along_um) > 10.0
    assert_close(np.ravel(played.deviation_shift_um)[:TOUCHES], along_um, 0.05)


def test_backlash_moves_the_centre_of_a_sphere_by_half_of_it_and_its_pole_by_all() -> None:
    at_zero = np.zeros((1, 3))
    plain = probe_points(PLAIN_BC, Truth(), at_zero, seed=1, rig=quiet_rig())
    effect = Effect("backlash", {"backlash_um": 6.0})

    loose = probe_points(PLAIN_BC, Truth(), at_zero, seed=1, rig=quiet_rig(), switched_on=[effect])

    # Opposite sides are touched in opposite senses, the pole only downwards.
    assert UM_PER_MM * (loose - plain)[0] == pytest.approx([3.0, 3.0, 6.0], abs=0.03)
