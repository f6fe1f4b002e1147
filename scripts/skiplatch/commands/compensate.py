"""``skiplatch compensate``: a probe's map in, measuring feeds for every direction out."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from skiplatch.commands.compensate_inputs import Result, result_of
from skiplatch.commands.inputs import FILE, Source
from skiplatch.commands.numbers import (
    ACCEL_MM_S2,
    FEED_MM_MIN,
    LENGTH_MM,
    LENGTH_UM,
    PERCENT,
    TIME_MS,
    CountType,
    number_or_nan,
)
from skiplatch.commands.options import (
    html_option,
    json_option,
    json_text,
    seed_option,
    write_document,
)
from skiplatch.commands.outputs import STDOUT, OutputFile
from skiplatch.compensation import text
from skiplatch.compensation.compensate import Target
from skiplatch.compensation.firmware import Target as Rule
from skiplatch.compensation.formats import (
    Header,
    c_header,
    header_of,
    nc_program,
    table_csv,
)
from skiplatch.errors import quoted
from skiplatch.units import S_PER_MIN

EPILOG = """\b
Example:
  skiplatch compensate build/radii.csv --v0 50 --tau 12.68 --out build/table.csv
  skiplatch compensate build/radii.csv --v0 100 --tau-from build/speeds.csv \\
      --out build/table.csv --json build/table.json --html build/table.html
  skiplatch compensate --from-campaign build/campaign --v0 100 --out build/table.csv
"""
PATHS = ("skip", "plc")
DIVISIONS = (2, 4, 8, 16, 32)
DEFAULT_DIVISIONS = 16
FIRST_VARIABLE = 500
LARGEST_RADIUS_UM = 1e6


class TargetType(click.ParamType[Target]):
    """``mean``, ``max``, ``min``, or a radius in µm."""

    name = "target"

    def convert(
        self, value: str | Target, param: click.Parameter | None, ctx: click.Context | None
    ) -> Target:
        """See `click.ParamType.convert`."""
        if isinstance(value, Target):
            return value
        rules = {"mean": Rule.MEAN, "max": Rule.MAX, "min": Rule.MIN}
        if value in rules:
            return Target(rules[value])
        radius_um = number_or_nan(value)
        if not abs(radius_um) <= LARGEST_RADIUS_UM:
            expected = "expected mean, max, min or a radius in µm"
            self.fail(f"{expected}, got {quoted(value)}", param, ctx)
        return Target(Rule.GIVEN, radius_um)


@click.command(epilog=EPILOG)
@click.argument("radii", required=False, type=FILE)
@click.option(
    "--from-campaign",
    "campaign",
    type=Source(is_folder=True),
    help="Take map and delay from a recorded campaign in place of RADII.",
)
@click.option("--v0", type=FEED_MM_MIN, required=True, metavar="MM/MIN", help="Feed of the map.")
@click.option(
    "--previous",
    type=FILE,
    metavar="TABLE.csv",
    help="The map was measured at the feeds of this table: iterate.",
)
@click.option("--tau", type=TIME_MS, metavar="MS", help="The delay.")
@click.option(
    "--tau-uncertainty",
    type=TIME_MS,
    metavar="MS",
    help="Standard uncertainty of --tau, which counts as exact without.",
)
@click.option(
    "--tau-from",
    type=FILE,
    metavar="SPEEDS.csv",
    help="Find the delay from mean radii at several feeds.",
)
@click.option(
    "--inside/--outside",
    default=True,
    show_default=True,
    help="SPEEDS.csv was measured inside a ring, where the mean radius grows with the feed, or "
    "outside a sphere, where it falls.",
)
@click.option(
    "--map-inside/--map-outside",
    default=True,
    show_default=True,
    help="RADII holds radii that grow with the pretravel, or distances from the centre of a sphere "
    "touched from outside, which fall.",
)
@click.option(
    "--path",
    type=click.Choice(PATHS),
    help="Of a campaign, the input path whose touches count.  [default: skip, or the only one]",
)
@click.option(
    "--centre",
    type=click.Choice(("fit", "nominal")),
    default="fit",
    show_default=True,
    help="Of a campaign: whether radii are about the best-fit centre or the nominal one.",
)
@click.option(
    "--target",
    type=TargetType(),
    default="mean",
    show_default=True,
    metavar="mean|max|min|UM",
    help="The radius that all directions shall have: the mean, that of the largest or the smallest "
    "pretravel, or a number.",
)
@click.option("--max-feed", type=FEED_MM_MIN, metavar="MM/MIN", help="Fastest measuring feed.")
@click.option("--accel", type=ACCEL_MM_S2, metavar="MM/S²", help="Acceleration of the axes.")
@click.option("--approach", type=LENGTH_MM, metavar="MM", help="From where the feed is set.")
@click.option(
    "--overtravel",
    type=LENGTH_MM,
    metavar="MM",
    help="How far the tip may go on after the contact: delay, reaction and braking.",
)
@click.option("--reaction-ms", type=TIME_MS, metavar="MS", help="From the latch to the braking.")
@click.option(
    "--repeatability",
    type=LENGTH_UM,
    metavar="UM",
    help="Standard deviation of one touch.  [default: from the runs]",
)
@click.option("--resolution", type=LENGTH_UM, metavar="UM", help="Step of the latched position.")
@click.option("--feed-error", type=PERCENT, metavar="PERCENT", help="Largest error of the feed.")
@seed_option
@click.option(
    "-o", "--out", type=OutputFile(), required=True, metavar="TABLE.csv", help="The speed table."
)
@json_option
@click.option(
    "--header", type=OutputFile(), metavar="FILE.h", help="The table for the target, in C."
)
@click.option(
    "--divisions",
    type=click.Choice(DIVISIONS),
    default=DEFAULT_DIVISIONS,
    show_default=True,
    help="How fine the target's table is: M of them make 2·M² + 2·M + 1 bytes.",
)
@click.option(
    "--nc", type=OutputFile(), metavar="FILE.nc", help="The table as variables of a control."
)
@click.option(
    "--nc-first",
    type=CountType(1, 10**6),
    default=FIRST_VARIABLE,
    show_default=True,
    help="Number of the first of these variables.",
)
@html_option
@click.option(
    "--after",
    type=Source(),
    metavar="RADII.csv|DIR",
    help="Radii measured with a table, or a campaign of them, to be shown beside the predicted.",
)
def command(radii: Path | None, json_path: Path | None, **given: Any) -> None:  # noqa: ANN401
    """Find the feeds at which a probe's pretravel is the same in every direction.

    RADII has the columns alpha_deg, beta_deg, run, radius_um; SPEEDS.csv feed_mm_min, run,
    mean_radius_um; TABLE.csv alpha_deg, beta_deg, feed_mm_min. Alpha is the azimuth around the
    probe axis, beta the angle up from the plane across it, 0 to 90.

    A trigger radius is where the tip was when the probe triggered, from the centre: it grows with
    the pretravel inside a ring and falls outside of a sphere, and so does the mean radius with the
    feed. A delay of 0 or less is an error.
    """
    _check_options(radii, given)
    result = result_of(radii, given)
    texts, remarks = _texts(result, radii, given)
    found = text.as_json(result.done, result.figures, result.known, result.after)
    if json_path is not None:
        texts.append((json_path, json_text(found)))
    for path, content in sorted(texts, key=lambda pair: pair[0] == STDOUT):
        write_document(path, content)
    click.echo(text.as_text(result.done, result.figures, result.known, result.after))
    for remark in remarks:
        click.echo(remark)
    for path, _ in texts:
        click.echo(f"wrote {path}")


def _check_options(radii: Path | None, given: Mapping[str, Any]) -> None:
    """Refuse options that do not go together."""
    if (radii is None) == (given["campaign"] is None):
        raise click.UsageError("expected either RADII or --from-campaign")
    if given["tau"] is not None and given["tau_from"] is not None:
        raise click.UsageError("expected either --tau or --tau-from, not both")
    if given["campaign"] is None and given["tau"] is None and given["tau_from"] is None:
        raise click.UsageError("expected --tau or --tau-from")
    if given["tau_uncertainty"] is not None and given["tau"] is None:
        raise click.UsageError("--tau-uncertainty goes with --tau")
    if given["previous"] is not None and given["campaign"] is not None:
        raise click.UsageError("--previous goes with RADII: a campaign holds its own feeds")
    for name in ("overtravel", "approach"):
        if given[name] is not None and given["accel"] is None:
            raise click.UsageError(f"--{name} needs --accel")


def _texts(
    result: Result, radii: Path | None, given: Mapping[str, Any]
) -> tuple[list[tuple[Path, str]], list[str]]:
    """Give the files that are wanted, JSON apart, and what shall stand in them; and remarks."""
    done = result.done
    source = (radii or given["campaign"]).resolve().name
    note = f"{source}: tau {done.delay.tau_ms:.3f} ms, map at {given['v0']:g} mm/min"
    texts = [(given["out"], table_csv(done.probe_map, done.feed_mm_min))]
    remarks: list[str] = []
    try:
        if given["header"] is not None:
            header = header_of(done.probe_map, done.feed_mm_min, given["divisions"])
            name = _identifier(given["header"].stem)
            texts.append((given["header"], c_header(header, name=name, note=note)))
            remarks.append(_nearness(header, done.delay.tau_ms))
        if given["nc"] is not None:
            program = nc_program(
                done.probe_map, done.feed_mm_min, first_variable=given["nc_first"], note=note
            )
            texts.append((given["nc"], program))
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    if given["html_path"] is not None:
        texts.append((given["html_path"], _page(result, source)))
    return texts, remarks


def _nearness(header: Header, tau_ms: float) -> str:
    """Say how near the target's table comes to TABLE.csv, in its directions."""
    um_per_mm_min = tau_ms / S_PER_MIN
    worst, rms = header.error_mm_min, header.rms_error_mm_min
    return (
        f"the header's feeds are within {worst:.2f} mm/min of the table, "
        f"{worst * um_per_mm_min:.2f} µm of radius; "
        f"root mean square {rms:.2f} mm/min, {rms * um_per_mm_min:.2f} µm"
    )


def _identifier(stem: str) -> str:
    """Make a name of C of that of a file."""
    name = re.sub(r"[^a-z0-9_]", "_", stem.lower())
    return name if name[:1].isalpha() else f"probe_{name}"


def _page(result: Result, name: str) -> str:
    # Drawing takes time to load, which only those pay who want a page.
    from skiplatch.report.compensation import After, as_html  # noqa: PLC0415

    after = None
    if result.after_map is not None and result.after is not None:
        after = After(result.after_map, result.after)
    return as_html(result.done, result.figures, result.known, after, name=name)
