"""Consoles that show the newest line first, without any time."""

from pathlib import Path

import pytest

from skiplatch.errors import CampaignWarning
from skiplatch.importing.log_order import is_newest_first
from test_import_logs import Run

TEST = """PROBE_ACCURACY PROBE_SPEED={speed}
PROBE_ACCURACY at X:100.000 Y:100.000 Z:5.000 (samples=3 retract=2.000 speed={speed} lift_speed=5.0)
probe at 100.000,100.000 is z={z}0
probe at 100.000,100.000 is z={z}1
probe at 100.000,100.000 is z={z}2
probe accuracy results: maximum {z}2, minimum {z}0, range 0.002
"""
MESH = "probe at 10.000,10.000 is z=0.1\nprobe at 100.000,10.000 is z=0.2\n"
KLIPPER = TEST.format(speed="2.0", z="0.50") + "G1 Z5\n" + TEST.format(speed="10.0", z="0.48")
GRBL = """G21 G91
ok
G38.2 Z-10 F100
[PRB:0.000,0.000,-12.345:1]
ok
G0 Z3
ok
G38.2 Z-10 F20
[PRB:0.000,0.000,-12.349:1]
ok
"""


def turned(text: str) -> str:
    return "\n".join(text.splitlines()[::-1]) + "\n"


@pytest.mark.parametrize(("kind", "text"), [("klipper", KLIPPER), ("grbl", GRBL)])
def test_console_without_times_is_turned_round(tmp_path: Path, kind: str, text: str) -> None:
    found = []
    for name, written in (("down", text), ("up", turned(text))):
        (tmp_path / name).mkdir()
        (tmp_path / name / "c.log").write_text(written)
        if name == "up":
            with pytest.warns(CampaignWarning, match="read from below"):
                found.append(Run(tmp_path / name, kind, str(tmp_path / name / "c.log")))
        else:
            found.append(Run(tmp_path / name, kind, str(tmp_path / name / "c.log")))

    down, up = (run.campaign.touches for run in found)
    assert up.deviation_um.tolist() == down.deviation_um.tolist()
    assert up.feed_mm_min.tolist() == down.feed_mm_min.tolist()


@pytest.mark.parametrize(
    "text",
    [
        KLIPPER + MESH,
        MESH + KLIPPER + MESH,
        MESH + "PROBE_ACCURACY at X:10.000 Y:10.000 Z:5.000\n",  # the rest is cut
        "".join(MESH + TEST.format(speed="2.0", z="0.50") for _ in range(3)) + MESH,
        "".join(line for line in KLIPPER.splitlines(True) if "results" not in line)[37:],
        "probe accuracy results: maximum 1\n" + MESH,
        GRBL[15:],
        "ok\n[PRB:0.000,0.000,-12.345:1]\nok\n[PRB:0.000,0.000,-12.349:1]\nok\n",
        "G38.2 Z-1\nG0 Z1\nG38.2 Z-1\n[PRB:0,0,-1:1]\nok\nok\n[PRB:0,0,-1:1]\nok\n",
        "[ G38.2 X62 F80 ] [PRB:0,0,-1:1]\n" * 3,
        "M48 Z-Probe Repeatability Test\n1 of 2: z: 0.1\n2 of 2: z: 0.1\nFinished!\n",
    ],
)
def test_log_in_order_is_left_so(text: str) -> None:
    assert not is_newest_first(text.splitlines())


@pytest.mark.parametrize(
    "text",
    [
        KLIPPER + MESH,
        MESH + KLIPPER,
        GRBL,
        "M48 Z-Probe Repeatability Test\n1 of 2: z: 0.1\n2 of 2: z: 0.1\nFinished!\n",
    ],
)
def test_log_from_below_is_told(text: str) -> None:
    assert is_newest_first(turned(text).splitlines())
