"""Three lobes of a map, wherever the artefact stood."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch.cli import group
from skiplatch.compensation.lobes import Lobes, three_lobes
from skiplatch.compensation.probe_map import read_map

LOBE_UM, CREST_DEG, NOISE_UM, RUNS = 7.0, 20.0, 0.3, 5


EVEN_DEG = tuple(np.arange(0.0, 360.0, 10.0).tolist())
UNEVEN_DEG = (*np.arange(0.0, 180.0, 10.0).tolist(), *np.arange(180.0, 360.0, 15.0).tolist())


def found(
    folder: Path,
    centre_um: tuple[float, float, float],
    datum_um: float,
    azimuths_deg: tuple[float, ...],
) -> Lobes:
    """Write a map with points moved as a whole, and fit its lobes."""
    rng = np.random.default_rng(4)
    lines = ["alpha_deg,beta_deg,run,radius_um"]
    for beta_deg in (0.0, 30.0, 60.0):
        for alpha_deg in azimuths_deg:
            alpha, beta = np.radians([alpha_deg, beta_deg])
            flat = np.cos(beta)
            towards = (flat * np.cos(alpha), flat * np.sin(alpha), np.sin(beta))
            lobes = LOBE_UM * flat * np.cos(3.0 * (alpha - np.radians(CREST_DEG)))
            for run in range(1, RUNS + 1):
                radius = datum_um + lobes + np.dot(centre_um, towards) + rng.normal(0.0, NOISE_UM)
                lines.append(f"{alpha_deg:g},{beta_deg:g},{run},{radius:.6f}")
    path = folder / "radii.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    lobes = three_lobes(read_map(path, outside=False))
    assert lobes is not None
    return lobes


@pytest.mark.parametrize("azimuths_deg", [EVEN_DEG, UNEVEN_DEG])
def test_an_artefact_off_centre_does_not_change_the_lobes(
    tmp_path: Path, azimuths_deg: tuple[float, ...]
) -> None:
    at_centre = found(tmp_path, (0.0, 0.0, 0.0), 0.0, azimuths_deg)
    off = found(tmp_path, (4.0, -3.0, 2.0), 11.0, azimuths_deg)

    assert off.amplitude_um == pytest.approx(at_centre.amplitude_um, abs=1e-4)
    assert off.low_um < LOBE_UM < off.high_um
    assert off.high_um - off.low_um < 0.6
    assert off.azimuth_deg == pytest.approx(CREST_DEG, abs=1.0)
    moved = np.subtract(off.off_centre_um, at_centre.off_centre_um)
    assert moved.tolist() == pytest.approx([4.0, -3.0, 2.0], abs=1e-4)


@pytest.mark.parametrize("x_um", [0.0, 5.0])
def test_radii_about_another_centre_are_warned_of(tmp_path: Path, x_um: float) -> None:
    """A table of them would make up for where the artefact stood, on every other artefact too."""
    found(tmp_path, (x_um, 0.0, 0.0), 20.0, EVEN_DEG)
    made = [str(tmp_path / name) for name in ("radii.csv", "table.csv")]
    arguments = ["compensate", made[0], "--v0", "100", "--tau", "12.68", "--out", made[1]]

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = CliRunner().invoke(group, arguments)

    assert result.exit_code == 0, result.output
    told = [re.search(r"off by X \+(\S+),.*the feeds make up", str(one.message)) for one in caught]
    off_um = [float(one[1]) for one in told if one]
    assert off_um == pytest.approx([x_um] if x_um else [], abs=0.1)
    assert len(told) == len(off_um)
