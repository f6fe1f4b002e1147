"""``skiplatch import``: the scatter of a probe by touches in a row, where a preset only guesses."""

from pathlib import Path

import numpy as np
import pytest

from skiplatch.importing.presets import PRESETS
from test_import_logs import Run

GUESSED_UM = PRESETS["klipper"].figures["probe", "repeatability_um"].value
STEP_UM = 2.5
SERIES = """\
[stepper_z]
full_steps_per_rotation = 200
PROBE_ACCURACY at X:10.000 Y:10.000 Z:5.000 (samples={n} retract=2.000 speed=5.0 lift_speed=10.0)
"""


def klipper(folder: Path, sigma_um: float, *words: str, drift_um: float = 0.0, n: int = 60) -> Run:
    """Import touches that scatter, and drift from one to the next, rounded to steps."""
    off_um = np.random.default_rng(1).normal(0.0, sigma_um, n) + drift_um * np.arange(n)
    places_mm = 1.0 + np.rint(off_um / STEP_UM) * STEP_UM / 1000.0
    lines = [f"probe at 10.000,10.000 is z={place:.6f}\n" for place in places_mm]
    (folder / "k.log").write_text(SERIES.format(n=n) + "".join(lines))
    return Run(folder, "klipper", str(folder / "k.log"), *words)


@pytest.mark.parametrize("drift_um", [0.0, 1.0])
def test_a_scatter_that_touches_in_a_row_show_takes_the_place_of_a_guess(
    tmp_path: Path, drift_um: float
) -> None:
    """A drift is none of it: it moves one touch from the next by little."""
    run = klipper(tmp_path, 1.5, drift_um=drift_um)
    nominal = run.campaign.nominal

    assert nominal.probe.repeatability_um == pytest.approx(1.5, abs=0.4)
    assert 0.05 < nominal.uncertainty["probe", "repeatability_um"] < 0.4
    assert "by how touches of one surface in a row differ" in run.toml


def test_a_larger_scatter_is_left_for_the_diagnosis_to_see(tmp_path: Path) -> None:
    nominal = klipper(tmp_path, 9.0).campaign.nominal

    assert nominal.probe.repeatability_um == GUESSED_UM


def test_few_touches_tell_no_scatter(tmp_path: Path) -> None:
    nominal = klipper(tmp_path, 1.5, n=4).campaign.nominal

    assert nominal.probe.repeatability_um == GUESSED_UM


def test_scans_of_a_plc_are_no_scatter_of_a_probe(tmp_path: Path) -> None:
    nominal = klipper(tmp_path, 1.5, "--path", "plc").campaign.nominal

    assert nominal.probe.repeatability_um == GUESSED_UM
