"""``skiplatch import edges``: bounces of a contact where a skip input and a PLC task latch it."""

from pathlib import Path

import numpy as np
import pytest

from test_import_logs import Run

PROBE, SKIP, PLC = range(3)
ALL_LOW = (0, 0, 0)
PLC_LATCHES_US = (70.0, 2600.0, 3900.0)


def written(path: Path, changes: list[tuple[float, int, int]]) -> str:
    """Write a capture of a probe and two latches, times in µs."""
    levels, rows = list(ALL_LOW), ["Time [us],Probe,Skip,PLC", "0,0,0,0"]
    for time_us, channel, level in sorted(changes):
        levels[channel] = level
        rows.append(f"{time_us:g},{','.join(map(str, levels))}")
    path.write_text("\n".join(rows) + "\n")
    return str(path)


def contact(
    start_us: float, plc_us: float, *, skip_us: float | None = 7.0
) -> list[tuple[float, int, int]]:
    """Give a contact of 8 ms that bounces once, and its latches so long after the first edge."""
    bouncing = [(0.0, 1), (40.0, 0), (55.0, 1), (8000.0, 0)]
    changes = [(start_us + after_us, PROBE, level) for after_us, level in bouncing]
    changes += [(start_us + plc_us, PLC, 1), (start_us + 9500.0, PLC, 0)]
    if skip_us is not None:
        changes += [(start_us + skip_us, SKIP, 1), (start_us + 9000.0, SKIP, 0)]
    return changes


def edges(path: str, tmp_path: Path) -> Run:
    return Run(tmp_path, "edges", path, "--probe", "Probe", "--latch", "Skip", "--plc-latch", "PLC")


def test_bounce_is_none_the_less_one_where_another_output_latches_after_it(tmp_path: Path) -> None:
    changes = [
        change
        for i, plc_us in enumerate(PLC_LATCHES_US)
        for change in contact(1000 + 20_000 * i, plc_us, skip_us=None if i == 1 else 7.0)
    ]

    run = edges(written(tmp_path / "c.csv", changes), tmp_path)

    touches = run.campaign.touches
    waits_us = touches.latch_us - touches.edge_us
    assert waits_us[~touches.on_plc] == pytest.approx([7.0, np.nan, 7.0], nan_ok=True)
    assert waits_us[touches.on_plc] == pytest.approx(PLC_LATCHES_US)
    assert any(line.startswith("3 edges so near") for line in run.said["assumed"])


def test_edge_near_another_is_a_touch_if_one_output_latches_both(tmp_path: Path) -> None:
    changes = contact(1000, 3000)
    again = [(1055.0 + 9.0, SKIP, 1), (1048.0, SKIP, 0)]

    run = edges(written(tmp_path / "c.csv", [*changes, *again]), tmp_path)

    touches = run.campaign.touches
    skip_us = (touches.latch_us - touches.edge_us)[~touches.on_plc]
    assert skip_us == pytest.approx([7.0, 9.0])


def test_latch_of_a_short_contact_may_come_after_the_bounce_of_its_release(tmp_path: Path) -> None:
    changes = []
    for start in (1000.0, 21_000.0):
        for after_us, level in ((0.0, 1), (2000.0, 0), (2020.0, 1), (2050.0, 0)):
            changes.append((start + after_us, PROBE, level))
        changes += [(start + 6.0, SKIP, 1), (start + 5000.0, SKIP, 0)]
        changes += [(start + 2500.0, PLC, 1), (start + 5500.0, PLC, 0)]

    run = edges(written(tmp_path / "c.csv", changes), tmp_path)

    touches = run.campaign.touches
    waits_us = touches.latch_us - touches.edge_us
    assert waits_us == pytest.approx([6.0, 2500.0] * 2)
