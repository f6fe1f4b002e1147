"""What the engineer believes of the rig: nominal.toml in memory, and the table of its keys."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, get_type_hints

from skiplatch.campaign.constraints import ANY_NUMBER, NOT_NEGATIVE, POSITIVE, Range

FORMAT = "skiplatch-campaign/1"


class Kind(StrEnum):
    """How a campaign was recorded."""

    BENCH = "bench"
    """Edges injected at the connector at known times; no probe mechanics."""
    MACHINE = "machine"
    """A probe touches a surface; nobody knows the true edge time."""


@dataclass(frozen=True, slots=True)
class Key:
    """What may stand for a number of nominal.toml.

    Attributes:
        unit: The unit of the number.
        constraint: Which numbers are admitted.
        meaning: One line for the documentation.
    """

    unit: str
    constraint: Range
    meaning: str


def _key(unit: str, constraint: Range, meaning: str) -> dict[str, Key]:
    return {"key": Key(unit, constraint, meaning)}


@dataclass(frozen=True, slots=True)
class ProbeNominal:
    """The probe: pretravel w = pretravel + lobe·cos β·cos 3(α − phase) + N(0, repeatability)."""

    pretravel_um: float = field(metadata=_key("µm", NOT_NEGATIVE, "calibrated mean pretravel"))
    lobe_um: float = field(metadata=_key("µm", ANY_NUMBER, "amplitude of its three lobes"))
    lobe_phase_deg: float = field(metadata=_key("deg", ANY_NUMBER, "azimuth of a lobe"))
    repeatability_um: float = field(metadata=_key("µm", NOT_NEGATIVE, "its scatter, 1 sigma"))
    delay_us: float = field(
        metadata=_key("µs", NOT_NEGATIVE, "delay of transducer and transmission")
    )


@dataclass(frozen=True, slots=True)
class InputNominal:
    """The input filter, on both paths."""

    filter_us: float = field(metadata=_key("µs", NOT_NEGATIVE, "delay of the input filter"))


@dataclass(frozen=True, slots=True)
class SkipNominal:
    """The skip input: edge to latch is latency + U(0, jitter)."""

    latency_us: float = field(metadata=_key("µs", NOT_NEGATIVE, "least time from edge to latch"))
    jitter_us: float = field(metadata=_key("µs", NOT_NEGATIVE, "span of what is added to it"))
    tick_us: float = field(metadata=_key("µs", POSITIVE, "timer tick of latch_us, both paths"))


@dataclass(frozen=True, slots=True)
class PlcNominal:
    """The PLC task that polls."""

    scan_us: float = field(metadata=_key("µs", POSITIVE, "scan period"))


@dataclass(frozen=True, slots=True)
class AxisNominal:
    """The axis; it starts each measuring move from rest."""

    resolution_um: float = field(metadata=_key("µm", POSITIVE, "position resolution"))
    accel_mm_s2: float = field(metadata=_key("mm/s²", POSITIVE, "acceleration"))


@dataclass(frozen=True, slots=True)
class ReportNominal:
    """The report: latch to arrival is latency + U(0, jitter)."""

    latency_us: float = field(metadata=_key("µs", NOT_NEGATIVE, "least time from latch to arrival"))
    jitter_us: float = field(metadata=_key("µs", NOT_NEGATIVE, "span of what is added to it"))


@dataclass(frozen=True, slots=True)
class BenchNominal:
    """The reference instrument of a bench."""

    reference_jitter_us: float = field(
        metadata=_key("µs", NOT_NEGATIVE, "noise of edge_us, 1 sigma")
    )


@dataclass(frozen=True, slots=True)
class Nominal:
    """All of nominal.toml."""

    kind: Kind
    probe: ProbeNominal
    input: InputNominal
    skip: SkipNominal
    plc: PlcNominal
    axis: AxisNominal
    report: ReportNominal
    bench: BenchNominal


SECTIONS: Mapping[str, type[Any]] = {
    name: hint for name, hint in get_type_hints(Nominal).items() if hint is not Kind
}

# By section and key, in the order in which they are written.
KEYS: Mapping[tuple[str, str], Key] = {
    (section, key.name): key.metadata["key"]
    for section, values in SECTIONS.items()
    for key in fields(values)
}
