"""Location errors through real touches: how often the truth lies within the uncertainties."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from rotary_machines import KINDS, Array, Line, Planted, names_of, plant, readings
from skiplatch.campaign import InputPath
from skiplatch.kinematics.firmware import Fit, fit
from skiplatch.kinematics.five_axis import DEFAULT_RIG, Probing, probe_points
from skiplatch.kinematics.machine import LETTERS
from skiplatch.kinematics.points import Points
from skiplatch.units import ARCSEC_PER_DEG, UM_PER_MM
from test_kinematics_five_axis import angles_of, believed, truth

MACHINES = 1000
POSITIONS = 24
WITHIN_3_SIGMA = 0.9973
STEP = 1e-3
"""Of the numerical slopes: mm, and degrees."""


def slopes(planted: Planted, angles_deg: Array, names: list[str]) -> Array:
    """Give the change of all readings by the sphere's place in mm, and by µm or arcsec of errors.

    Shape (3 n, 3 + errors), from whole machines shifted and tilted a little more.
    """

    def read(sphere_mm: Array, lines: dict[str, Line]) -> Array:
        return np.ravel(readings(planted.kind, lines, sphere_mm, planted.tip, angles_deg))

    start = read(planted.sphere, planted.actual)
    columns = [(read(planted.sphere + STEP * e, planted.actual) - start) / STEP for e in np.eye(3)]
    for name in names:
        line = planted.actual[name[-1]]
        if name in names_of(name[-1])[0]:
            moved = Line(line.point + STEP * np.eye(3)["XYZ".index(name[0])], line.direction)
            unit = UM_PER_MM
        else:
            turn = Rotation.from_rotvec(STEP * np.eye(3)[LETTERS.index(name[0])], degrees=True)
            moved = Line(line.point, turn.apply(line.direction))
            unit = ARCSEC_PER_DEG
        changed = read(planted.sphere, {**planted.actual, name[-1]: moved}) - start
        columns.append(changed / (STEP * unit))
    return np.stack(columns, axis=1)


def whitening(planted: Planted, angles_deg: Array, touches: int) -> Array:
    """Give what makes all coordinates of the centres scatter alike, shape (n, 3, 3)."""
    tool = np.tile([0.0, 0.0, 1.0], (len(angles_deg), 1))
    at = dict(zip(planted.kind.axes, angles_deg.T, strict=True))
    for letter in reversed(planted.kind.head):
        turns = np.radians(at[letter])[:, None] * planted.actual[letter].direction
        tool = Rotation.from_rotvec(turns).apply(tool)
    along = tool[:, :, None] * tool[:, None, :]
    return np.asarray(np.eye(3) + (np.sqrt(2.0 / touches) - 1.0) * along)


def distance(planted: Planted, angles_deg: Array, found: Fit, touches: int) -> float:
    """Give the statistic of F that all errors of a machine are off by, together."""
    names = list(found.parameters)
    white = whitening(planted, angles_deg, touches)
    columns = slopes(planted, angles_deg, names).reshape(len(white), 3, -1)
    design = np.einsum("nij,njk->nik", white, columns).reshape(3 * len(white), -1)
    information = np.linalg.inv(np.linalg.inv(design.T @ design)[3:, 3:])
    off = np.array([found.parameters[name].value - planted.errors[name] for name in names])
    return float(off @ information @ off / len(names) / (found.residual_um / UM_PER_MM) ** 2)


@pytest.mark.parametrize(
    ("path", "touches"),
    [
        (InputPath.SKIP, 4),
        pytest.param(InputPath.SKIP, 8, marks=pytest.mark.nightly),
        pytest.param(InputPath.PLC, 4, marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize("name", KINDS)
def test_planted_errors_come_back_from_touches(name: str, path: InputPath, touches: int) -> None:
    """Errors of ±0.5 mm and ±0.05°: each within 3 uncertainties, and all of a machine together."""
    rng = np.random.default_rng(7)
    offs, together = [], []
    for machine in range(MACHINES):
        planted = plant(KINDS[name], rng)
        angles_deg = angles_of(planted.kind, rng, POSITIONS)
        centre_mm = probe_points(
            believed(planted),
            truth(planted),
            angles_deg,
            seed=7,
            replicate=machine,
            probing=Probing(path=path, touches=touches),
            rig=replace(DEFAULT_RIG, probe=replace(DEFAULT_RIG.probe, lobe_um=0.0)),
        )
        angles_deg = angles_deg[:, [LETTERS.index(letter) for letter in planted.kind.axes]]
        found = fit(believed(planted), Points(angles_deg, centre_mm), touches=touches)
        assert found.parameters.keys() == planted.errors.keys()
        offs.append(
            [(e.value - planted.errors[x]) / e.uncertainty for x, e in found.parameters.items()]
        )
        limit = stats.f.ppf(WITHIN_3_SIGMA, len(planted.errors), found.freedom)
        together.append(distance(planted, angles_deg, found, touches) <= limit)

    # Of 1000, 2.7 are expected outside; more than 10 are with a chance of 1 in 5 000.
    assert np.min(np.mean(np.abs(offs) <= 3.0, axis=0)) >= 0.99
    assert np.mean(together) >= 0.99
    # Neither too narrow nor too wide, whichever error it is: uncertainties are 1.04 times widened
    # for 61 degrees of freedom, so that 0.976 is expected, give or take 0.022.
    assert np.std(offs, axis=0) == pytest.approx(np.full(len(offs[0]), 0.976), abs=0.09)
