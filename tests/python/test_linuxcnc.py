"""The component in the real LinuxCNC. Bounds leave room for a machine that is busy elsewhere."""

import subprocess
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from skiplatch.arrays import FloatArray
from tests.linuxcnc import measure

pytestmark = pytest.mark.long
FEED_MM_MIN = 1500
UM_PER_MS = FEED_MM_MIN / 60.0
SERVO_US = 1000.0


@pytest.fixture(scope="module", autouse=True)
def linuxcnc() -> None:
    if lack := measure.missing():
        pytest.skip(lack)
    measure.build()


def planned(count: int, bounces: int) -> list[dict[str, float]]:
    rng = np.random.default_rng(5)
    return [
        {
            "feed": FEED_MM_MIN,
            "surface": round(float(rng.uniform(10.0, 11.0)), 6),
            "sense": 1,
            "further": float(rng.uniform(0.0, 0.2)),
            "bounces": bounces,
        }
        for _ in range(count)
    ]


def played(
    folder: Path, mode: str, count: int, bounces: int, pins: Mapping[str, float]
) -> dict[str, FloatArray]:
    measure.run(folder, mode, planned(count, bounces), pins)
    columns = measure.read(folder)
    assert len(columns["surface_mm"]) == count
    return columns


def played_unless_stalled(
    folder: Path, mode: str, count: int, bounces: int, pins: Mapping[str, float]
) -> dict[str, FloatArray]:
    """Play up to three times: a machine that stalls makes an opening too long to be confirmed."""
    for attempt in range(2):
        try:
            return played(folder / str(attempt), mode, count, bounces, pins)
        except subprocess.CalledProcessError:
            pass
    return played(folder / "last", mode, count, bounces, pins)


def errors_us(columns: dict[str, FloatArray], latch: str) -> FloatArray:
    """Give the errors of the touches at which the machine did not stall."""
    good = measure.on_time(columns)
    error_um: FloatArray = 1000.0 * (columns[latch] - columns["surface_mm"])[good]
    return 1000.0 * error_um / UM_PER_MS


def test_the_component_is_tighter_than_the_servo_tick(tmp_path: Path) -> None:
    columns = played(tmp_path, "beside", 20, 0, {})
    own, ours = errors_us(columns, "linuxcnc_mm"), errors_us(columns, "skiplatch_mm")

    assert len(own) >= 10
    assert 0.25 * SERVO_US < np.median(own) < 0.75 * SERVO_US
    assert np.median(np.abs(ours)) < 0.1 * np.median(np.abs(own))


def test_programs_get_the_latched_position_unchanged(tmp_path: Path) -> None:
    columns = played(tmp_path, "through", 10, 0, {})
    logged = np.loadtxt(tmp_path / "probe.log")[:, 0]

    np.testing.assert_allclose(columns["linuxcnc_mm"], columns["skiplatch_mm"], atol=1e-9)
    np.testing.assert_allclose(logged, columns["skiplatch_mm"], atol=1e-6)


def test_debouncing_costs_way_and_moves_no_latch(tmp_path: Path) -> None:
    pins = {"skiplatch.0.confirm-us": 8000}
    quick = played(tmp_path / "quick", "through", 8, 0, {})
    slow = played(tmp_path / "slow", "through", 8, 0, pins)

    further_mm = slow["overtravel_mm"].mean() - quick["overtravel_mm"].mean()
    assert abs(further_mm - 7.5 * UM_PER_MS / 1000.0) < 2.0 * UM_PER_MS / 1000.0
    assert np.median(np.abs(errors_us(slow, "skiplatch_mm"))) < 0.1 * SERVO_US


def test_bounces_while_braking_end_no_program_and_move_no_latch(tmp_path: Path) -> None:
    """The contact opens thrice, for 3 ms each, while the axis brakes for 25 ms."""
    pins = {
        "touchrig.0.bounce-us": 3000,
        "touchrig.0.closing-us": 3000,
        "skiplatch.0.confirm-us": 500,
    }
    columns = played_unless_stalled(tmp_path, "through", 8, 3, pins)

    # Where the machine stalls, openings of a touch are not seen.
    assert np.median(columns["bounces"]) == 3.0
    assert np.median(np.abs(errors_us(columns, "skiplatch_mm"))) < 0.1 * SERVO_US


def test_without_the_component_such_bounces_end_the_program(tmp_path: Path) -> None:
    with pytest.raises(subprocess.CalledProcessError):
        played(
            tmp_path, "beside", 1, 3, {"touchrig.0.bounce-us": 3000, "touchrig.0.closing-us": 3000}
        )

    assert "Probe tripped during non-probe move" in (tmp_path / "log.txt").read_text()
