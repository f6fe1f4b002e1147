"""What is said of an experiment."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from skiplatch.diagnosis.experiment.trial import SURE, Trial
from skiplatch.simulator.effects import Effect, effects

Group = Sequence[str]
STILL_OF_USE = "The touches that follow say how large the error is, and not which of them it is."

PLUS, NOTHING = " + ", "no effect"
A_GAUGE = (
    "A gauge of known width would, touched from both sides, with a table of how far its touches "
    "are off its faces (deviation_um, skiplatch import csv)."
)


@dataclass(frozen=True, slots=True)
class Setting:
    """What is different from the campaign while the touches are made."""

    column: str | None = None
    """Recorded in addition."""
    warmer_k: float = 0.0


AS_RECORDED = Setting()


def name(model: Sequence[Effect]) -> str:
    """Name a model by its effects."""
    return PLUS.join(effect.id for effect in model) or NOTHING


def without_rivals(verdict: str, finding: str) -> str:
    """Say why the touches are spread over everything."""
    spread = (
        "The touches vary path, feed, surface, approach and rest independently, over the surfaces "
        "that the campaign has, so that whatever the error depends on shows by itself."
    )
    if verdict == "no_gap":
        return f"There is no gap to settle. To look for one once more: {_lowered(spread)}"
    if verdict == "undecided":
        return f"There are too few touches to tell whether there is a gap. {spread}"
    if verdict == "unknown":
        return f"No effect of the catalogue is left to be told from another. {spread}"
    return f"Nothing that was tried rivals {finding}. To confirm it: {_lowered(spread)}"


def with_rivals(
    groups: Sequence[Group],
    models: Sequence[Sequence[Effect]],
    chosen: Setting,
    tried: Mapping[Setting, Trial],
) -> str:
    """Say what the recommended experiment tells apart, and what the others would."""
    if len(groups) == 1:
        return _nothing_separates(groups[0], models, [s.column for s in tried if s.column])
    needed = tried[chosen].touches_needed
    apart = " from ".join(" or ".join(group) for group in groups)
    tells = f"the first {needed} are expected to tell {apart} with a probability of {SURE:g}"
    says = [f"{_lead(chosen)} these touches: {tells}."]
    says += [f"{_listed(group)} stay tied." for group in groups if len(group) > 1]
    if chosen != AS_RECORDED:
        says.append(_as_recorded(tried[AS_RECORDED]))
    elif any(setting.column for setting in tried):
        says.append("Recording another column would save few touches or none.")
    return " ".join(says)


def other_surfaces(asked: str) -> str:
    """Say what surfaces tell more than those that were touched; `asked` is empty for none."""
    if not asked:
        return "Other surfaces are not expected to tell more."
    return (
        f"Another surface would tell more, which the campaign shows none of: {asked}. "
        "Touch it as well, and diagnose all touches anew."
    )


def not_told(groups: Sequence[Group]) -> str:
    """Say what the log of programs will leave tied; empty for nothing."""
    if not groups:
        return ""
    tied = "; nor ".join(f"{' or '.join(group[:-1])} from {group[-1]}" for group in groups)
    why = "it says neither how far apart the surfaces lie nor when an edge was latched"
    said = f"The log of these programs is not expected to tell {tied}: {why}."
    ids = {one for group in groups for model in group for one in model.split(PLUS)}
    is_length = any(effects()[one].stage == "position" for one in ids - {NOTHING})
    return f"{said} {A_GAUGE}" if is_length else said


def _lead(setting: Setting) -> str:
    if setting.column:
        return f"Record {setting.column} and make"
    if setting.warmer_k:
        return f"While the machine warms up by {setting.warmer_k:g} K, make"
    return "Make"


def _as_recorded(trial: Trial) -> str:
    if trial.touches_needed is None:
        return "As the campaign was recorded, no touches would do."
    groups = "" if trial.count == len(trial.groups) else f", for {trial.count} groups"
    return f"As the campaign was recorded, it would take {trial.touches_needed}{groups}."


def _nothing_separates(
    group: Group, models: Sequence[Sequence[Effect]], columns: Sequence[str]
) -> str:
    also = f", nor does recording {' or '.join(columns)} help" if columns else ""
    return (
        f"{_listed(group)} cannot be separated: no touches on this rig are expected to tell them "
        f"apart{also}. {_elsewhere(models)} {STILL_OF_USE}"
    )


def _elsewhere(models: Sequence[Sequence[Effect]]) -> str:
    """Say what lies beyond touches: a probe of the chain between the stages of the rivals."""
    rows = (effects()[effect.id] for model in models for effect in model)
    stages = list(dict.fromkeys(row.stage for row in sorted(rows, key=lambda row: row.index)))
    if len(stages) == 1:
        return f"Change one of them in the {stages[0]} stage on purpose, and see what follows."
    return f"What would do is a signal measured between the stages {_listed(stages)}."


def _listed(names: Group) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _lowered(sentence: str) -> str:
    return sentence[0].lower() + sentence[1:]
