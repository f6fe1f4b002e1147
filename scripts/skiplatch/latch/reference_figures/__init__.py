"""The figures of the reference document on probing strategies, each found anew by simulation."""

from skiplatch.latch.reference_figures.figures import (
    ReferenceFigures,
    as_json,
    as_text,
    play_figures,
)

__all__ = ["ReferenceFigures", "as_json", "as_text", "play_figures"]
