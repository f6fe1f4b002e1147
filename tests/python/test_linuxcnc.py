"""The component in the real LinuxCNC, by the touches at which the machine kept time."""

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
ATTEMPTS = 4


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


def played_on_time(
    folder: Path, mode: str, count: int, bounces: int, pins: Mapping[str, float]
) -> dict[str, FloatArray]:
    """Play until the machine has kept time at half of the touches: give those.

    A machine that stalls tells nothing of the component. It may also make an opening too long to be
    confirmed, which ends the program.
    """
    on_time = []
    for attempt in range(ATTEMPTS):
        try:
            columns = played(folder / str(attempt), mode, count, bounces, pins)
        except subprocess.CalledProcessError:
            if bounces and attempt < ATTEMPTS - 1:
                continue
            raise
        good = measure.on_time(columns)
        on_time.append(int(good.sum()))
        if good.sum() >= count / 2:
            return {name: values[good] for name, values in columns.items()}
    pytest.skip(f"this machine stalls: of {count} touches only {on_time} were on time")


def errors_us(columns: dict[str, FloatArray], latch: str) -> FloatArray:
    error_um: FloatArray = 1000.0 * (columns[latch] - columns["surface_mm"])
    return 1000.0 * error_um / UM_PER_MS


def test_the_component_is_tighter_than_the_servo_tick(tmp_path: Path) -> None:
    columns = played_on_time(tmp_path, "beside", 40, 0, {})
    own, ours = errors_us(columns, "linuxcnc_mm"), errors_us(columns, "skiplatch_mm")

    # A servo tick comes anywhere within a period after the contact.
    four_errors_us = 4.0 * SERVO_US / np.sqrt(12.0 * len(own))
    assert abs(own.mean() - 0.5 * SERVO_US) < four_errors_us
    assert np.median(np.abs(ours)) < 0.1 * np.median(np.abs(own))


def test_programs_get_the_latched_position_unchanged(tmp_path: Path) -> None:
    columns = played(tmp_path, "through", 10, 0, {})
    logged = np.loadtxt(tmp_path / "probe.log")[:, 0]

    np.testing.assert_allclose(columns["linuxcnc_mm"], columns["skiplatch_mm"], atol=1e-9)
    np.testing.assert_allclose(logged, columns["skiplatch_mm"], atol=1e-6)


def test_debouncing_costs_way_and_moves_no_latch(tmp_path: Path) -> None:
    pins = {"skiplatch.0.confirm-us": 8000}
    quick = played_on_time(tmp_path / "quick", "through", 12, 0, {})
    slow = played_on_time(tmp_path / "slow", "through", 12, 0, pins)

    further_mm = np.median(slow["overtravel_mm"]) - np.median(quick["overtravel_mm"])
    assert abs(further_mm - 7.5 * UM_PER_MS / 1000.0) < 2.0 * UM_PER_MS / 1000.0
    assert np.median(np.abs(errors_us(slow, "skiplatch_mm"))) < 0.1 * SERVO_US


def test_bounces_while_braking_end_no_program_and_move_no_latch(tmp_path: Path) -> None:
    """The contact opens thrice, for 3 ms each, while the axis brakes for 25 ms."""
    pins = {
        "touchrig.0.bounce-us": 3000,
        "touchrig.0.closing-us": 3000,
        "skiplatch.0.confirm-us": 500,
    }
    columns = played_on_time(tmp_path, "through", 8, 3, pins)

    assert np.median(columns["bounces"]) == 3.0
    assert np.median(np.abs(errors_us(columns, "skiplatch_mm"))) < 0.1 * SERVO_US


def test_without_the_component_such_bounces_end_the_program(tmp_path: Path) -> None:
    with pytest.raises(subprocess.CalledProcessError):
        played(
            tmp_path, "beside", 1, 3, {"touchrig.0.bounce-us": 3000, "touchrig.0.closing-us": 3000}
        )

    assert "Probe tripped during non-probe move" in (tmp_path / "log.txt").read_text()
