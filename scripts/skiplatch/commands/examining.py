"""One campaign diagnosed, in words and as a document: what `diagnose` and `fleet watch` share."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from skiplatch.campaign import Campaign
from skiplatch.diagnosis import Diagnosis, Verdict, as_json, as_text, diagnose, explained
from skiplatch.diagnosis.experiment import (
    Experiment,
    experiment_json,
    experiment_text,
    models_json,
    next_experiment,
    rivals,
)
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.simulator.effects import Effect
from skiplatch.transmission.source import periodic_sources
from skiplatch.transmission.train import GearTrain


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What is asked of each campaign; the answer depends on nothing else.

    Attributes:
        seed: Picks the random numbers.
        materiality: From which size on a gap counts.
        truth: Effects that a simulated campaign has; none otherwise.
        train: The drive, to which a transmission error is traced.
        explain: Whether every rule is told.
    """

    seed: int
    materiality: Materiality = DEFAULT
    truth: Sequence[Effect] = ()
    train: GearTrain | None = None
    explain: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Examined:
    """A diagnosis, the same in words and in plain types, and what to touch next."""

    diagnosis: Diagnosis
    text: str
    document: Mapping[str, Any]
    experiment: Experiment

    @property
    def has_gap(self) -> bool:
        """Whether there is a gap, explained or not."""
        return self.diagnosis.verdict not in (Verdict.NO_GAP, Verdict.UNDECIDED)


def examine(recorded: Campaign, asked: Asked, jobs: int, *, is_shown: bool = False) -> Examined:
    """Diagnose a campaign and say what was found.

    Args:
        recorded: The campaign.
        asked: What is asked of it.
        jobs: Processes and threads that work on it.
        is_shown: A terminal shows how much is done.
    """
    diagnosis = diagnose(
        recorded,
        seed=asked.seed,
        jobs=jobs,
        materiality=asked.materiality,
        truth=asked.truth or None,
        is_shown=is_shown,
    )
    experiment = next_experiment(recorded, diagnosis, seed=asked.seed, jobs=jobs)
    sources = periodic_sources([named.effect for named in diagnosis.effects], asked.train)
    parts = [as_text(diagnosis), *([explained(diagnosis)] if asked.explain else [])]
    parts += [source.text for source in sources]
    parts.append(f"Next experiment\n{experiment_text(experiment)}")
    document = {
        **as_json(diagnosis),
        "seed": asked.seed,
        "models": models_json(rivals(diagnosis)),
        "next_experiment": experiment_json(experiment),
    }
    if asked.train is not None:
        document["transmission"] = [asdict(source) for source in sources]
    return Examined(diagnosis, "\n\n".join(parts), document, experiment)
