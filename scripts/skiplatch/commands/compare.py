"""``skiplatch compare``: a recorded campaign beside the nominal simulation."""

from pathlib import Path

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import NumberType
from skiplatch.commands.options import (
    html_option,
    jobs_option,
    json_option,
    seed_option,
    write_document,
    write_json,
)
from skiplatch.commands.outputs import OutputFolder
from skiplatch.comparison import DEFAULT_ALPHA, as_json, as_text, compare
from skiplatch.played_files import read_playable
from skiplatch.tables import counted

EPILOG = """\b
Example:
  skiplatch compare scripts/samples/bench_isr_latency --pictures build/compared
"""


@click.command(epilog=EPILOG)
@click.argument("campaign", type=Source())
@click.option(
    "--alpha",
    type=NumberType(0.005, 0.5),
    default=DEFAULT_ALPHA,
    show_default=True,
    help="Accepted rate of false alarms, over all cells together.",
)
@click.option(
    "--pictures",
    type=OutputFolder(),
    help="Draw the distributions into this folder.",
)
@html_option
@seed_option
@jobs_option
@json_option
def command(
    campaign: Path,
    alpha: float,
    pictures: Path | None,
    html_path: Path | None,
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Replay a recorded CAMPAIGN in the nominal simulation and show by how much they differ.

    Per path, feed and observable: both distributions, the difference of their means and spreads in
    µs and µm (of rotary axes arcsec) with 95 % intervals, the distance between them, and the noise
    floor, which is the distance that one replicate of the simulation in twenty exceeds.
    """
    recorded = read_playable(campaign)
    comparison = compare(recorded, seed=seed, jobs=jobs, alpha=alpha)
    click.echo(
        f"{campaign}: {recorded.nominal.kind} campaign, {counted(len(recorded.touches), 'touch')}\n"
    )
    click.echo(as_text(comparison))
    write_json(json_path, {"campaign": str(campaign), **as_json(comparison)})
    if html_path is not None:
        # Drawing takes time to load, which only those pay who want a page.
        from skiplatch.report.comparison import as_html  # noqa: PLC0415

        write_document(html_path, as_html(recorded, comparison, name=campaign.resolve().name))
    if pictures is not None:
        from skiplatch.figures.comparison import draw_comparison  # noqa: PLC0415

        for path in draw_comparison(comparison, pictures):
            click.echo(f"wrote {path}")
