"""``skiplatch import marlin`` of what RepRapFirmware prints: `G30 S-1` on a Duet."""

from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from test_import_logs import LOGS, Run


def test_touches_of_a_duet_have_the_second_speed_of_their_m558(tmp_path: Path) -> None:
    run = Run(tmp_path, "marlin", str(LOGS / "marlin_duet.log"))

    touches = run.campaign.touches
    latched = ~touches.missed
    assert touches.missed.tolist() == [False, False, False, True, False, False, False]
    assert touches.feed_mm_min[latched].tolist() == [180.0] * 3 + [60.0] * 3
    z_mm = touches.position_mm - touches.deviation_um / 1e3
    assert z_mm[latched] == pytest.approx([-0.005, -0.010, -0.008, 0.002, 0.0, 0.002])
    assert np.diff(touches.time_s)[:2].tolist() == [11.0, 11.0]


def test_a_feed_that_is_given_counts_more_than_the_log(tmp_path: Path) -> None:
    run = Run(tmp_path, "marlin", str(LOGS / "marlin_duet.log"), "--feed", "90")

    assert set(run.campaign.touches.feed_mm_min) == {90.0}


@pytest.mark.parametrize("between", ["G28", "G32", "G30"])
def test_what_moves_the_height_of_a_duet_begins_a_session(tmp_path: Path, between: str) -> None:
    touch = "G30 S-1\nStopped at height 1.234 mm\n"
    (tmp_path / "d.log").write_text(f"{touch * 2}{between}\n{touch * 2}")

    run = Run(tmp_path, "marlin", str(tmp_path / "d.log"))

    assert len(set(run.campaign.touches.session.tolist())) == 2


def test_moves_tell_the_places_of_a_duet(tmp_path: Path) -> None:
    touch = "G30 S-1\nStopped at height 1.234 mm\n" * 2
    (tmp_path / "d.log").write_text(f"G1 X10 Y20 F6000\n{touch}G1 X50\n{touch}")

    run = Run(tmp_path, "marlin", str(tmp_path / "d.log"))

    assert any(line == "4 touches of 2 surfaces" for line in run.said["known"])


def test_several_taps_and_a_probe_that_was_triggered_are_said(tmp_path: Path) -> None:
    (tmp_path / "d.log").write_text(
        "M558 P8 H3 F120 A5\nG30 S-1\nStopped at height 1.234 mm\nG30 S-1\n"
        "Error: Probe already triggered before probing move started\n"
    )

    run = Run(tmp_path, "marlin", str(tmp_path / "d.log"))

    assert run.campaign.touches.false.tolist() == [False, True]
    assert any(line.startswith("M558 A5: a height may be the mean") for line in run.said["assumed"])


@pytest.mark.parametrize("kind", ["grbl", "klipper"])
def test_other_importers_name_the_one_that_reads_a_duet(
    tmp_path: Path, refused: Program, kind: str
) -> None:
    said = refused("import", kind, LOGS / "marlin_duet.log", "-o", tmp_path / "x")

    assert f"no touches of {kind}, but of marlin: skiplatch import marlin reads them" in said
