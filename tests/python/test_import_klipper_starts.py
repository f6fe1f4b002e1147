"""``skiplatch import klipper``: how far it is to the first touch of a PROBE_ACCURACY."""

from pathlib import Path

import numpy as np
import pytest

from test_import_logs import Run

TEST = "PROBE_ACCURACY at X:10.000 Y:10.000 Z:10.000 (samples=2 retract=3.000 speed=5.0)\n"
OF_BED = "probe: at 10.000,35.000 bed will contact at z={:.6f}\n"
OF_TOOLHEAD = "probe at 10.000,35.000 is z={:.6f}\n"
CONFIG = "===== Config file =====\n[{}]\ny_offset = 25.0\nz_offset = {}\n=======================\n"


def approaches(tmp_path: Path, text: str) -> tuple[list[float], list[str]]:
    (tmp_path / "k.log").write_text(text)
    run = Run(tmp_path, "klipper", str(tmp_path / "k.log"))
    said: list[str] = run.said["assumed"]
    return run.campaign.touches.approach_mm.tolist(), said


def series(wording: str, z: float) -> str:
    return TEST + wording.format(z) * 2


@pytest.mark.parametrize("section", ["probe", "bltouch", "probe_eddy_current mine"])
def test_contact_with_the_bed_is_below_the_toolhead_by_the_offset(
    tmp_path: Path, section: str
) -> None:
    found, _ = approaches(tmp_path, CONFIG.format(section, 6.42) + series(OF_BED, 0.02))

    assert found == pytest.approx([10.0 - 6.42 - 0.02, 3.0])


def test_each_start_goes_by_its_own_configuration(tmp_path: Path) -> None:
    text = "".join(
        f"{CONFIG.format('probe', offset)}{series(OF_BED, 0.0)}" for offset in (6.42, 5.0)
    )

    found, _ = approaches(tmp_path, text)

    assert found == pytest.approx([3.58, 3.0, 5.0, 3.0])


@pytest.mark.parametrize(
    "config", ["", CONFIG.format("probe", 1.5) + CONFIG.format("bltouch", 2.5)]
)
def test_way_is_not_known_without_one_offset(tmp_path: Path, config: str) -> None:
    found, said = approaches(tmp_path, config + series(OF_BED, 0.0))

    assert found == pytest.approx([np.nan, 3.0], nan_ok=True)
    assert any("without the probe's z_offset, which klippy.log has: 1" in line for line in said)


def test_trigger_of_the_toolhead_has_no_offset(tmp_path: Path) -> None:
    found, said = approaches(tmp_path, CONFIG.format("probe", 6.42) + series(OF_TOOLHEAD, 6.5))

    assert found == pytest.approx([3.5, 3.0])
    assert not any("z_offset" in line for line in said)
