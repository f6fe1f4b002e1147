"""``skiplatch repeat``: how well touches repeat, without any nominal."""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from skiplatch.campaign import Campaign, InputPath, read_campaign
from skiplatch.commands.inputs import Source
from skiplatch.commands.options import html_option, json_option, write_document, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.commands.units import is_inch, units_option
from skiplatch.errors import InputError
from skiplatch.importing.detect import read_any
from skiplatch.importing.writing import write_imported
from skiplatch.latch.text import TITLES
from skiplatch.repeatability import Repeatability, by_path
from skiplatch.repeatability_words import OfPath, an_hour, rows_of, sentence
from skiplatch.tables import counted, prose, table

SHOWN = 12
OWN_OPTIONS = {"--units"}
OPTIONS_OF_IMPORT = "of skiplatch import, whose folder repeat reads as well"
_TOLD = {"first": "first_touch", "order": "drift", "axis": "axis_drift", "speed": "slope"}
EPILOG = """\b
Example:
  skiplatch repeat tests/python/data/logs/klipper_octoprint.log
  skiplatch repeat tests/python/data/logs/klippy.log --html build/repeat.html
"""


@click.command(epilog=EPILOG)
@click.argument("source", type=Source(), metavar="FILE|DIR")
@click.option(
    "--picture",
    type=OutputFile(makes_folders=True),
    help="Draw the touches one after the other into this SVG file.",
)
@units_option
@html_option
@json_option
def command(
    source: Path,
    picture: Path | None,
    units: str | None,
    html_path: Path | None,
    json_path: Path | None,
) -> None:
    """Say how well touches of one surface repeat, from a campaign or straight from a log.

    Nothing is believed of the rig: mean, scatter, drift from touch to touch and per kelvin, the
    first touch apart, outliers by number, and the slope with the feed in ms, which is a delay. With
    95 % intervals. Positive is further along the approach. Of a bench without motion, the times
    from edge to latch. Where touches were latched by a skip input and by a PLC task, each has
    figures of its own.
    """
    campaign, head, assumed = _read(source, inch=is_inch(units))
    shown = _shown(campaign)
    click.echo(head)
    for one in shown:
        click.echo(prose(f"\n{_text(one)}"))
    for path in _untold(campaign, shown):
        click.echo(f"\n{path}: no surface was touched often enough")
    if assumed:
        click.echo("\n".join(("", "Assumed", *(prose(f"  {line}") for line in assumed))))
    write_json(json_path, {"source": str(source), **document(shown), "assumed": assumed})
    # Drawing takes time to load, which only those pay who want a picture.
    if html_path is not None:
        from skiplatch.report.repeatability import as_html  # noqa: PLC0415

        write_document(html_path, as_html(shown, name=source.name))
    if picture is not None:
        from skiplatch.figures.repeatability import draw_repeatability  # noqa: PLC0415

        draw_repeatability(picture, shown)
        click.echo(f"wrote {picture}")


def _shown(campaign: Campaign) -> list[OfPath]:
    """Give what is shown of each input path; one alone needs no name."""
    is_alone = len(np.unique(campaign.touches.path)) == 1
    return [
        OfPath(path, "" if is_alone else _title(path), found, sentence(found), rows_of(found))
        for path, found in by_path(campaign).items()
    ]


def _title(path: InputPath) -> str:
    return TITLES[path][0].upper() + TITLES[path][1:]


def _untold(campaign: Campaign, shown: Sequence[OfPath]) -> list[str]:
    """Name the paths that were touched, but too seldom."""
    told = {one.path for one in shown}
    there = (path for path in InputPath if (campaign.touches.path == path).any())
    return [_title(path) for path in there if path not in told]


def _text(shown: OfPath) -> str:
    """Say what the touches of a path show."""
    found = shown.found
    said = f"{shown.title}: {shown.sentence}" if shown.title else shown.sentence
    text = f"{said}\n\n{table(('', 'found', '95 % interval'), shown.figures)}"
    if not found.outliers:
        return text
    listed = ", ".join(str(touch) for touch in found.outliers[:SHOWN])
    more = len(found.outliers) - SHOWN
    listed += f" and {more} more" if more > 0 else ""
    return f"{text}\n\noutliers: touches {listed}; the first touch is {min(found.touches)}"


def _read(source: Path, *, inch: bool | None) -> tuple[Campaign, str, list[str]]:
    """Give the campaign, what it was read from, and what was assumed of a log."""
    assumed: list[str] = []
    if source.is_dir():
        if inch is not None:
            message = "a campaign is in mm, whatever its log was in: leave out --units"
            raise InputError(source, None, None, message)
        campaign = read_campaign(source)
        kind = f"{campaign.nominal.kind} campaign"
    else:
        name, imported = read_any(source, inch=inch)
        with tempfile.TemporaryDirectory(prefix="skiplatch-") as folder:
            write_imported(Path(folder) / "made", imported, (source,))
            campaign = replace(read_campaign(Path(folder) / "made"), path=source)
        kind, assumed = f"log of {name}", imported.assumed
        if others := [option for option in imported.options if option not in OWN_OPTIONS]:
            assumed = [*assumed, f"{', '.join(others)}: {OPTIONS_OF_IMPORT}"]
    return campaign, f"{source}: {kind}, {counted(len(campaign.touches), 'touch')}", assumed


def document(shown: Sequence[OfPath]) -> dict[str, Any]:
    """Give it for programs: figures of the skip input, or of the only path; and those of each."""
    paths = {
        one.path.name.lower(): {**as_json(one.found), "sentence": one.sentence} for one in shown
    }
    return {**next(iter(paths.values())), "paths": paths}


def as_json(found: Repeatability) -> dict[str, Any]:
    """Give a path's figures; names end with the unit: um, arcsec of rotary axes, us on a bench."""
    unit = found.unit.replace("µ", "u")
    figures = {
        f"mean_{unit}": found.mean,
        f"sigma_{unit}": found.sigma,
        f"sigma_without_temperature_{unit}": found.sigma_without_temperature,
        f"sigma_in_a_row_{unit}": found.in_a_row.sigma if found.in_a_row else None,
        f"reversal_{unit}": found.reversal.mean if found.reversal else None,
        f"first_touch_{unit}": found.first,
        f"drift_{unit}_per_touch": found.drift,
        f"axis_drift_{unit}_per_touch": found.axis_drift,
        f"drift_{unit}_per_h": an_hour(found, found.drift),
        f"axis_drift_{unit}_per_h": an_hour(found, found.axis_drift),
        "slope_ms": found.slope,
        **{f"drift_{unit}_per_k_{name}": slope for name, slope in found.per_kelvin.items()},
    }
    document: dict[str, Any] = {"n": len(found.touches), "surfaces": found.surfaces}
    for name, figure in figures.items():
        document[name] = None if figure is None else figure.value
        document[f"{name}_interval"] = None if figure is None else [figure.low, figure.high]
    return document | {
        f"range_{unit}": found.range,
        f"widest_reversal_{unit}": found.reversal.widest if found.reversal else None,
        f"plain_sigma_{unit}": found.plain,
        "thermometer": found.warmest or None,
        "told": sorted(_TOLD[name] for name in found.told),
        "outliers": list(found.outliers),
        "missed": found.missed,
        "false": found.false,
        f"resolution_{unit}": found.step,
        "limited_by_resolution": found.is_limited_by_resolution,
    }
