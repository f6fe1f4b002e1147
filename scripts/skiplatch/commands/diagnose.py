"""``skiplatch diagnose``: where the gap lies, what causes it, how far it shrinks."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import click

from skiplatch.campaign import Campaign
from skiplatch.commands.options import (
    EffectType,
    SizeType,
    html_option,
    jobs_option,
    json_option,
    refuse_idle,
    seed_option,
    write_document,
    write_json,
)
from skiplatch.diagnosis import Diagnosis, Verdict, as_json, as_text, diagnose, explained
from skiplatch.diagnosis.experiment import (
    experiment_json,
    experiment_text,
    models_json,
    next_experiment,
    rivals,
)
from skiplatch.diagnosis.material import DEFAULT, Materiality
from skiplatch.simulator import Effect
from skiplatch.stand_ins import read_playable
from skiplatch.transmission.source import periodic_sources, read_axis_train
from skiplatch.transmission.train import GearTrain

GAP = 1
"""Exit status of a gap."""
EPILOG = """\b
Example:
  skiplatch diagnose scripts/samples/bench_isr_latency --json build/diagnosis.json
  skiplatch diagnose scripts/samples/bench_isr_latency --html build/diagnosis.html
  skiplatch diagnose scripts/samples/bench_isr_latency scripts/samples/machine_no_gap \\
      --json build/diagnoses.json
"""


@click.command(epilog=EPILOG)
@click.argument(
    "campaigns", metavar="CAMPAIGN…", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@seed_option
@jobs_option
@json_option
@html_option
@click.option(
    "--material-fraction",
    type=SizeType(),
    metavar="SHARE",
    default=DEFAULT.fraction,
    show_default=True,
    help="From which share of the rig's own spread on a gap counts; the spread is the standard "
    "deviation that the nominal rig has by itself.",
)
@click.option(
    "--material-us",
    type=SizeType(),
    metavar="µs",
    help="From how many µs on a gap counts, in what was recorded as times, in place of the share.",
)
@click.option(
    "--material-um",
    type=SizeType(),
    metavar="µm",
    help="From how many µm on a gap counts, in what was recorded as lengths, in place of the "
    "share.",
)
@click.option(
    "--truth",
    type=EffectType(),
    multiple=True,
    metavar="ID:NAME=VALUE,…",
    help="An effect that a simulated campaign has; puts the shrink that the truth reaches beside "
    "that of the finding. The diagnosis itself does not look at it.",
)
@click.option(
    "--train",
    "train_path",
    type=click.Path(path_type=Path),
    help="Description of the drive in TOML (docs/TRANSMISSION.md); a transmission error that is "
    "found is then given its order and its shaft.",
)
@click.option(
    "--explain",
    is_flag=True,
    help="Print every rule of the verdict with its threshold and reason, and what every model that "
    "was tried is short of.",
)
@click.option(
    "--fail-on-gap",
    is_flag=True,
    help="End with exit status 1 if there is a gap, explained or not: for runs nobody watches.",
)
@click.pass_context
def command(
    ctx: click.Context,
    campaigns: tuple[Path, ...],
    seed: int,
    jobs: int,
    json_path: Path | None,
    html_path: Path | None,
    material_fraction: float,
    material_us: float | None,
    material_um: float | None,
    truth: tuple[Effect, ...],
    train_path: Path | None,
    explain: bool,  # noqa: FBT001
    fail_on_gap: bool,  # noqa: FBT001
) -> None:
    """Say where the gap of each CAMPAIGN lies, which effects cause it, and how far it shrinks.

    Half of the touches serve to fit, a fifth to check, and the rest to measure the shrink by
    simulation. The verdict comes from rules, which --explain prints: a gap is explained only if it
    shrinks by 80 % for certain on touches held out, and if nothing that was recorded, nor the
    sequence of the touches, tells what is left.

    All folders are read before the first is diagnosed. The JSON of several is a list in their
    order; a page shows one alone.
    """
    if html_path is not None and len(campaigns) > 1:
        raise click.UsageError("--html shows one campaign; give one folder, or --json for several")
    train = read_axis_train(train_path) if train_path is not None else None
    recorded = [read_playable(folder) for folder in campaigns]
    for one in recorded:
        refuse_idle(truth, one.nominal.kind)
    work = _Work(
        materiality=Materiality(material_fraction, material_us, material_um),
        truth=truth,
        train=train,
        explain=explain,
        seed=seed,
        jobs=jobs,
    )
    done = [work.done(folder, one) for folder, one in zip(campaigns, recorded, strict=True)]
    documents = [one.document for one in done]
    write_json(json_path, documents if len(documents) > 1 else documents[0])
    if html_path is not None:
        name = campaigns[0].resolve().name
        write_document(html_path, _page(recorded[0], done[0], name, seed, jobs))
    if fail_on_gap and any(one.has_gap for one in done):
        ctx.exit(GAP)


@dataclass(frozen=True, slots=True, eq=False)
class _Done:
    """A diagnosis, the same in plain types, and what to touch next in words."""

    diagnosis: Diagnosis
    document: Mapping[str, Any]
    next_words: str

    @property
    def has_gap(self) -> bool:
        return self.diagnosis.verdict not in (Verdict.NO_GAP, Verdict.UNDECIDED)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Work:
    """What is asked of each campaign."""

    materiality: Materiality
    truth: Sequence[Effect]
    train: GearTrain | None
    explain: bool
    seed: int
    jobs: int

    def done(self, folder: Path, recorded: Campaign) -> _Done:
        """Diagnose a campaign and say what was found."""
        diagnosis = diagnose(
            recorded,
            seed=self.seed,
            jobs=self.jobs,
            materiality=self.materiality,
            truth=self.truth or None,
        )
        kind, touches = recorded.nominal.kind, len(recorded.touches)
        click.echo(f"{folder}: {kind} campaign, {touches} touches\n")
        click.echo(as_text(diagnosis))
        if self.explain:
            click.echo(f"\n{explained(diagnosis)}")
        sources = periodic_sources([named.effect for named in diagnosis.effects], self.train)
        for source in sources:
            click.echo(f"\n{source.text}")
        experiment = next_experiment(recorded, diagnosis, seed=self.seed, jobs=self.jobs)
        words = experiment_text(experiment)
        click.echo(f"\nNext experiment\n{words}")
        document = {
            **as_json(diagnosis),
            "seed": self.seed,
            "models": models_json(rivals(diagnosis)),
            "next_experiment": experiment_json(experiment),
        }
        if self.train is not None:
            document["transmission"] = [asdict(source) for source in sources]
        return _Done(diagnosis, document, words)


def _page(recorded: Campaign, done: _Done, name: str, seed: int, jobs: int) -> str:
    # Drawing takes time to load, which only those pay who want a page.
    from skiplatch.report.page import as_html  # noqa: PLC0415

    found, words = done.diagnosis, done.next_words
    return as_html(recorded, found, name=name, seed=seed, jobs=jobs, next_experiment=words)
