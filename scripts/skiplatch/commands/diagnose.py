"""``skiplatch diagnose``: where the gap lies, what causes it, how far it shrinks."""

from pathlib import Path

import click

from skiplatch.admitted import MATERIAL_FRACTION, MATERIAL_SIZE
from skiplatch.campaign import Campaign
from skiplatch.commands.diagnose_many import Told, tell_all, told_of
from skiplatch.commands.examining import Asked, Examined, examine
from skiplatch.commands.inputs import Source
from skiplatch.commands.kept import Kept
from skiplatch.commands.numbers import NumberType
from skiplatch.commands.options import (
    EffectType,
    html_option,
    jobs_option,
    json_option,
    refuse_idle,
    seed_option,
    write_document,
    write_json,
)
from skiplatch.commands.worker_options import cluster_option, limit_option
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.played_files import read_playable
from skiplatch.simulator.effects import Effect
from skiplatch.tables import counted
from skiplatch.transmission.source import read_axis_train
from skiplatch.workers import Workers

GAP = 1
"""Exit status of a gap."""
EPILOG = """\b
Example:
  skiplatch diagnose scripts/samples/bench_isr_latency --json build/diagnosis.json
  skiplatch diagnose scripts/samples/bench_isr_latency --html build/diagnosis.html
  skiplatch diagnose scripts/samples/bench_isr_latency scripts/samples/machine_no_gap \\
      --json build/diagnoses.json --cluster local:2
"""


@click.command(epilog=EPILOG)
@click.argument("campaigns", metavar="CAMPAIGN…", nargs=-1, required=True, type=Source())
@seed_option
@jobs_option
@cluster_option
@limit_option
@json_option
@html_option
@click.option(
    "--material-fraction",
    type=NumberType.of(MATERIAL_FRACTION),
    metavar="SHARE",
    default=DEFAULT.fraction,
    show_default=True,
    help="From which share of the rig's own spread on a gap counts; the spread is the standard "
    "deviation that the nominal rig has by itself.",
)
@click.option(
    "--material-us",
    type=NumberType.of(MATERIAL_SIZE),
    metavar="µs",
    help="From how many µs on a gap counts, in what was recorded as times, in place of the share.",
)
@click.option(
    "--material-um",
    type=NumberType.of(MATERIAL_SIZE),
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
    type=Source(),
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
    cluster: str | None,
    limit_s: float,
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
    order; a page shows one alone. Several are diagnosed side by side, each by one process. What is
    done is kept in FILE.part beside the JSON until that is whole: the same command goes on there.
    """
    if html_path is not None and (len(campaigns) > 1 or cluster is not None):
        raise click.UsageError("--html shows one campaign, diagnosed here; --json holds several")
    train = read_axis_train(train_path) if train_path is not None else None
    recorded = [read_playable(folder) for folder in campaigns]
    for one in recorded:
        refuse_idle(truth, one.nominal.kind)
    asked = Asked(
        materiality=Materiality(material_fraction, material_us, material_um),
        truth=truth,
        train=train,
        explain=explain,
        seed=seed,
    )
    kept, page = Kept.beside(json_path), ""
    if len(campaigns) == 1 and cluster is None:
        found = examine(recorded[0], asked, jobs, is_shown=True)
        done = [_said(recorded[0], told_of(found))]
        if html_path is not None:
            page = _page(recorded[0], found, campaigns[0].resolve().name, seed, jobs)
    else:
        workers = Workers(jobs=jobs, cluster=cluster, limit_s=limit_s)
        told = tell_all(recorded, asked, workers, kept)
        done = [_said(*pair) for pair in zip(recorded, told, strict=True)]
    documents = [one.document for one in done]
    write_json(json_path, documents if len(documents) > 1 else documents[0])
    kept.drop()
    if html_path is not None:
        write_document(html_path, page)
    if fail_on_gap and any(one.has_gap for one in done):
        ctx.exit(GAP)


def _said(recorded: Campaign, told: Told) -> Told:
    """Print what was found in a campaign."""
    kind, touches = recorded.nominal.kind, len(recorded.touches)
    click.echo(f"{recorded.path}: {kind} campaign, {counted(touches, 'touch')}\n\n{told.text}")
    return told


def _page(recorded: Campaign, done: Examined, name: str, seed: int, jobs: int) -> str:
    # Drawing takes time to load, which only those pay who want a page.
    from skiplatch.report.page import as_html  # noqa: PLC0415

    found, after = done.diagnosis, done.experiment
    return as_html(recorded, found, name=name, seed=seed, jobs=jobs, next_experiment=after)
