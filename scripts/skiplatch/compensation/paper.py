"""The document's figures beside those of the experiment, and which of them are evidence."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from skiplatch.compensation.experiment import Result
from skiplatch.tables import NOTHING, number, table

PERCENT = 100.0
US_PER_MS = 1000.0
MS_PER_MIN = 60_000.0
UM_PER_MM = 1000.0
TOP_DEG = 80.0

SET = "set"
FOUND = "found"
"""What the simulation was given, and what came out though nobody had put it in."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One figure.

    Attributes:
        name: What it is.
        unit: Its unit.
        paper: What the document prints; None for nothing.
        ours: What the experiment came to.
        evidence: `SET` if the simulation was set up to give it, else `FOUND`.
        note: What else there is to say.
    """

    name: str
    unit: str
    paper: float | None
    ours: float
    evidence: str
    note: str = ""

    @property
    def difference(self) -> float | None:
        """Ours less the document's."""
        return None if self.paper is None else self.ours - self.paper


def figures(result: Result) -> list[Figure]:
    """Give all figures of a rig."""
    return [*_delay(result), *_radii(result), *_feeds(result), *_errors(result)]


def _delay(result: Result) -> list[Figure]:
    set_ms = result.rig.nominal.probe.delay_us / US_PER_MS
    note = (
        f"± {result.tau.tau_uncertainty_ms:.3f} (1 sigma); "
        f"{set_ms:g} was simulated: off by {PERCENT * result.tau_error:+.2f} %"
    )
    return [
        Figure(
            name="delay tau",
            unit="ms",
            paper=result.rig.reported.tau_ms,
            ours=result.tau.tau_ms,
            evidence=SET,
            note=note,
        )
    ]


def _radii(result: Result) -> list[Figure]:
    reported, before, after = result.rig.reported, result.before, result.after
    rows = [
        ("V_r before, mean of the runs", reported.vr_before_um, before.vr_um, SET),
        ("V_r after, mean of the runs", reported.vr_after_um, after.vr_um, FOUND),
        ("V_r before, worst single run", reported.single_before_um, before.single_vr_um, SET),
        ("V_r after, worst single run", reported.single_after_um, after.single_vr_um, SET),
        ("V_r before, all touches", None, before.all_vr_um, SET),
        ("V_r after, all touches", None, after.all_vr_um, SET),
    ]
    if reported.vr_equator_um is not None:
        rows += [
            ("V_r before, β = 0°", reported.vr_equator_um, before.row_vr_um(0.0), SET),
            ("V_r before, β = 80°", reported.vr_top_um, before.row_vr_um(TOP_DEG), SET),
        ]
    return [
        Figure(name=name, unit="µm", paper=paper, ours=ours, evidence=evidence)
        for name, paper, ours, evidence in rows
    ]


def _feeds(result: Result) -> list[Figure]:
    reported = result.rig.reported
    low, high = float(result.after.feed_mm_min.min()), float(result.after.feed_mm_min.max())
    span = (reported.feed_max_mm_min - reported.feed_min_mm_min) * reported.tau_ms
    ours = (high - low) * result.tau.tau_ms
    rows = [
        ("slowest feed", "mm/min", reported.feed_min_mm_min, low),
        ("fastest feed", "mm/min", reported.feed_max_mm_min, high),
        ("(v_max − v_min)·tau", "µm", span * UM_PER_MM / MS_PER_MIN, ours * UM_PER_MM / MS_PER_MIN),
    ]
    increase = reported.time_increase
    return [
        *(
            Figure(name=name, unit=unit, paper=paper, ours=ours, evidence=SET)
            for name, unit, paper, ours in rows
        ),
        Figure(
            name="time increase",
            unit="%",
            paper=None if increase is None else increase * PERCENT,
            ours=result.time_increase * PERCENT,
            evidence=FOUND,
            note="depends on which directions the map has",
        ),
    ]


def _errors(result: Result) -> list[Figure]:
    return [
        Figure(
            name="V_r that random error alone leaves",
            unit="µm",
            paper=None,
            ours=result.floor_um,
            evidence=FOUND,
            note="a probe of even pretravel, as many touches",
        ),
        Figure(
            name="V_r before, without random error",
            unit="µm",
            paper=None,
            ours=result.systematic_before_um,
            evidence=SET,
        ),
        Figure(
            name="V_r after, without random error",
            unit="µm",
            paper=None,
            ours=result.systematic_after_um,
            evidence=FOUND,
            note="at the same feeds, which the random error of the map still shows in",
        ),
        Figure(
            name="V_r reduced by a factor of",
            unit="",
            paper=result.rig.reported.vr_before_um / result.rig.reported.vr_after_um,
            ours=result.reduction,
            evidence=FOUND,
        ),
        Figure(
            name="the same without random error",
            unit="",
            paper=None,
            ours=result.systematic_reduction,
            evidence=FOUND,
        ),
    ]


def as_text(result: Result, rows: Sequence[Figure]) -> str:
    """Lay out the table, and below it what the simulation was given."""
    header = ("figure", "unit", "document", "ours", "difference", "")
    lines = [
        (row.name, row.unit, _cell(row.paper), _cell(row.ours), _signed(row), row.evidence)
        for row in rows
    ]
    notes = [f"  {row.name}: {row.note}" for row in rows if row.note]
    origins = [f"  {name}: {origin}" for name, origin in result.rig.origins.items()]
    return "\n".join(
        [
            f"{result.rig.title}: {result.rig.touches} touches through the firmware's latch",
            table(header, lines),
            "",
            *notes,
            "",
            "What the simulation was given; a figure marked 'set' follows from it and is no",
            "evidence for the document:",
            *origins,
        ]
    )


def as_json(result: Result, rows: Sequence[Figure]) -> dict[str, Any]:
    """Give the same as numbers."""
    return {
        "title": result.rig.title,
        "touches": result.rig.touches,
        "tau_ms": result.tau.tau_ms,
        "tau_uncertainty_ms": result.tau.tau_uncertainty_ms,
        "tau_error": result.tau_error,
        "vr_before_um": result.before.vr_um,
        "vr_after_um": result.after.vr_um,
        "time_increase": result.time_increase,
        "figures": [{**asdict(row), "difference": row.difference} for row in rows],
        "origins": dict(result.rig.origins),
    }


def _cell(value: float | None) -> str:
    return NOTHING if value is None else number(value)


def _signed(row: Figure) -> str:
    return NOTHING if row.difference is None else f"{row.difference:+.2f}"
