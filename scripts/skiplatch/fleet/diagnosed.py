"""What a store keeps of a diagnosis: a campaign's gap, and the effects that were named.

Gaps are in the units of the campaign's axes, which the document of a diagnosis has not.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from skiplatch.campaign import Touches, fingerprint, read_campaign
from skiplatch.diagnosis.reported.belonging import is_of
from skiplatch.diagnosis.reported.schema import need_intervals, read_diagnosis_json, whole
from skiplatch.ways import LENGTH, Ways

DIAGNOSIS_FILE = "diagnosis.json"
NEEDED = (
    *("verdict", "where.*.stage", "effects.*.stage", "effects.*.confidence"),
    *(f"gap.*.{name}" for name in ("unit", "before", "after", "noise_floor")),
)
"""Keys of the document."""


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """Figures of a diagnosis; None where there is none.

    Attributes:
        verdict: As the diagnosis has it.
        seed: Of the diagnosis, where that says it.
        gap_um: The largest gap of any observable in µm; None where all axes turn.
        gap_arcsec: And there in arcsec.
        stage: Where the first effect acts; without effects where the first difference shows.
        gaps: A mapping for each observable: observable, unit, before, after, noise_floor.
        effects: A mapping for each parameter: effect, stage, confidence, parameter, value, low,
            high.
    """

    verdict: str | None = None
    seed: int | None = None
    gap_um: float | None = None
    gap_arcsec: float | None = None
    stage: str | None = None
    gaps: list[dict[str, Any]] = field(default_factory=list)
    effects: list[dict[str, Any]] = field(default_factory=list)


def diagnosed(folder: Path, touches: Touches) -> Diagnosed:
    """Read the diagnosis that lies in a campaign's folder, if one does.

    Args:
        folder: Of the campaign.
        touches: Which lie there.

    Raises:
        InputError: It is no whole diagnosis, or one of other touches.
    """
    path = folder / DIAGNOSIS_FILE
    if not path.exists():
        return Diagnosed()
    return read_diagnosis_json(path, lambda document: _figures(document, touches))


def is_diagnosed(folder: Path) -> bool:
    """Tell whether a diagnosis lies in a campaign's folder that is not of other touches.

    Raises:
        InputError: It or the campaign cannot be read.
    """
    path = folder / DIAGNOSIS_FILE
    if not path.exists():
        return False
    known_as = fingerprint(read_campaign(folder).touches)
    return is_of(read_diagnosis_json(path, whole), known_as)


def _figures(given: Any, touches: Touches) -> Diagnosed:  # noqa: ANN401 - JSON is anything
    document, ways = whole(given, *NEEDED), Ways.of(touches)
    need_intervals(document)
    if not is_of(document, fingerprint(touches)):
        raise ValueError("a diagnosis of other touches than those that lie beside it")
    gaps = [_gap(str(name), gap, ways) for name, gap in document["gap"].items()]
    _, length = ways.told(0.0, LENGTH)
    largest = max((gap["before"] for gap in gaps if gap["unit"] == length), default=None)
    stages = [str(entry["stage"]) for entry in (*document["effects"], *document["where"])]
    return Diagnosed(
        verdict=str(document["verdict"]),
        seed=document.get("seed"),
        gap_um=None if ways is Ways.ROTARY else largest,
        gap_arcsec=largest if ways is Ways.ROTARY else None,
        stage=stages[0] if stages else None,
        gaps=gaps,
        effects=[row for entry in document["effects"] for row in _parameters(entry)],
    )


def _gap(name: str, gap: dict[str, Any], ways: Ways) -> dict[str, Any]:
    unit = str(gap["unit"])
    sizes = {key: ways.told(float(gap[key]), unit)[0] for key in ("before", "after", "noise_floor")}
    return {"observable": ways.observable_name(name), "unit": ways.told(0.0, unit)[1], **sizes}


def _parameters(entry: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        {
            "effect": str(entry["id"]),
            "stage": str(entry["stage"]),
            "confidence": float(entry["confidence"]),
            "parameter": str(name),
            "value": float(value),
            "low": float(entry["intervals"][name][0]),
            "high": float(entry["intervals"][name][1]),
        }
        for name, value in entry["params"].items()
    ]
