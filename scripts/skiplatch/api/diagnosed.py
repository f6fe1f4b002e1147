"""What a diagnosis says, read from its document: the same of one just made and one from a file."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from skiplatch.admitted import DRAWS
from skiplatch.arrays import FloatArray
from skiplatch.dataframes import DataFrame, Library, dataframe
from skiplatch.diagnosis import Diagnosis as Found
from skiplatch.diagnosis import as_json
from skiplatch.diagnosis.experiment import models_json, rivals
from skiplatch.diagnosis.reported.document import effects_of
from skiplatch.diagnosis.reported.samples import samples
from skiplatch.diagnosis.reported.schema import need_intervals, read_diagnosis_json, whole
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.simulator.effects import Effect, effects

NEEDED = (
    *("verdict", "gap"),
    *(f"effects.*.{name}" for name in ("stage", "confidence", "alternatives")),
    *(
        f"gap.*.{name}"
        for name in ("unit", "before", "after", "noise_floor", "shrink", "shrink_interval")
    ),
)
"""Keys of the document."""


@dataclass(frozen=True, slots=True)
class FoundEffect:
    """An effect that a diagnosis names.

    Attributes:
        effect: Its id, its parameters in their units, and since or until which touch it acts.
        stage: Where in the chain it acts.
        intervals: Of 90 %, by the name of the parameter.
        confidence: Share of such diagnoses that named the right one.
        alternatives: Ids of effects that the recorded columns do not tell from it.
    """

    effect: Effect
    stage: str
    intervals: Mapping[str, tuple[float, float]]
    confidence: float
    alternatives: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ObservableGap:
    """The gap of one observable on touches that the search did not see.

    Attributes:
        unit: ``µs`` or ``µm``.
        before: Mean CRPS of the nominal simulation, in the unit.
        after: The same with the effects.
        noise_floor: What the simulation with the effects scores on its own plays.
        reduction: Share of what lay above the noise floor that is gone, -1 to 1.
        interval: Of 95 %, of the reduction.
    """

    unit: str
    before: float
    after: float
    noise_floor: float
    reduction: float
    interval: tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """What a diagnosis says of a campaign.

    Attributes:
        verdict: ``no_gap``, ``explained``, ``partly_explained``, ``unknown`` or ``undecided``.
        effects: Those that it names.
        gaps: By the name of the observable.
        notes: What the campaign does not allow to say.
        document: All of it in plain types, format ``skiplatch-diagnosis/2``.
    """

    verdict: str
    effects: tuple[FoundEffect, ...]
    gaps: Mapping[str, ObservableGap]
    notes: tuple[str, ...]
    document: Mapping[str, Any]
    _named: Sequence[Named] | None = field(default=None, repr=False)

    @classmethod
    def of_document(cls, document: Mapping[str, Any]) -> Self:
        """Read what ``skiplatch diagnose --json`` wrote.

        Raises:
            ValueError: It is no diagnosis, or not whole.
        """
        read = whole(document, *NEEDED)
        need_intervals(read)
        return cls(
            verdict=str(read["verdict"]),
            effects=tuple(map(_found_effect, effects_of(read), read["effects"])),
            gaps={name: _gap(entry) for name, entry in read["gap"].items()},
            notes=tuple(read.get("notes", ())),
            document=read,
        )

    def samples(self, draws: int = 1000) -> dict[str, FloatArray]:
        """Draw the parameters of all effects together, as often as the touches bear them out.

        Every draw counts alike, as ArviZ takes them; the seed of the diagnosis picks them. They
        come from some hundred weighted points, so that one may come several times.

        Args:
            draws: How many.

        Returns:
            Arrays of shape (1, draws), for one chain, by ``effect.parameter``.

        Raises:
            TypeError: `draws` is no whole number.
            ValueError: `draws` is out of its range, or the diagnosis was read from a document,
                which has no samples.
        """
        DRAWS.checked("draws", draws)
        if self._named is None:
            raise ValueError("samples: a diagnosis from a document has none; call diagnose()")
        return samples(self._named, draws, self.document["seed"])

    def to_dataframe(self, library: Library | None = None) -> DataFrame:
        """Give a row for each parameter of each effect: value, interval of 90 %, confidence.

        Raises:
            ImportError: Neither pandas nor polars is installed, or not the one wanted.
        """
        rows = [
            (
                one.effect.id,
                one.stage,
                name,
                units(one)[name],
                value,
                *one.intervals[name],
                one.confidence,
            )
            for one in self.effects
            for name, value in one.effect.parameters.items()
        ]
        columns = zip(*rows, strict=True) if rows else ((),) * len(COLUMNS)
        return dataframe(dict(zip(COLUMNS, map(list, columns), strict=True)), library)


COLUMNS = ("effect", "stage", "parameter", "unit", "value", "low", "high", "confidence")


def units(found: FoundEffect) -> dict[str, str]:
    """Give the units of its parameters by their names."""
    return {parameter.name: parameter.unit for parameter in effects()[found.effect.id].parameters}


def document_of(found: Found, seed: int) -> dict[str, Any]:
    """Give a diagnosis in plain types, with what `design` and `settle` read of it."""
    return {**as_json(found), "seed": seed, "models": models_json(rivals(found))}


def read_diagnosis(path: str | os.PathLike[str]) -> Diagnosis:
    """Read the JSON of ``skiplatch diagnose``.

    Raises:
        InputError: It cannot be read, or is no diagnosis.
    """
    return read_diagnosis_json(Path(path), Diagnosis.of_document)


def _found_effect(effect: Effect, entry: Mapping[str, Any]) -> FoundEffect:
    return FoundEffect(
        effect=effect,
        stage=str(entry["stage"]),
        intervals={name: (ends[0], ends[1]) for name, ends in entry["intervals"].items()},
        confidence=float(entry["confidence"]),
        alternatives=tuple(entry["alternatives"]),
    )


def _gap(entry: Mapping[str, Any]) -> ObservableGap:
    low, high = entry["shrink_interval"]
    return ObservableGap(
        unit=str(entry["unit"]),
        before=float(entry["before"]),
        after=float(entry["after"]),
        noise_floor=float(entry["noise_floor"]),
        reduction=float(entry["shrink"]),
        interval=(float(low), float(high)),
    )
