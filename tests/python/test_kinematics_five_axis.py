"""The simulated five-axis machine, touched through the firmware, against turned whole points."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from rotary_machines import KINDS, Array, Kind, Planted, centres, plant
from skiplatch.campaign import InputPath, Nominal
from skiplatch.kinematics.cycle import Control, opened
from skiplatch.kinematics.five_axis import (
    DEFAULT_RIG,
    Probing,
    RotaryTruth,
    Truth,
    probe_points,
)
from skiplatch.kinematics.machine import LETTERS, Machine, RotaryAxis, Vector
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import SimulationError
from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM

PLAIN_BC = Machine(
    (
        RotaryAxis("B", False, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (-90.0, 90.0)),
        RotaryAxis("C", False, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (-180.0, 180.0)),
    ),
    None,
)


def quiet_rig() -> Nominal:
    """Give a rig whose touches have no noise to speak of."""
    probe = replace(DEFAULT_RIG.probe, lobe_um=0.0, repeatability_um=0.0)
    axis = replace(DEFAULT_RIG.axis, resolution_um=1e-3)
    skip = replace(DEFAULT_RIG.skip, jitter_us=0.0, tick_us=0.01)
    return replace(DEFAULT_RIG, probe=probe, axis=axis, skip=skip)


def believed(planted: Planted) -> Machine:
    axes = tuple(
        RotaryAxis(
            letter,
            letter in planted.kind.head,
            tuple(planted.believed[letter].direction),
            tuple(planted.believed[letter].point),
            (-360.0, 360.0),
        )
        for letter in planted.kind.axes
    )
    return Machine(axes, tuple(planted.tip))


def truth(planted: Planted) -> Truth:
    axes = {}
    for letter in planted.kind.axes:
        offsets = [planted.errors.get(f"{x}O{letter}", 0.0) for x in "XYZ"]
        tilts = [planted.errors.get(f"{x}O{letter}", 0.0) for x in LETTERS]
        axes[letter] = RotaryTruth(
            offset_um=cast(Vector, tuple(offsets)), tilt_arcsec=cast(Vector, tuple(tilts))
        )
    return Truth(axes=axes, sphere_mm=tuple(planted.sphere))


def angles_of(kind: Kind, rng: np.random.Generator, n: int) -> Array:
    """Draw angles of A, B, C, shape (n, 3); absent axes stand at 0."""
    reach = {"A": 60.0, "B": 60.0, "C": 180.0}
    columns = [
        rng.uniform(-reach[x], reach[x], n) if x in kind.axes else np.zeros(n) for x in LETTERS
    ]
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("name", KINDS)
def test_touched_centres_are_where_turned_points_are(name: str) -> None:
    rng = np.random.default_rng(70)
    planted = plant(KINDS[name], rng)
    angles_deg = angles_of(planted.kind, rng, 12)
    own = [LETTERS.index(letter) for letter in planted.kind.axes]

    touched_mm = probe_points(
        believed(planted), truth(planted), angles_deg, seed=1, rig=quiet_rig()
    )

    expected_mm = centres(planted, angles_deg[:, own], rng, 0.0)
    assert np.max(np.abs(touched_mm - expected_mm)) < 3e-5


def test_a_zero_error_turns_the_sphere_by_it() -> None:
    shifted = Truth(axes={"C": RotaryTruth(zero_arcsec=3600.0)})
    angles_deg = np.array([[0.0, 0.0, 90.0]])

    found_mm = probe_points(PLAIN_BC, shifted, angles_deg, seed=1, rig=quiet_rig())[0]

    turn = np.radians(91.0)
    x, y, z = shifted.sphere_mm
    expected = [x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn), z]
    assert found_mm == pytest.approx(expected, abs=3e-5)


def test_backlash_is_the_angle_between_both_approaches() -> None:
    loose = Truth(axes={"C": RotaryTruth(backlash_arcsec=72.0)})
    angles_deg = np.array([[0.0, 0.0, c] for c in (-5.0, 30.0, 90.0, 30.0)])

    from_below, from_above = probe_points(PLAIN_BC, loose, angles_deg, seed=1, rig=quiet_rig())[
        [1, 3], :2
    ]

    turns = [np.degrees(np.arctan2(y, x)) for x, y in (from_below, from_above)]
    assert (turns[1] - turns[0]) * ARCSEC_PER_DEG == pytest.approx(72.0, abs=0.1)


def test_a_move_smaller_than_the_play_turns_nothing() -> None:
    loose = Truth(axes={"C": RotaryTruth(backlash_arcsec=3600.0)})
    angles_deg = np.array([[0.0, 0.0, c] for c in (10.0, 9.5, 9.0, 8.5)])

    y_mm = probe_points(PLAIN_BC, loose, angles_deg, seed=1, rig=quiet_rig())[:, 1]

    assert y_mm[1] == pytest.approx(y_mm[0], abs=3e-5)
    assert y_mm[2] == pytest.approx(y_mm[0], abs=3e-5)
    assert y_mm[3] < y_mm[0] - 0.5


def test_positioning_and_geometric_errors_show_at_their_angles() -> None:
    angles_deg = np.array([[0.0, 0.0, c] for c in (0.0, 90.0, 180.0)])
    plain = probe_points(PLAIN_BC, Truth(), angles_deg, seed=1, rig=quiet_rig())

    def changed(rotary: RotaryTruth) -> Array:
        other = Truth(axes={"C": rotary})
        return probe_points(PLAIN_BC, other, angles_deg, seed=1, rig=quiet_rig()) - plain

    arc_mm = np.radians(10.0 / ARCSEC_PER_DEG) * np.hypot(120.0, 60.0)
    once = np.linalg.norm(changed(RotaryTruth(once_arcsec=10.0)), axis=1)
    assert once == pytest.approx([0.0, arc_mm, 0.0], abs=3e-5)
    assert changed(RotaryTruth(axial_um=5.0))[:, 2] == pytest.approx([0.0, 0.005, 0.0], abs=3e-5)
    # The line is at q = (-r, 0) then: it carries the sphere by q minus q turned by 90°.
    assert changed(RotaryTruth(radial_um=5.0))[1] == pytest.approx([-0.005, 0.005, 0.0], abs=3e-5)


def test_long_and_askew_linear_axes_read_otherwise() -> None:
    askew = Truth(scale_ppm=(100.0, 0.0, 0.0), square_arcsec=(20.0, 0.0, 0.0))

    read_mm = probe_points(PLAIN_BC, askew, np.zeros((1, 3)), seed=1, rig=quiet_rig())[0]

    lean = np.radians(20.0 / ARCSEC_PER_DEG)
    assert read_mm[0] == pytest.approx(120.0 * (1.0 - 100e-6) - 60.0 * lean, abs=1e-4)
    assert read_mm[1] == pytest.approx(60.0, abs=1e-4)


def test_scan_latency_shows_up_in_the_scatter() -> None:
    still_deg = np.zeros((40, 3))

    skip_um, plc_um = (
        UM_PER_MM
        * np.std(
            probe_points(PLAIN_BC, Truth(), still_deg, seed=1, probing=Probing(path=path)), axis=0
        )
        for path in (InputPath.SKIP, InputPath.PLC)
    )

    # 120 mm/min over a scan of 4 ms is a box of 8 µm; a coordinate is half the difference of two
    # touches across it.
    assert plc_um[:2] == pytest.approx(8.0 / np.sqrt(12.0) / np.sqrt(2.0), rel=0.35)
    assert np.all(skip_um < 0.5)


def test_a_sphere_that_is_not_where_it_is_believed_is_named() -> None:
    far_off = Truth(axes={"C": RotaryTruth(offset_um=(50_000.0, 0.0, 0.0))})

    with pytest.raises(SimulationError, match="position 2: no sphere"):
        probe_points(PLAIN_BC, far_off, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 90.0]]), seed=1)


@pytest.mark.parametrize("filter_us", [-1.0, float("nan")])
def test_a_rig_that_cannot_be_played_is_said_to_be_none(filter_us: float) -> None:
    wrong = replace(DEFAULT_RIG, input=replace(DEFAULT_RIG.input, filter_us=filter_us))

    with pytest.raises(SimulationError, match="a value of the nominal chain is out of the range"):
        probe_points(PLAIN_BC, Truth(), np.zeros((1, 3)), seed=1, rig=wrong)
    with (
        pytest.raises(SimulationError, match="a value of the nominal chain is out of the range"),
        opened(PLAIN_BC, Truth(), Control(), {}, seed=1, rig=wrong),
    ):
        pass


def test_an_effect_out_of_its_range_is_named() -> None:
    wrong = Effect("backlash", {"backlash_um": 1e9})

    with pytest.raises(SimulationError, match=r"^backlash\.backlash_um: expected"):
        probe_points(PLAIN_BC, Truth(), np.zeros((1, 3)), seed=1, switched_on=[wrong])
    with (
        pytest.raises(SimulationError, match=r"^backlash\.backlash_um: expected"),
        opened(PLAIN_BC, Truth(), Control(), {}, seed=1, switched_on=[wrong]),
    ):
        pass
