"""What the documented functions are given: what is no such thing is told by the argument's name."""

from collections.abc import Sequence

from skiplatch.admitted import JOBS, MATERIAL_FRACTION, MATERIAL_SIZE, SEED
from skiplatch.api.diagnosed import Diagnosis
from skiplatch.campaign import Campaign, Nominal, Touches
from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.simulator.effects import Effect

KINDS: dict[type, str] = {
    Campaign: "a Campaign, as read_campaign gives it",
    Nominal: "a Nominal, as read_nominal gives it",
    Touches: "Touches, as read_conditions gives them",
    Diagnosis: "a Diagnosis, as diagnose or read_diagnosis gives it",
    Effect: "an Effect",
}


def refuse_other(name: str, value: object, *kinds: type) -> None:
    """Raise TypeError for an argument that is of none of these kinds."""
    if not isinstance(value, kinds):
        expected = " or ".join(KINDS[kind] for kind in kinds)
        raise TypeError(f"{name}: expected {expected}, got {_shown(value)}")


def refuse_seed_and_jobs(seed: object, jobs: object) -> None:
    """Raise TypeError or ValueError for a seed, or a number of jobs, that there is not."""
    SEED.checked("seed", seed)
    JOBS.checked("jobs", jobs)


def checked_effects(effects: object) -> tuple[Effect, ...]:
    """Give effects that are switched on.

    Raises:
        TypeError: They are none.
    """
    if not isinstance(effects, Sequence) or isinstance(effects, str):
        raise TypeError(f"effects: expected a sequence of Effect, got {_shown(effects)}")
    for i, effect in enumerate(effects):
        refuse_other(f"effects[{i}]", effect, Effect)
    return tuple(effects)


def checked_materiality(
    material_fraction: object, material_us: object, material_um: object
) -> Materiality:
    """Give the size from which on a gap counts.

    Raises:
        TypeError: One of them is no number.
        ValueError: One is out of range.
    """
    return Materiality(
        MATERIAL_FRACTION.checked("material_fraction", material_fraction),
        None if material_us is None else MATERIAL_SIZE.checked("material_us", material_us),
        None if material_um is None else MATERIAL_SIZE.checked("material_um", material_um),
    )


def _shown(value: object) -> str:
    """Give the kind of a value, and a text itself."""
    return repr(value) if isinstance(value, str) else type(value).__name__
