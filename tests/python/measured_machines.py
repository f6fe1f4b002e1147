"""Machines of every type, measured as cycle 451 does, by whole rotation matrices.

Nothing here is the project's: places are turned about lines, and what is left is told the same way.
"""

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from rotary_machines import OWN, Array, Kind, Line, Planted, plant, readings
from skiplatch.kinematics.machine import Machine, RotaryAxis, Vector
from skiplatch.kinematics.stations import Stations

TRAVEL_DEG = (-180.0, 180.0)
PAIRS = ["".join(pair) for pair in permutations("ABC", 2)]
ALL_KINDS = (
    [Kind(letter, "") for letter in "ABC"]
    + [Kind("", letter) for letter in "ABC"]
    + [Kind(pair, "") for pair in PAIRS]
    + [Kind("", pair) for pair in PAIRS]
    + [Kind(pair[0], pair[1]) for pair in PAIRS]
)


def name_of(kind: Kind) -> str:
    return f"table {kind.table or '-'} head {kind.head or '-'}"


def draw(kind: Kind, rng: np.random.Generator) -> Planted:
    """Plant a machine; half of them have the tip, or the sphere, on the line of an axis."""
    planted = plant(kind, rng)
    on_line = kind.axes[int(rng.integers(len(kind.axes)))]
    if rng.random() < 0.5:
        line = planted.believed[on_line]
        place = planted.tip if on_line in kind.head else planted.sphere
        along = line.direction @ place
        place[:] = line.point + (along - line.direction @ line.point) * line.direction
    return planted


def described(planted: Planted) -> Machine:
    """Give what the control believes."""

    def three(values: Array) -> Vector:
        x, y, z = map(float, values)
        return x, y, z

    axes = tuple(
        RotaryAxis(
            letter,
            letter in planted.kind.head,
            three(planted.believed[letter].direction),
            three(planted.believed[letter].point),
            TRAVEL_DEG,
        )
        for letter in planted.kind.axes
    )
    return Machine(axes, three(planted.tip) if planted.kind.head else None)


def lines_of(machine: Machine) -> dict[str, Line]:
    return {a.letter: Line(np.array(a.point_mm), np.array(a.direction)) for a in machine.axes}


def planned(kind: Kind, rng: np.random.Generator) -> tuple[Array, Array]:
    """Give angles of the kind's axes, shape (n, axes), and which axis each is of; 0 comes first."""
    tilted = 0.0 if rng.random() < 0.5 else 30.0
    rows, owners = [], []
    for place, letter in enumerate(kind.axes):
        ends = (-150.0, 180.0) if letter == "C" else (-80.0, 85.0)
        for angle in [0.0, *np.linspace(*ends, int(rng.integers(4, 9)))]:
            row = np.full(len(kind.axes), tilted)
            row[place] = angle
            rows.append(row)
            owners.append(place)
    return np.array(rows), np.array(owners)


def stations_of(planted: Planted, rng: np.random.Generator, noise_mm: float) -> Stations:
    """Measure a machine, each axis from its own reference at 0."""
    kind = planted.kind
    angles_deg, owners = planned(kind, rng)
    read = readings(kind, planted.actual, planted.sphere, planted.tip, angles_deg)
    shown = np.zeros((len(read), 3))
    shown[:, [OWN[letter] for letter in kind.axes]] = angles_deg
    axis = np.array([OWN[kind.axes[i]] for i in owners])
    starts = np.r_[True, owners[1:] != owners[:-1]]
    return Stations(
        shown,
        read + rng.normal(0.0, noise_mm, read.shape),
        np.full(len(read), 12.5),
        axis,
        1 << axis,
        np.zeros(len(read), dtype=np.int64),
        starts,
        np.zeros(len(read), dtype=bool),
    )


def left_mm(
    kind: Kind, tip_mm: Sequence[float], machine: Machine, stations: Stations
) -> dict[str, float]:
    """Tell what a description leaves: root mean square in space against each axis's reference."""
    lines = lines_of(machine)
    datum_deg = np.array([axis.datum_deg for axis in machine.axes])
    shown = stations.angle_deg[:, [OWN[letter] for letter in kind.axes]] + datum_deg
    left = {}
    for letter in kind.axes:
        own = stations.axis == OWN[letter]
        angles_deg, centres_mm = shown[own], stations.centre_mm[own]

        def read_from(sphere_mm: Array, at_deg: Array = angles_deg) -> Array:
            return readings(kind, lines, sphere_mm, np.array(tip_mm), at_deg)

        origin = read_from(np.zeros(3))
        images = np.stack([read_from(e)[0] - origin[0] for e in np.eye(3)], axis=1)
        sphere_mm = np.linalg.solve(images, centres_mm[0] - origin[0])
        off = (centres_mm - read_from(sphere_mm))[1:]
        left[letter] = float(np.sqrt(np.mean(np.sum(off**2, axis=1))))
    return left
