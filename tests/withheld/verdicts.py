"""A line of JSON for each campaign, so that two versions of the diagnosis can be held together."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from tests.withheld.scoring import Scored


def as_lines(results: Sequence[Scored]) -> str:
    """Give a line for each campaign, in the order of their names."""
    ordered = sorted(results, key=lambda scored: scored.name)
    return "".join(json.dumps(line(scored), ensure_ascii=False) + "\n" for scored in ordered)


def line(scored: Scored) -> dict[str, Any]:
    """Sum a campaign up: what it has, what was said of it."""
    sure = [name.confidence for name in scored.found.names]
    seed, _, campaign = scored.name.partition("/")
    return {
        "seed": int(seed or 0),
        "campaign": campaign,
        "case": scored.label.case,
        "recording": scored.label.recording,
        "label": list(scored.label.parts),
        "wanted": scored.label.verdict,
        "verdict": scored.found.verdict,
        "names": {name.id: sorted(name.group - {name.id}) for name in scored.found.names},
        "confidence": max(sure, default=None),
        "right": scored.is_right,
        "wrong_names": sorted(name.id for name in scored.wrong_names),
        "shrink": {
            s.observable: {
                "of": _known(s.value),
                "interval": [_known(s.low), _known(s.high)],
                "gap": s.has_gap,
            }
            for s in scored.found.shrinks
        },
        "shrink_to_oracle": _known(scored.shrink),
        "nats": round(scored.nats, 1),
        "seconds": round(scored.seconds, 2),
    }


def _known(value: float) -> float | None:
    return None if np.isnan(value) else round(value, 4)
