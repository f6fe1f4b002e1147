"""How a stranger goes with its cause: the course over the cause, and what follows that course."""

from collections.abc import Callable, Mapping
from enum import StrEnum

import numpy as np

from tests.withheld.chain import FloatArray
from tests.withheld.forms import Draw
from tests.withheld.grammar_causes import Kind


class Carrier(StrEnum):
    """What of an error follows the course."""

    SHIFT = "shift"
    SCATTER = "scatter"
    """Its standard deviation."""
    NOW_AND_THEN = "now and then"
    """How often there is one."""


Course = Callable[[Draw, FloatArray], FloatArray]


def _straight(_: Draw, c: FloatArray) -> FloatArray:
    return c


def _threshold(d: Draw, c: FloatArray) -> FloatArray:
    return (c > np.quantile(c, d.between(0.2, 0.8))).astype(float)


def _saturating(d: Draw, c: FloatArray) -> FloatArray:
    return -np.expm1(-c / d.between(0.05, 0.35))


def _wave(d: Draw, c: FloatArray) -> FloatArray:
    return 0.5 + 0.5 * np.sin(2 * np.pi * d.between(0.8, 5.0) * c + d.angle())


def _power(d: Draw, c: FloatArray) -> FloatArray:
    return c ** d.pick(d.between(0.3, 0.6), d.between(1.7, 3.5))


def _hat(d: Draw, c: FloatArray) -> FloatArray:
    middle = np.quantile(c, d.between(0.2, 0.8))
    return np.asarray(np.exp(-(((c - middle) / d.between(0.08, 0.25)) ** 2)))


def _turning(d: Draw, c: FloatArray) -> FloatArray:
    order = int(d.pick(1, 1, 2, 3, 4, 5))
    return 0.5 + 0.5 * np.cos(2 * np.pi * order * c + d.angle())


def _sector(d: Draw, c: FloatArray) -> FloatArray:
    return ((c + d.between(0.0, 1.0)) % 1.0 < d.between(0.2, 0.6)).astype(float)


def _lobe(d: Draw, c: FloatArray) -> FloatArray:
    off = (c + d.between(0.0, 1.0)) % 1.0 - 0.5
    return np.asarray(np.exp(-((off / d.between(0.08, 0.25)) ** 2)))


def _level(_: Draw, c: FloatArray) -> FloatArray:
    return c


COURSES: Mapping[Kind, Mapping[str, Course]] = {
    Kind.SMOOTH: {
        "straight": _straight,
        "threshold": _threshold,
        "saturating": _saturating,
        "wave": _wave,
        "power": _power,
        "hat": _hat,
    },
    Kind.ANGLE: {"wave": _turning, "threshold": _sector, "hat": _lobe},
    Kind.LEVEL: {"level": _level},
}
"""By kind of cause; every course runs from 0 to about 1."""

INTERACTION = "interaction"


def draw_course(d: Draw, kind: Kind, values: FloatArray) -> tuple[str, FloatArray]:
    """Draw a course over a cause: its name, and what it comes to, shape (n,)."""
    courses = COURSES[kind]
    name = list(courses)[int(d.rng.integers(len(courses)))]
    falls = kind is Kind.SMOOTH and d.rng.random() < 0.3
    return name, courses[name](d, np.maximum(1.0 - values, 0.0) if falls else values)


def interaction(one: FloatArray, other: FloatArray) -> FloatArray:
    """Let two courses act together only: neither of them shows by itself; shape (n,)."""
    product = (one - one.mean()) * (other - other.mean())
    low, high = np.quantile(product, [0.02, 0.98])
    return np.asarray((product - low) / max(float(high - low), 1e-12))
