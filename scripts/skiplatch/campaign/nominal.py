"""What the engineer believes of the rig: nominal.toml in memory, and the table of its keys."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from math import inf
from typing import Any

from skiplatch.campaign.believed_effect import BelievedEffect
from skiplatch.campaign.constraints import (
    ANGLE,
    LENGTH_UM,
    NOT_NEGATIVE,
    PLACE_MM,
    POSITIVE,
    SIZE_UM,
    STEP_UM,
    TEMPERATURE,
    Range,
)
from skiplatch.campaign.datum import Datum
from skiplatch.campaign.kind import Kind

FORMATS: Mapping[int, str] = {1: "skiplatch-campaign/1", 2: "skiplatch-campaign/2"}


@dataclass(frozen=True, slots=True)
class Key:
    """What may stand for a number of nominal.toml.

    Attributes:
        unit: The unit of the number.
        constraint: Which numbers are admitted.
        default: What is taken where it is left out; infinite where there is then no limit.
        meaning: One line for the documentation.
        lost: What cannot be told where it is left out.
        since: Version of the format that has it first.
    """

    unit: str
    constraint: Range
    default: float
    meaning: str
    lost: str
    since: int = 1


def _key(
    unit: str, constraint: Range, default: float, meaning: str, lost: str, since: int = 1
) -> Any:  # noqa: ANN401
    key = Key(unit, constraint, default, meaning, lost, since)
    return field(default=default, metadata={"key": key})


@dataclass(frozen=True, slots=True)
class ProbeNominal:
    """The probe: pretravel w = pretravel + lobe·cos β·cos 3(α − phase) + N(0, repeatability)."""

    pretravel_um: float = _key(
        "µm",
        LENGTH_UM,
        0.0,
        "calibrated mean pretravel",
        "the pretravel from the place of the surface",
    )
    lobe_um: float = _key(
        "µm",
        LENGTH_UM,
        0.0,
        "amplitude of its three lobes",
        "a lobe that is calibrated from one that is not",
    )
    lobe_phase_deg: float = _key(
        "deg", ANGLE, 0.0, "azimuth of a lobe", "where the calibrated lobes lie"
    )
    repeatability_um: float = _key(
        "µm", SIZE_UM, 0.0, "its scatter, 1 sigma", "the probe's own scatter from any other"
    )
    delay_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "delay of transducer and transmission",
        "a delay that is known from one that is not",
    )
    calibrated_at_c: float = _key(
        "°C",
        TEMPERATURE,
        20.0,
        "temperature at the calibration",
        "growth since the calibration from the calibration itself",
        since=2,
    )


@dataclass(frozen=True, slots=True)
class InputNominal:
    """The input filter, on both paths."""

    filter_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "delay of the input filter",
        "the filter's delay from any other",
    )


@dataclass(frozen=True, slots=True)
class SkipNominal:
    """The skip input: edge to latch is latency + U(0, jitter)."""

    latency_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "least time from edge to latch",
        "the latency that is meant from one that is not",
    )
    jitter_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "span of what is added to it",
        "the jitter that is meant from one that is not",
    )
    tick_us: float = _key(
        "µs",
        POSITIVE,
        0.001,
        "timer tick of latch_us, both paths",
        "rounding of the stamps from their scatter",
    )


@dataclass(frozen=True, slots=True)
class PlcNominal:
    """The PLC task that polls."""

    scan_us: float = _key(
        "µs", POSITIVE, 1000.0, "scan period", "whether the scans come as often as is meant"
    )


@dataclass(frozen=True, slots=True)
class AxisNominal:
    """The axis; it starts each measuring move from rest."""

    resolution_um: float = _key(
        "µm",
        STEP_UM,
        0.001,
        "position resolution",
        "rounding of the positions from their scatter",
    )
    accel_mm_s2: float = _key(
        "mm/s²",
        POSITIVE,
        1000.0,
        "acceleration",
        "whether a short approach reaches its feed, and when the surface is met",
    )
    min_mm: float = _key(
        "mm",
        PLACE_MM,
        -inf,
        "least coordinate that can be reached",
        "whether a touch that is proposed can be made",
        since=2,
    )
    max_mm: float = _key(
        "mm",
        PLACE_MM,
        inf,
        "greatest coordinate that can be reached",
        "whether a touch that is proposed can be made",
        since=2,
    )


@dataclass(frozen=True, slots=True)
class ReportNominal:
    """The report: latch to arrival is latency + U(0, jitter)."""

    latency_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "least time from latch to arrival",
        "the delay of reports that is meant from one that is not",
    )
    jitter_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "span of what is added to it",
        "the jitter of reports that is meant from one that is not",
    )


@dataclass(frozen=True, slots=True)
class BenchNominal:
    """The reference instrument of a bench."""

    reference_jitter_us: float = _key(
        "µs",
        NOT_NEGATIVE,
        0.0,
        "noise of edge_us, 1 sigma",
        "noise of the reference from jitter of the latch",
    )


_OF_THE_KIND = Datum.of_kind(Kind.BENCH)  # this very object stands for what the kind says


@dataclass(frozen=True, slots=True)
class Nominal:
    """All of nominal.toml; ``skiplatch columns --nominal`` prints its keys.

    Attributes:
        kind, probe, input, skip, plc, axis, report, bench: ``bench`` or ``machine``; the sections.
        uncertainty: Standard uncertainty of those keys that are given with one.
        unknown: Keys that stand at their default because the file leaves them out.
        datum: How the place of the surface is unknown; by the kind where nothing is said of it.
        believed_effects: What the chain is believed to do beside its sections.
        version: Of the format. In version 1 no pretravel is below 0.
        arrival_us: What stamps are moved back by that are arrivals of reports; see `with_arrivals`.
        counts_coordinate: Positions are counts of the coordinate; see `with_lines`.
    """

    kind: Kind
    probe: ProbeNominal
    input: InputNominal
    skip: SkipNominal
    plc: PlcNominal
    axis: AxisNominal
    report: ReportNominal
    bench: BenchNominal
    uncertainty: Mapping[tuple[str, str], float] = field(default_factory=dict, hash=False)
    unknown: frozenset[tuple[str, str]] = frozenset()
    datum: Datum = _OF_THE_KIND
    believed_effects: tuple[BelievedEffect, ...] = ()
    version: int = 1
    arrival_us: float | None = None
    counts_coordinate: bool = False

    def __post_init__(self) -> None:
        if self.datum is _OF_THE_KIND:
            object.__setattr__(self, "datum", Datum.of_kind(self.kind))
        if self._needs_version_2():
            object.__setattr__(self, "version", 2)

    def number(self, section: str, name: str) -> float:
        """Give the number of a key."""
        return float(getattr(getattr(self, section), name))

    def _needs_version_2(self) -> bool:
        return bool(
            self.uncertainty
            or self.unknown
            or self.believed_effects
            or self.datum != Datum.of_kind(self.kind)
            or self.probe.pretravel_um < 0.0
            or any(k.since > 1 and self.number(*at) != k.default for at, k in KEYS.items())
        )


SECTIONS: Mapping[str, type[Any]] = {
    "probe": ProbeNominal,
    "input": InputNominal,
    "skip": SkipNominal,
    "plc": PlcNominal,
    "axis": AxisNominal,
    "report": ReportNominal,
    "bench": BenchNominal,
}

# By section and key, in the order in which they are written.
KEYS: Mapping[tuple[str, str], Key] = {
    (section, key.name): key.metadata["key"]
    for section, values in SECTIONS.items()
    for key in fields(values)
}


def in_version(nominal: Nominal, version: int) -> Nominal:
    """Give the same belief in at least that version of the format."""
    return replace(nominal, version=max(nominal.version, version))
