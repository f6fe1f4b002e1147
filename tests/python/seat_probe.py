"""A touch-trigger probe on paper, for tests of compensation: its radii, and files of them.

The transducer's pretravel of a three-contact seat, as in the digest of the document; written here
a second time so that nothing of the product confirms itself.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray


@dataclass(frozen=True)
class Seat:
    """Parameters of the seat: spring in N, lever d/L, stiffnesses in µm/N, and friction c."""

    spring_n: float
    lever: float
    bending_um_n: float
    axial_um_n: float
    friction: float

    def pretravel_um(self, alpha_deg: FloatArray, beta_deg: FloatArray) -> FloatArray:
        """Give w_T of n directions, shape (n,)."""
        psi = np.radians((alpha_deg + 60.0) % 120.0 - 60.0)
        beta, c = np.radians(beta_deg), self.friction
        arm = np.cos(beta) * ((1.0 - c) * np.cos(psi) + 0.827 * c) + self.lever * np.sin(beta)
        force_n = self.spring_n * self.lever / arm
        give = self.bending_um_n * np.cos(beta) ** 2 + self.axial_um_n * np.sin(beta) ** 2
        return np.asarray(force_n * give)


OMP40 = Seat(5.85, 0.0855, 20.67, 2.17, 0.121)
HAAS = Seat(5.85, 0.0427, 88.4, 0.05 * 88.4, 0.15)

RINGS = np.arange(0.0, 90.0, 10.0)
AZIMUTHS = np.arange(0.0, 360.0, 30.0)


def directions() -> tuple[FloatArray, FloatArray]:
    """109 of them: twelve azimuths at β from 0° to 80°, and the pole."""
    beta, alpha = (grid.ravel() for grid in np.meshgrid(RINGS, AZIMUTHS, indexing="ij"))
    return np.append(alpha, 0.0), np.append(beta, 90.0)


def radii(
    seat: Seat,
    feed_mm_min: float | FloatArray,
    tau_ms: float,
    *,
    runs: int,
    sigma_um: float,
    seed: int = 1,
) -> FloatArray:
    """Measure a map; shape (109, runs)."""
    systematic_um = seat.pretravel_um(*directions()) + feed_mm_min * tau_ms / 60.0
    noise_um = np.random.default_rng(seed).normal(0.0, sigma_um, (len(systematic_um), runs))
    return np.asarray(systematic_um[:, None] + noise_um)


def write_radii(path: Path, radius_um: FloatArray) -> Path:
    """Write RADII.csv of a map, shape (109, runs)."""
    lines = ["alpha_deg,beta_deg,run,radius_um"]
    for alpha, beta, repeats in zip(*directions(), radius_um, strict=True):
        lines += [f"{alpha:g},{beta:g},{run},{r:.6f}" for run, r in enumerate(repeats, 1)]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_speeds(
    path: Path, tau_ms: float, *, outside: bool = False, sigma_um: float = 0.0, seed: int = 2
) -> Path:
    """Write SPEEDS.csv of a 52 mm ring or sphere: 5 runs each at 50, 100 and 150 mm/min."""
    random = np.random.default_rng(seed)
    sign = -1.0 if outside else 1.0
    lines = ["feed_mm_min,run,mean_radius_um"]
    for feed in (50.0, 100.0, 150.0):
        for run in range(1, 6):
            radius_um = (
                23_000.0 + sign * (8.0 + feed * tau_ms / 60.0) + random.normal(0.0, sigma_um)
            )
            lines.append(f"{feed:g},{run},{radius_um:.6f}")
    path.write_text("\n".join(lines) + "\n")
    return path
