"""The next experiment: the column to record, or the touches to make, to settle a diagnosis.

Builds on ``reported`` and all below it.
"""

from skiplatch.diagnosis.experiment.experiment import (
    Experiment,
    experiment_for,
    next_experiment,
    settle,
)
from skiplatch.diagnosis.experiment.outcome import Standing, borne_out_nats, outcome
from skiplatch.diagnosis.experiment.rivals import models_from_json, models_json, rivals
from skiplatch.diagnosis.experiment.text import (
    experiment_json,
    experiment_text,
    remarks,
    touches_table,
)

__all__ = [
    "Experiment",
    "Standing",
    "borne_out_nats",
    "experiment_for",
    "experiment_json",
    "experiment_text",
    "models_from_json",
    "models_json",
    "next_experiment",
    "outcome",
    "remarks",
    "rivals",
    "settle",
    "touches_table",
]
