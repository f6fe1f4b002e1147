"""The next experiment: the column to record, or the touches to make, to settle a diagnosis."""

from skiplatch.diagnosis.experiment.experiment import Experiment, next_experiment, settle
from skiplatch.diagnosis.experiment.outcome import Standing, outcome
from skiplatch.diagnosis.experiment.rivals import rivals
from skiplatch.diagnosis.experiment.text import experiment_json, experiment_text

__all__ = [
    "Experiment",
    "Standing",
    "experiment_json",
    "experiment_text",
    "next_experiment",
    "outcome",
    "rivals",
    "settle",
]
