"""``skiplatch plan``: the best probing strategy for a wanted uncertainty."""

from pathlib import Path

import click

from skiplatch.campaign import InputPath, Nominal
from skiplatch.commands.numbers import NumberType
from skiplatch.commands.options import Decorator, jobs_option, json_option, seed_option, write_json
from skiplatch.commands.rig_options import rig_options
from skiplatch.latch import Effort
from skiplatch.planner import Limits, as_json, as_text, make_plan
from skiplatch.tables import prose

EPILOG = """\b
Example:
  skiplatch plan --path plc --scan-us 4000 --uncertainty-um 2
"""
UNREACHABLE = 1  # exit status
CYCLES = 100_000  # of the plan, simulated


def _limit(flag: str, low: float, high: float, default: float, meaning: str) -> Decorator:
    return click.option(
        flag, type=NumberType(low, high), default=default, show_default=f"{default:g}", help=meaning
    )


@click.command(epilog=EPILOG)
@click.option(
    "--path",
    type=click.Choice([path.name.lower() for path in InputPath]),
    required=True,
    help="Input path.",
)
@click.option(
    "--uncertainty-um",
    "wanted_um",
    type=NumberType(1e-3, 1e6),
    required=True,
    help="Wanted uncertainty as a full range, greatest minus least: reaction width × feed.",
)
@_limit("--stand-off-mm", 0.01, 1000.0, 5.0, "From the start to the surface.")
@_limit("--overtravel-mm", 0.001, 1000.0, 2.0, "How far the probe may be driven past the surface.")
@_limit("--reaction-us", 0.0, 1e6, 2000.0, "Latch to the start of the deceleration.")
@_limit("--max-feed", 0.1, 1e5, 3000.0, "Greatest feed, mm/min.")
@_limit("--min-feed", 0.1, 1e5, 3.0, "Least feed, mm/min.")
@_limit("--min-back-off-mm", 0.001, 1000.0, 0.05, "Least back-off between two touches.")
@_limit("--margin-mm", 0.0, 1000.0, 0.02, "Back-off beyond the latest first latch and the ramp.")
@rig_options
@seed_option
@jobs_option
@json_option
@click.pass_context
def command(
    ctx: click.Context,
    path: str,
    wanted_um: float,
    stand_off_mm: float,
    overtravel_mm: float,
    reaction_us: float,
    max_feed: float,
    min_feed: float,
    min_back_off_mm: float,
    margin_mm: float,
    rig: Nominal,
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Find the fastest way to probe that keeps to a wanted uncertainty: one touch or two.

    Feeds and back-off come from a model of the cycle; the firmware then plays the result in the
    simulation. Where a limit forbids the wish, the program names it and ends with status 1.
    """
    if min_feed > max_feed:
        raise click.BadParameter("more than --max-feed", param_hint="'--min-feed'")
    limits = Limits(
        nominal=rig,
        path=InputPath[path.upper()],
        stand_off_mm=stand_off_mm,
        reaction_us=reaction_us,
        overtravel_mm=overtravel_mm,
        least_feed_mm_min=min_feed,
        greatest_feed_mm_min=max_feed,
        least_back_off_mm=min_back_off_mm,
        margin_mm=margin_mm,
    )
    plan = make_plan(limits, wanted_um, Effort(CYCLES, seed, jobs))
    click.echo(prose(as_text(plan)))
    write_json(json_path, as_json(plan))
    if plan.best is None:
        ctx.exit(UNREACHABLE)
