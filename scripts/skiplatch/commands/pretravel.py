"""``skiplatch pretravel``: the experiments of the document on variable-speed compensation."""

from pathlib import Path

import click

from skiplatch.arrays import FloatArray
from skiplatch.campaign import InputPath
from skiplatch.commands.claims import claim_output
from skiplatch.commands.inputs import FILE
from skiplatch.commands.kept import Kept
from skiplatch.commands.numbers import CountType
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFolder
from skiplatch.commands.worker_options import cluster_if_named, cluster_option, limit_option
from skiplatch.compensation import campaigns, paper
from skiplatch.compensation.experiment import Result, run
from skiplatch.compensation.rigs import RIGS
from skiplatch.files import refuse_occupied
from skiplatch.workers import in_order

EPILOG = """\b
Example:
  skiplatch pretravel --rig haas --seed 1 --record build/haas
  skiplatch diagnose build/haas/before
  skiplatch compensate --from-campaign build/haas/before --v0 100 --out build/table.csv
  skiplatch pretravel --rig haas --seed 2 --table build/table.csv --record build/closed
"""
PATHS = {"skip": InputPath.SKIP, "plc": InputPath.PLC}


@click.command(epilog=EPILOG)
@click.option(
    "--rig",
    "name",
    type=click.Choice(list(RIGS)),
    required=True,
    help="Which probe on which rig.",
)
@click.option(
    "--path",
    "path",
    type=click.Choice(list(PATHS)),
    default="skip",
    show_default=True,
    help="Input that latches; plc shows what a scan of 4 ms costs.",
)
@click.option(
    "--iterations",
    type=CountType(1, 10),
    default=1,
    show_default=True,
    help="How often the feeds are worked out and measured again.",
)
@click.option(
    "--table",
    "table_path",
    type=FILE,
    metavar="TABLE.csv",
    help="Measure at the feeds of this table of 'skiplatch compensate' afterwards.",
)
@click.option(
    "--trials",
    type=CountType(1, 1000),
    default=1,
    show_default=True,
    help="Repeat the whole experiment with the seeds that follow, for intervals.",
)
@click.option(
    "--record",
    "folder",
    type=OutputFolder(),
    help="Write campaigns 'before' and 'after', radii and speeds (of the first trial) there.",
)
@seed_option
@jobs_option
@cluster_option
@limit_option
@json_option
def command(
    name: str,
    path: str,
    iterations: int,
    table_path: Path | None,
    trials: int,
    folder: Path | None,
    seed: int,
    jobs: int,
    cluster: str | None,
    limit_s: float,
    json_path: Path | None,
) -> None:
    """Measure a probe, compensate it by variable feeds, and measure it again, in simulation.

    The delay comes from runs on a ring, the map from touches all over a sphere, the feeds from the
    firmware's mathematics; every touch goes through the firmware's latch. The table has
    published figures beside ours, and says which of them the simulation was set up to give.
    """
    if table_path is not None and iterations > 1:
        raise click.UsageError("--table says at which feeds to measure: no --iterations with it")
    if folder is not None:
        for part in (campaigns.BEFORE, campaigns.AFTER):
            refuse_occupied(folder / part)
            claim_output(folder / part, is_whole=True)
        for part in (campaigns.RADII_BEFORE, campaigns.RADII_AFTER, campaigns.SPEEDS):
            claim_output(folder / part)
    rig = RIGS[name]
    table = None if table_path is None else campaigns.read_feeds(table_path, rig.directions)
    seeds, kept = range(seed, seed + trials), Kept.beside(json_path)
    with cluster_if_named(cluster, limit_s) as executor:
        threads = 1 if executor else jobs
        tasks = [(name, PATHS[path], iterations, table, threads, trial) for trial in seeds]
        if executor is None:
            results = [_trial(*task) for task in tasks]
        else:
            names = [f"trial of seed {trial}" for trial in seeds]
            results = list(in_order(executor, _trial, tasks, names, kept))
    figures = paper.figures(results)
    click.echo(paper.as_text(results, figures))
    write_json(
        json_path,
        {
            "format": "skiplatch-pretravel/1",
            "rig": name,
            "path": path,
            "iterations": iterations,
            "seed": seed,
            **paper.as_json(results, figures),
        },
    )
    kept.drop()
    if folder is not None:
        campaigns.record(folder, results[0])
        click.echo(f"\nwrote {folder}: campaigns before and after, their radii, and speeds.csv")


def _trial(
    name: str,
    path: InputPath,
    iterations: int,
    table_mm_min: FloatArray | None,
    threads: int,
    seed: int,
) -> Result:
    """Make the experiment once, on whichever machine."""
    return run(
        RIGS[name],
        seed=seed,
        jobs=threads,
        path=path,
        iterations=iterations,
        table_mm_min=table_mm_min,
    )
