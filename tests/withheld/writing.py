"""Writing a drawn campaign: what the diagnosis gets, and apart from it what it must not see."""

import io
import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from skiplatch.campaign import COLUMNS, CONDITIONS, Status, Touches, format_nominal
from skiplatch.campaign.touches import SerialArray
from skiplatch.campaign.writing import format_touches
from skiplatch.files import atomic_write_bytes, atomic_write_folder
from tests.withheld.cases import Drawn
from tests.withheld.chain import FloatArray
from tests.withheld.effects import EFFECTS
from tests.withheld.parts import OTHERS, Part

LAST_WRITTEN = "nominal_any_phase.npz"


def is_written(out: Path, name: str) -> bool:
    """Tell whether a campaign stands there in full; `write` begins anew what does not."""
    return (out / "sealed" / name / LAST_WRITTEN).exists()


def write(out: Path, name: str, drawn: Drawn) -> None:
    """Write OUT/campaigns/NAME and OUT/sealed/NAME."""
    for folder in ("campaigns", "sealed"):
        shutil.rmtree(out / folder / name, ignore_errors=True)
    played = _all_columns(drawn)
    kept, held_back = played.select(~drawn.held_back), played.select(drawn.held_back)
    atomic_write_folder(
        out / "campaigns" / name,
        {
            "nominal.toml": format_nominal(drawn.beliefs.nominal),
            "touches.csv": format_touches(_recorded(kept, drawn.dropped)),
            "conditions.csv": format_touches(_recorded(held_back, drawn.dropped), CONDITIONS),
        },
    )
    sealed = out / "sealed" / name
    label = json.dumps(_label(drawn), indent=1, ensure_ascii=False)
    truth = format_touches(held_back)
    true = format_nominal(drawn.setup.nominal)
    texts = {"label.json": label + "\n", "nominal.toml": true, "truth.csv": truth}
    atomic_write_folder(sealed, texts)
    sealed_plays = {
        "oracle.npz": drawn.oracle,
        "nominal.npz": drawn.nominal,
        "oracle_any_phase.npz": drawn.oracle_any_phase,
        LAST_WRITTEN: drawn.nominal_any_phase,
    }
    for file, plays in sealed_plays.items():
        rows = {key: values[:, drawn.held_back] for key, values in plays.items()}
        atomic_write_bytes(sealed / file, _npz({"touch": held_back.touch, **rows}))


def _all_columns(drawn: Drawn) -> Touches:
    outcomes = drawn.outcomes
    conditions = {key: getattr(drawn.setup.touches, key) for key in CONDITIONS}
    return Touches.from_columns(**{**conditions, **asdict(outcomes)})


def _recorded(touches: Touches, dropped: frozenset[str]) -> Touches:
    """Empty the columns that nobody recorded."""
    columns = {key: values for key, values in touches.columns().items() if key not in dropped}
    return Touches.from_columns(**columns)


def _npz(arrays: Mapping[str, FloatArray | SerialArray]) -> bytes:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()


def _note(part: Part) -> str:
    """Say in a line what a stranger or a dull variant is."""
    return OTHERS[part.id].note if part.id in OTHERS else part.id


def _label(drawn: Drawn) -> dict[str, object]:
    order = drawn.order
    effects = [part.id for part in drawn.parts if part.id in EFFECTS]
    return {
        "effects": effects,
        "verdict": order.verdict,
        "note": "; ".join(_note(part) for part in drawn.parts if part.id not in EFFECTS),
        "case": order.case,
        "recording": order.recording,
        "parts": [_part(part) for part in drawn.parts],
        "beliefs_off": drawn.beliefs.off_as_json(),
        "outliers": drawn.outliers.as_json(drawn.setup.touches.touch) if drawn.outliers else [],
        "not_recorded": [key for key in COLUMNS if key in drawn.dropped],
        "touches": len(drawn.held_back),
        "missed": int(np.count_nonzero(drawn.outcomes.status == Status.MISSED)),
        "scan_phase_us": drawn.setup.scan_phase_us,
    }


def _part(part: Part) -> dict[str, object]:
    return {
        "id": part.id,
        "form": part.form,
        "parameters": part.drawn.words,
        "size": round(part.size, 3),
        "visible": round(part.sizes.visible, 3),
        "missed": round(part.sizes.missed, 4),
        "off_grid_ticks": round(part.sizes.off_grid, 3),
        **part.facts,
        "sizes": [
            {
                "observable": size.observable,
                "path": size.path,
                "shift": round(size.shift, 3),
                "scatter": round(size.scatter, 3),
            }
            for size in part.sizes.sizes
        ],
    }
