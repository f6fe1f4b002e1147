"""All figures of the reference document together."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from skiplatch.latch.effort import Effort
from skiplatch.latch.reference_figures.cycles import (
    cycle_figures,
    polled_cycle,
    short_back_off,
    two_touch_figures,
    typical_back_off,
)
from skiplatch.latch.reference_figures.example import example_figures
from skiplatch.latch.reference_figures.model import ReferenceFigure, Remark
from skiplatch.latch.reference_figures.ranges import (
    Proportionality,
    proportionality,
    range_figures,
    slope_figure,
)
from skiplatch.tables import table, with_interval

LEGEND = "agrees: the document's rounding and three times the interval explain the difference"


@dataclass(frozen=True, slots=True)
class ReferenceFigures:
    """What the document prints, what it should be read with, and the fitted line."""

    figures: Sequence[ReferenceFigure]
    remarks: Sequence[Remark]
    proportionality: Proportionality

    @property
    def agree(self) -> bool:
        """Whether every figure of the document was found again."""
        return all(figure.agrees for figure in self.figures)


def play_figures(effort: Effort) -> ReferenceFigures:
    """Simulate all of them."""
    for_ranges, for_line, for_example, for_two, for_remarks = effort.split(5)
    ranges = range_figures(for_ranges)
    line = proportionality(for_line)
    return ReferenceFigures(
        figures=[
            *ranges,
            slope_figure(line),
            *example_figures(for_example.seed),
            *cycle_figures(),
            *two_touch_figures(ranges[0].simulated, for_two),
        ],
        remarks=[typical_back_off(), short_back_off(for_remarks), polled_cycle(for_remarks)],
        proportionality=line,
    )


def as_text(found: ReferenceFigures) -> str:
    """Everything, for the terminal."""
    all_notes = [*(f.note for f in found.figures), *(r.note for r in found.remarks)]
    notes = [note for note in dict.fromkeys(all_notes) if note]
    header = ("figure", "unit", "document", "simulated", "95 % interval", "difference", "")
    remarks_header = ("not in the document", "unit", "simulated", "95 % interval")
    return "\n\n".join(
        [
            table(header, [_figure_row(figure, notes) for figure in found.figures]),
            table(remarks_header, [_remark_row(remark, notes) for remark in found.remarks]),
            "\n".join([LEGEND, *(f"[{i}] {note}" for i, note in enumerate(notes, start=1))]),
        ]
    )


def as_json(found: ReferenceFigures) -> dict[str, Any]:
    """Everything, in plain types."""
    return {
        "agree": found.agree,
        "figures": [
            asdict(figure) | {"difference": figure.difference, "agrees": figure.agrees}
            for figure in found.figures
        ],
        "remarks": [asdict(remark) for remark in found.remarks],
        "proportionality": asdict(found.proportionality),
    }


def _figure_row(figure: ReferenceFigure, notes: Sequence[str]) -> tuple[str, ...]:
    return (
        _marked(figure.name, figure.note, notes),
        figure.unit,
        f"{figure.document:g}",
        *with_interval(figure.simulated),
        f"{figure.difference:+.1g}",
        "agrees" if figure.agrees else "DIFFERS",
    )


def _remark_row(remark: Remark, notes: Sequence[str]) -> tuple[str, ...]:
    name = _marked(remark.name, remark.note, notes)
    return (name, remark.unit, *with_interval(remark.simulated))


def _marked(name: str, note: str, notes: Sequence[str]) -> str:
    return f"{name} [{notes.index(note) + 1}]" if note else name
