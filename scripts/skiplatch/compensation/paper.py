"""The document's figures beside those of the experiment, and which of them are evidence."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from skiplatch.compensation import firmware
from skiplatch.compensation.experiment import Result
from skiplatch.tables import NOTHING, number, table
from skiplatch.units import US_PER_MS

PERCENT = 100.0
TOP_DEG = 80.0
MIDDLE_PERCENT = (2.5, 97.5)

SET = "set"
"""The simulation was given it, or something that it follows from."""
FOUND = "found"
"""It came out though nobody had put it in."""


NOTES = {
    "V_r before, at most": "V_r after and (v_max − v_min)·tau: a map is another one and what the "
    "feeds add, and a range is no more than the ranges of what it is a sum of",
    "W above the least radius, of the range": "(v_max − v_0)/(v_max − v_min); half for a cosine",
}
"""What there is to say of figures that follow from others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One figure.

    Attributes:
        name: What it is.
        unit: Its unit.
        paper: What the document prints; None for nothing.
        ours: What the experiment came to, in the mean of the trials.
        evidence: `SET` if the simulation was set up to give it, else `FOUND`.
        note: What else there is to say.
        low: 95 % of the trials lie between this
        high: and this; None of a single trial.
    """

    name: str
    unit: str
    paper: float | None
    ours: float
    evidence: str
    note: str = ""
    low: float | None = None
    high: float | None = None

    @property
    def difference(self) -> float | None:
        """Ours less the document's."""
        return None if self.paper is None else self.ours - self.paper


def figures(results: Sequence[Result]) -> list[Figure]:
    """Give all figures of a rig, from one or more trials of the whole experiment."""
    trials = [_of_trial(result) for result in results]
    return [_summary(same) for same in zip(*trials, strict=True)]


def _of_trial(result: Result) -> list[Figure]:
    return [*_delay(result), *_radii(result), *_feeds(result), *_errors(result)]


def _summary(trials: Sequence[Figure]) -> Figure:
    if len(trials) == 1:
        return trials[0]
    ours = [trial.ours for trial in trials]
    low, high = np.percentile(ours, MIDDLE_PERCENT)
    return replace(trials[0], ours=float(np.mean(ours)), low=float(low), high=float(high))


def _delay(result: Result) -> list[Figure]:
    simulated_ms = result.rig.nominal.probe.delay_us / US_PER_MS
    return [
        Figure(
            name="delay tau",
            unit="ms",
            paper=result.rig.reported.tau_ms,
            ours=result.tau.tau_ms,
            evidence=SET,
        ),
        Figure(
            name="its standard uncertainty, from the runs",
            unit="ms",
            paper=None,
            ours=result.tau.tau_uncertainty_ms,
            evidence=FOUND,
        ),
        Figure(
            name="its error",
            unit="%",
            paper=None,
            ours=PERCENT * result.tau_error,
            evidence=FOUND,
            note=f"{simulated_ms:g} ms were simulated; the latch's own way takes some µs more",
        ),
    ]


def _radii(result: Result) -> list[Figure]:
    reported, before, after = result.rig.reported, result.before, result.after
    rows = [
        ("V_r before, mean of the runs", reported.vr_before_um, before.vr_um, SET),
        ("V_r after, mean of the runs", reported.vr_after_um, after.vr_um, SET),
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
    width = reported.feed_max_mm_min - reported.feed_min_mm_min
    span_um = firmware.pretravel_um(0.0, width, reported.tau_ms)
    ours_um = firmware.pretravel_um(0.0, high - low, result.tau.tau_ms)
    rows = [
        ("slowest feed", "mm/min", reported.feed_min_mm_min, low),
        ("fastest feed", "mm/min", reported.feed_max_mm_min, high),
        ("(v_max − v_min)·tau", "µm", span_um, ours_um),
    ]
    low_share = (reported.feed_max_mm_min - result.rig.feed_mm_min) / width
    ours_share = (high - result.rig.feed_mm_min) / (high - low)
    rows += [
        ("V_r before, at most", "µm", reported.vr_after_um + span_um, result.after.vr_um + ours_um),
        ("W above the least radius, of the range", "", low_share, ours_share),
    ]
    increase = reported.time_increase
    return [
        *(
            Figure(
                name=name, unit=unit, paper=paper, ours=ours, evidence=SET, note=NOTES.get(name, "")
            )
            for name, unit, paper, ours in rows
        ),
        Figure(
            name="time increase",
            unit="%",
            paper=None if increase is None else increase * PERCENT,
            ours=result.time_increase * PERCENT,
            evidence=SET,
            note="follows from the lobes and from which directions the map has",
        ),
    ]


def _errors(result: Result) -> list[Figure]:
    return [
        Figure(
            name="V_r that random error alone leaves",
            unit="µm",
            paper=None,
            ours=result.floor_um,
            evidence=SET,
            note="a probe of even pretravel, as many touches; where V_r ends, if all else is gone",
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
            evidence=SET,
            note="ends at the random error, which was set",
        ),
        Figure(
            name="the same without random error",
            unit="",
            paper=None,
            ours=result.systematic_reduction,
            evidence=FOUND,
        ),
    ]


def as_text(results: Sequence[Result], rows: Sequence[Figure]) -> str:
    """Lay out the table, and below it what the simulation was given."""
    rig = results[0].rig
    header = ("figure", "unit", "document", "ours", "95 % of trials", "difference", "is")
    lines = [
        (
            row.name,
            row.unit,
            NOTHING if row.paper is None else number(row.paper),
            number(row.ours),
            _span(row),
            NOTHING if row.difference is None else f"{row.difference:+.2f}",
            row.evidence,
        )
        for row in rows
    ]
    trials = "" if len(results) == 1 else f", {len(results)} times over"
    return "\n".join(
        [
            f"{rig.title}: {rig.touches} touches through the firmware's latch{trials}",
            table(header, lines),
            "",
            *(f"  {row.name}: {row.note}" for row in rows if row.note),
            "",
            "What the simulation was given. A figure marked 'set' follows from it and is no",
            "evidence for the document; what is marked 'found' nobody had put in.",
            *(f"  {name}: {origin}" for name, origin in rig.origins.items()),
        ]
    )


def as_json(results: Sequence[Result], rows: Sequence[Figure]) -> dict[str, Any]:
    """Give the same as numbers; what stands outside of the list is of the first trial."""
    first = results[0]
    return {
        "title": first.rig.title,
        "touches": first.rig.touches,
        "trials": len(results),
        "tau_ms": first.tau.tau_ms,
        "tau_uncertainty_ms": first.tau.tau_uncertainty_ms,
        "tau_error": first.tau_error,
        "vr_before_um": first.before.vr_um,
        "vr_after_um": first.after.vr_um,
        "time_increase": first.time_increase,
        "figures": [{**asdict(row), "difference": row.difference} for row in rows],
        "origins": dict(first.rig.origins),
    }


def _span(row: Figure) -> str:
    if row.low is None or row.high is None:
        return NOTHING
    return f"{number(row.low)} … {number(row.high)}"
