"""Where the gap between a campaign and its simulation lies, what causes it, how far it shrinks."""

from skiplatch.diagnosis.diagnose import Diagnosis, diagnose
from skiplatch.diagnosis.document import as_json, effects_from_json, rig_from_json
from skiplatch.diagnosis.named import Named
from skiplatch.diagnosis.text import as_text, explained
from skiplatch.diagnosis.verdict import Verdict
from skiplatch.diagnosis.where import Place

__all__ = [
    "Diagnosis",
    "Named",
    "Place",
    "Verdict",
    "as_json",
    "as_text",
    "diagnose",
    "effects_from_json",
    "explained",
    "rig_from_json",
]
