"""Where the gap between a campaign and its simulation lies, what causes it, how far it shrinks."""

from skiplatch.diagnosis.diagnose import diagnose
from skiplatch.diagnosis.reported.diagnosis import Diagnosis
from skiplatch.diagnosis.reported.document import as_json, effects_from_json, rig_from_json
from skiplatch.diagnosis.reported.text import as_text, explained
from skiplatch.diagnosis.reported.where import Place
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.diagnosis.verdict.verdict import Verdict

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
