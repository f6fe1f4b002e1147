"""``skiplatch latch``: the latch errors of each input path."""

from collections.abc import Sequence
from pathlib import Path

import click

from skiplatch.campaign import InputPath, Nominal
from skiplatch.commands.kept import Kept
from skiplatch.commands.numbers import CountType, NumberType
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFolder
from skiplatch.commands.rig_options import rig_json, rig_options
from skiplatch.commands.worker_options import cluster_if_named, cluster_option, limit_option
from skiplatch.latch import Effort, as_json, as_text, examine
from skiplatch.tables import prose

EPILOG = """\b
Example:
  skiplatch latch --scan-us 2000 --feed 1000 --pictures build/latch
"""
PATHS = {
    "skip": (InputPath.SKIP,),
    "plc": (InputPath.PLC,),
    "both": (InputPath.SKIP, InputPath.PLC),
}


@click.command(epilog=EPILOG)
@click.option(
    "--path",
    "paths",
    type=click.Choice(list(PATHS)),
    default="both",
    show_default=True,
    callback=lambda _ctx, _param, value: PATHS[value],
    help="Input path.",
)
@click.option(
    "--touches",
    type=CountType(100, 10**9),
    default=10**6,
    show_default=True,
    help="Touches on each path; memory does not grow with them.",
)
@click.option(
    "--feed",
    "feed_mm_min",
    type=NumberType(1.0, 1e5),
    default=3000.0,
    show_default=True,
    help="Measuring feed, mm/min.",
)
@rig_options
@click.option(
    "--pictures",
    type=OutputFolder(),
    help="Draw the distributions into this folder.",
)
@seed_option
@jobs_option
@cluster_option
@limit_option
@json_option
def command(
    paths: Sequence[InputPath],
    touches: int,
    feed_mm_min: float,
    rig: Nominal,
    pictures: Path | None,
    seed: int,
    jobs: int,
    cluster: str | None,
    limit_s: float,
    json_path: Path | None,
) -> None:
    """How much later than the edge each input path latches, and how far off: the distributions.

    The skip input latches in an interrupt, the PLC task polls. Edges come at random times on a
    bench without a probe. Bias, which calibrates out, and spread, which does not, stand apart.
    The interval of an extreme reaches from what was seen to the limit that the rig sets.
    """
    effort, kept = Effort(touches, seed, jobs), Kept.beside(json_path)
    with cluster_if_named(cluster, limit_s) as executor:
        results = {path: examine(rig, path, feed_mm_min, effort, executor, kept) for path in paths}
    click.echo(prose(as_text(rig, feed_mm_min, results)))
    conditions = {"touches": touches, "feed_mm_min": feed_mm_min, "seed": seed}
    document = {"format": "skiplatch-latch/1", **conditions, "rig": rig_json(rig)}
    write_json(json_path, {**document, "paths": as_json(results)})
    kept.drop()
    if pictures is not None:
        # Drawing takes time to load, which only those pay who want a picture.
        from skiplatch.figures.latch_errors import draw_latch_errors  # noqa: PLC0415

        picture = pictures / "latch_errors.svg"
        errors = {path: result.errors for path, result in results.items()}
        draw_latch_errors(picture, errors, feed_mm_min)
        click.echo(f"wrote {picture}")
