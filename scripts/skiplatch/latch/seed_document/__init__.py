"""The figures of the seed document on probing strategies, each found anew by simulation."""

from skiplatch.latch.seed_document.figures import SeedFigures, as_json, as_text, seed_figures

__all__ = ["SeedFigures", "as_json", "as_text", "seed_figures"]
