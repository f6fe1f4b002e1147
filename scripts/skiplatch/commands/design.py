"""``skiplatch design``: the touches that would best settle a diagnosis, as a conditions file."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click

from skiplatch.campaign import CONDITIONS, Campaign, format_touches
from skiplatch.commands.claims import claim_output
from skiplatch.commands.inputs import FILE, Source
from skiplatch.commands.numbers import CountType
from skiplatch.commands.options import (
    jobs_option,
    json_option,
    other_touches_option,
    seed_option,
    write_json,
)
from skiplatch.commands.outputs import OutputFile
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.experiment import (
    Experiment,
    experiment_for,
    experiment_json,
    experiment_text,
    models_from_json,
    rivals,
    words,
)
from skiplatch.diagnosis.experiment.conditions import rests_s, timed
from skiplatch.diagnosis.experiment.experiment import TOUCHES
from skiplatch.diagnosis.experiment.logged import not_told
from skiplatch.diagnosis.reported.belonging import refuse_of_others
from skiplatch.diagnosis.reported.schema import read_diagnosis_json
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text
from skiplatch.played_files import read_playable
from skiplatch.probing_program import FILES, KINDS, Programs, programs, refuse_name
from skiplatch.probing_touches import FEED_STEPS_MM_MIN, as_logged, path_of
from skiplatch.simulator.effects import Effect
from skiplatch.stand_ins import refuse_unplayable
from skiplatch.tables import counted, prose

EPILOG = """\b
Example:
  skiplatch design scripts/samples/bench_isr_latency --out build/next.csv
  skiplatch design mill --diagnosis mill.json --gcode linuxcnc -o next.csv
"""


@click.command(epilog=EPILOG)
@click.argument("campaign", type=Source())
@click.option(
    "-o",
    "--out",
    type=OutputFile(),
    required=True,
    help="Conditions to write, the most telling touch first.",
)
@click.option(
    "--touches",
    type=CountType(1, 1000),
    default=TOUCHES,
    show_default=True,
    help="How many touches to recommend.",
)
@click.option(
    "--diagnosis",
    "diagnosis_path",
    type=FILE,
    help="JSON of 'skiplatch diagnose' of this campaign, in place of diagnosing it anew.",
)
@other_touches_option
@click.option(
    "--gcode",
    type=click.Choice(KINDS),
    help="Also write the touches as programs for this controller, one a surface, beside --out; "
    "'skiplatch import' reads what they log.",
)
@click.option(
    "--as-recorded",
    is_flag=True,
    help="Recommend no column that the campaign does not have; --gcode implies it, as no log of "
    "a controller has more.",
)
@seed_option
@jobs_option
@json_option
def command(
    *,
    campaign: Path,
    out: Path,
    touches: int,
    diagnosis_path: Path | None,
    other_touches: bool,
    gcode: str | None,
    as_recorded: bool,
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Say which touches, or which column, would settle the diagnosis of a CAMPAIGN, and write them.

    The candidates that are left after the diagnosis play touches of the surfaces of the campaign,
    within the reach of the axis (min_mm, max_mm of nominal.toml), at its feeds and slower ones;
    those are written that are expected to tell most. Where another surface would tell more, it
    says which.
    """
    recorded = read_playable(campaign)
    if gcode is not None:
        _refuse_early(gcode, campaign, recorded, out)
    models, verdict = _left(recorded, diagnosis_path, seed, jobs, other_touches=other_touches)
    experiment = experiment_for(
        recorded,
        models,
        verdict,
        seed=seed,
        jobs=jobs,
        touches=touches,
        as_recorded=as_recorded or gcode is not None,
    )
    then, tied, doubts = "", [], []
    if gcode is not None:
        experiment = _as_logged(gcode, experiment)
    texts = {out: format_touches(experiment.touches, CONDITIONS)}
    if gcode is not None:
        made = _programs(gcode, campaign, recorded, experiment, out)
        tied = not_told(recorded, models, experiment.touches, seed=seed, jobs=jobs)
        texts |= {out.with_name(name): text for name, text in made.texts.items()}
        doubts = [prose(doubt) for doubt in made.doubts]
        then = f"{_feeds_said(gcode)}\nThen: {made.then}"
    for path, text in texts.items():
        atomic_write_text(path, text)
    click.echo(
        "\n".join(filter(None, (experiment_text(experiment), words.not_told(tied), *doubts)))
    )
    click.echo(f"{', '.join(map(str, texts))}: {counted(len(experiment.touches), 'touch')}{then}")
    logged = {} if gcode is None else {"programs_leave_tied": [list(group) for group in tied]}
    write_json(json_path, {**experiment_json(experiment), **logged})


def _refuse_early(kind: str, campaign: Path, recorded: Campaign, out: Path) -> None:
    """Refuse before the diagnosis what no program can be written for."""
    for ending in FILES[kind]:
        claim_output(out.with_name(out.stem + ending))
    try:
        refuse_name(out.stem)
    except ValueError as error:
        raise InputError(out, None, None, str(error)) from error
    try:
        path_of(recorded.touches)
    except ValueError as error:
        raise InputError(campaign, None, None, f"no program for {kind}: {error}") from error


def _left(
    recorded: Campaign, path: Path | None, seed: int, jobs: int, *, other_touches: bool
) -> tuple[Sequence[tuple[Effect, ...]], str]:
    """Give the models that a diagnosis leaves, and its verdict."""
    if path is None:
        diagnosis = diagnose(recorded, seed=seed, jobs=jobs, is_shown=True)
        return rivals(diagnosis), str(diagnosis.verdict)
    models, verdict = read_diagnosis_json(path, models_from_json)
    if not other_touches:
        refuse_of_others(path, recorded.path, recorded.fingerprint)
    for model in models:
        refuse_unplayable(path, recorded.nominal, model)
    return models, verdict


def _as_logged(kind: str, experiment: Experiment) -> Experiment:
    """Ask for feeds that the controller's log prints in full, so that they come back as asked."""
    asked, touches = experiment.touches, as_logged(kind, experiment.touches)
    if touches is asked:
        return experiment
    return replace(experiment, touches=timed(touches, rests_s(asked)).touches)


def _feeds_said(kind: str) -> str:
    step = FEED_STEPS_MM_MIN.get(kind)
    if step is None:
        return ""
    return f"\nFeeds are multiples of {step:g} mm/min, as {kind}'s log prints no finer ones."


def _programs(
    kind: str, campaign: Path, recorded: Campaign, experiment: Experiment, out: Path
) -> Programs:
    axis, touches = recorded.nominal.axis, experiment.touches
    reach_mm = (axis.min_mm, axis.max_mm)
    try:
        made = programs(kind, touches, rests_s(touches).tolist(), reach_mm, out.stem, campaign)
    except ValueError as error:
        raise InputError(campaign, None, None, f"no program for {kind}: {error}") from error
    claimed = {out.stem + ending for ending in FILES[kind]}
    for name in made.texts.keys() - claimed:
        claim_output(out.with_name(name))
    return made
