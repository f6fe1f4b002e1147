"""Which touches of a log are taken for those of one surface, where the log does not say it."""

from pathlib import Path

import numpy as np

from test_import_logs import Run

LINUXCNC = Path(__file__).parent / "data" / "linuxcnc"


def test_touches_that_lie_anywhere_share_no_surface(tmp_path: Path) -> None:
    """Neighbours within half a millimetre are so by chance, and what they differ by is no gap."""
    folder = LINUXCNC / "nothing"

    run = Run(
        tmp_path, "linuxcnc", str(folder / "probe.log"), "--program", str(folder / "program.ngc")
    )

    assert np.isnan(run.campaign.touches.deviation_um).all()
    assert "140 touches of 140 surfaces" in run.said["known"]
    moved = [line for line in run.said["assumed"] if line.startswith("met ")]
    assert len(moved) == 2
    assert all("it moved, or nothing tells these places apart" in line for line in moved)


def test_faces_that_are_many_stay_surfaces(tmp_path: Path) -> None:
    faces = np.repeat(np.arange(20) * 3.0, 3)
    z_mm = faces + np.random.default_rng(1).normal(0.0, 0.02, len(faces))
    lines = [f"1.0 1.0 {z:.6f} 0.0 0.0 0.0 0.0 0.0 0.0\n" for z in z_mm]
    (tmp_path / "probe.txt").write_text("".join(lines))

    run = Run(tmp_path, "linuxcnc", str(tmp_path / "probe.txt"), "--axis", "z", "--units", "mm")

    assert "60 touches of 20 surfaces" in run.said["known"]
