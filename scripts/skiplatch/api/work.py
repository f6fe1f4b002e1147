"""Simulate, diagnose, predict, design: what the commands of these names do, with objects."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from skiplatch.admitted import REPLICATES
from skiplatch.admitted import TOUCHES as TOUCHES_ADMITTED
from skiplatch.api.arguments import (
    checked_effects,
    checked_materiality,
    refuse_other,
    refuse_seed_and_jobs,
)
from skiplatch.api.diagnosed import Diagnosis, document_of
from skiplatch.api.predicted import Prediction, predicted
from skiplatch.campaign import (
    COLUMNS,
    NOMINAL_FILE,
    Axis,
    Campaign,
    Nominal,
    Status,
    Touches,
)
from skiplatch.campaign.columns import MEASURED_OUTCOMES
from skiplatch.diagnosis import diagnose as diagnosis_of
from skiplatch.diagnosis import rig_from_json
from skiplatch.diagnosis.experiment import Experiment, experiment_for, models_from_json
from skiplatch.diagnosis.experiment.experiment import TOUCHES
from skiplatch.diagnosis.fit.material import DEFAULT
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.library import SimulationError, connection
from skiplatch.simulator.playing import Outcomes, play
from skiplatch.simulator.rig import Controller
from skiplatch.stand_ins import playable, refuse_unplayable
from skiplatch.units import ARCSEC_PER_MILLIDEGREE

SIMULATED = Path("simulated")
"""Stands for the folder of a campaign that has none."""


def simulate(
    rig: Campaign | Nominal,
    conditions: Touches | None = None,
    *,
    effects: Sequence[Effect] = (),
    seed: int = 1,
    jobs: int = 1,
) -> Campaign:
    """Play conditions through the simulation, firmware and all, as a recorder would record them.

    Args:
        rig: What is believed of the rig, or a campaign of it.
        conditions: The touches to play, without them those of the campaign. Outcomes in them are
            not looked at.
        effects: Switched on besides what the rig is believed to have.
        seed: Picks the random numbers.
        jobs: Threads; the result does not depend on it.

    Raises:
        InputError: A figure of the rig cannot be simulated, or a condition is missing.
        SimulationError: An effect or a parameter is none, or out of its range, or what comes of it
            is more than a clock, a counter or a campaign holds.
        TypeError: An argument is not of its kind.
        ValueError: An argument is out of its range.
    """
    refuse_seed_and_jobs(seed, jobs)
    switched_on = checked_effects(effects)
    asked = _asked(rig, conditions)
    touches = asked.touches
    controller = Controller.for_campaign(asked.nominal, touches)
    outcomes = play(
        asked.nominal, controller, touches, seed=seed, jobs=jobs, switched_on=switched_on
    )
    recorded = _as_recorded(touches, outcomes)
    _refuse_beyond(recorded, asked.nominal.axis.resolution_um)
    return replace(asked, touches=recorded)


def diagnose(
    campaign: Campaign,
    *,
    seed: int = 1,
    jobs: int = 1,
    material_fraction: float = DEFAULT.fraction,
    material_us: float | None = None,
    material_um: float | None = None,
) -> Diagnosis:
    """Say where the gap lies, which effects cause it, and how far it shrinks.

    Args:
        campaign: What was recorded.
        seed: Of the split of the touches, and of the plays.
        jobs: Processes and threads; the result does not depend on it.
        material_fraction: From which share of the rig's own spread on a gap counts.
        material_us: From how many µs on, in times; in place of the share.
        material_um: From how many µm on, in lengths; in place of the share.

    Raises:
        InputError: The campaign cannot be played: a feed is missing, or a figure is out of range.
        TypeError: An argument is not of its kind.
        ValueError: An argument is out of its range.
    """
    refuse_other("campaign", campaign, Campaign)
    refuse_seed_and_jobs(seed, jobs)
    materiality = checked_materiality(material_fraction, material_us, material_um)
    found = diagnosis_of(playable(campaign), seed=seed, jobs=jobs, materiality=materiality)
    return replace(Diagnosis.of_document(document_of(found, seed)), _named=found.effects)


def predict(
    rig: Campaign | Nominal,
    conditions: Touches | None = None,
    *,
    diagnosis: Diagnosis | None = None,
    replicates: int = 1,
    seed: int = 1,
    jobs: int = 1,
) -> Prediction:
    """Play conditions on a rig, with the effects that a diagnosis found.

    Where conditions give `edge_us`, the contacts close there. With a diagnosis and the campaign it
    is of, the scans of the PLC keep the phase that the recorded stamps show.

    Args:
        rig: A campaign, or what is believed of the rig alone.
        conditions: The touches to play, without them those of the campaign.
        diagnosis: What was found; without it the nominal chain plays.
        replicates: How often to play them.
        seed: Picks the random numbers.
        jobs: Threads; the result does not depend on it.

    Raises:
        InputError: As `simulate`.
        TypeError: An argument is not of its kind.
        ValueError: An argument is out of its range, or the diagnosis is not whole.
    """
    refuse_seed_and_jobs(seed, jobs)
    REPLICATES.checked("replicates", replicates)
    if diagnosis is not None:
        refuse_other("diagnosis", diagnosis, Diagnosis)
    asked = _asked(rig, conditions)
    found = rig_from_json(diagnosis.document, asked.nominal) if diagnosis else Rig(asked.nominal)
    recorded = rig.touches if diagnosis and isinstance(rig, Campaign) else None
    return predicted(found, recorded, asked.touches, replicates=replicates, seed=seed, jobs=jobs)


def design(
    campaign: Campaign,
    diagnosis: Diagnosis | None = None,
    *,
    touches: int = TOUCHES,
    seed: int = 1,
    jobs: int = 1,
) -> Experiment:
    """Say which touches, or which column, would settle a diagnosis.

    Args:
        campaign: What was diagnosed.
        diagnosis: What came of it; without it the campaign is diagnosed first.
        touches: How many touches to recommend.
        seed: Picks the random numbers.
        jobs: Threads; the result does not depend on it.

    Raises:
        InputError: The campaign cannot be played.
        TypeError: An argument is not of its kind.
        ValueError: An argument is out of its range, or the diagnosis is not whole.
    """
    refuse_other("campaign", campaign, Campaign)
    refuse_seed_and_jobs(seed, jobs)
    TOUCHES_ADMITTED.checked("touches", touches)
    if diagnosis is not None:
        refuse_other("diagnosis", diagnosis, Diagnosis)
    recorded = playable(campaign)
    known = diagnosis or diagnose(recorded, seed=seed, jobs=jobs)
    models, verdict = models_from_json(known.document)
    return experiment_for(recorded, models, verdict, seed=seed, jobs=jobs, touches=touches)


def _asked(rig: Campaign | Nominal, conditions: Touches | None) -> Campaign:
    """Put rig and conditions together, the campaign's own made playable."""
    refuse_other("rig", rig, Campaign, Nominal)
    if conditions is None:
        if not isinstance(rig, Campaign):
            raise TypeError("conditions are missing: a Nominal has none of its own")
        return playable(rig)
    refuse_other("conditions", conditions, Touches)
    nominal, path = (rig.nominal, rig.path) if isinstance(rig, Campaign) else (rig, SIMULATED)
    refuse_unplayable(path / NOMINAL_FILE, nominal)
    return Campaign(nominal, conditions, path)


def _as_recorded(conditions: Touches, outcomes: Outcomes) -> Touches:
    """Put the first replicate where a recorder would have put it; conditions stay as they are."""
    deviation_um = outcomes.deviation_um[0]
    turned_arcsec = np.where(conditions.axis >= Axis.A, deviation_um, np.nan)
    return replace(
        conditions,
        edge_us=outcomes.edge_us[0],
        latch_us=outcomes.latch_us[0],
        report_us=outcomes.report_us[0],
        deviation_um=deviation_um,
        deviation_arcsec=turned_arcsec * ARCSEC_PER_MILLIDEGREE,
        status=np.where(outcomes.ok[0], Status.OK, Status.MISSED).astype(np.int8),
    )


def _refuse_beyond(recorded: Touches, resolution_um: float) -> None:
    """Raise SimulationError for an outcome that the rig cannot count or a campaign cannot hold."""
    _, library = connection()
    counted_um = np.abs(recorded.deviation_um) >= library.SIM_COUNTS_MAX * resolution_um
    for name in MEASURED_OUTCOMES:
        values = getattr(recorded, name)
        beyond = ~COLUMNS[name].admits(values)
        if name == "deviation_um":
            beyond |= counted_um
        if beyond.any():
            first = int(np.argmax(beyond))
            where = f"{name} of touch {recorded.touch[first]}"
            raise SimulationError(
                f"{where}: {values[first]:g} is more than the rig counts or a campaign holds"
            )
