"""A diagnosis in the units of its axes; the diagnosis itself and its JSON are in µm throughout."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.reported.diagnosis import Diagnosis
from skiplatch.diagnosis.reported.where import Place
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.ways import LENGTH, Ways

Sized = TypeVar("Sized", Place, Left)


def for_people(diagnosis: Diagnosis) -> Diagnosis:
    """Give the sizes of a diagnosis, and the names of what it observed, in those units."""
    ways = diagnosis.ways
    if ways is Ways.LINEAR:
        return diagnosis
    return replace(
        diagnosis,
        where=[_sized(place, diagnosis.ways_of(place.paths)) for place in diagnosis.where],
        left=[_sized(one, diagnosis.ways_of(one.path)) for one in diagnosis.left],
        gap={ways.observable_name(name): _gap(gap, ways) for name, gap in diagnosis.gap.items()},
    )


def datum_told(values: Mapping[str, float], ways: Ways) -> dict[str, float]:
    """Give what each datum is off by, by names that end in the unit.

    Args:
        values: In µm, by names that end so.
        ways: Of the campaign, for a datum of all axes.
    """
    told = {}
    for name, value in values.items():
        own = Ways.of_datum(name) or ways
        told[own.observable_name(name)] = own.told(value, LENGTH)[0]
    return told


def _sized(one: Sized, ways: Ways) -> Sized:
    size, unit = ways.told(one.size, one.unit)
    return replace(one, size=size, unit=unit)


def _gap(gap: Gap, ways: Ways) -> Gap:
    def told(size: float) -> float:
        return ways.told(size, gap.unit)[0]

    return replace(
        gap,
        unit=ways.told(0.0, gap.unit)[1],
        before=told(gap.before),
        after=told(gap.after),
        noise_floor=told(gap.noise_floor),
        could_hide=told(gap.could_hide),
        oracle=None if gap.oracle is None else told(gap.oracle),
    )
