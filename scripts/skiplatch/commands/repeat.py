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
from skiplatch.importing.detect import read_any
from skiplatch.importing.writing import write_imported
from skiplatch.latch.text import TITLES
from skiplatch.repeatability import OfPath, Repeatability, by_path
from skiplatch.statistics import Interval
from skiplatch.tables import number, table, with_interval

SHOWN = 12
MOST_OUTSIDE = 0.25  # of the touches; more of them are no outliers
DIFFERS = 0.1  # of the plain standard deviation; less makes no other figure
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
@html_option
@json_option
def command(
    source: Path, picture: Path | None, html_path: Path | None, json_path: Path | None
) -> None:
    """Say how well touches of one surface repeat, from a campaign or straight from a log.

    Nothing is believed of the rig: mean, scatter, drift from touch to touch and per kelvin, the
    first touch apart, outliers by number, and the slope with the feed in ms, which is a delay. With
    95 % intervals. Positive is further along the approach. Of a bench without motion, the times
    from edge to latch. Where touches were latched by a skip input and by a PLC task, each has
    figures of its own.
    """
    campaign, head, assumed = _read(source)
    shown = _shown(campaign)
    click.echo(head)
    for one in shown:
        click.echo(f"\n{_text(one)}")
    for path in _untold(campaign, shown):
        click.echo(f"\n{path}: no surface was touched often enough")
    if assumed:
        click.echo("\n".join(("", "Assumed", *(f"  {line}" for line in assumed))))
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
        OfPath(path, "" if is_alone else _title(path), found, sentence(found), _rows(found))
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


def _read(source: Path) -> tuple[Campaign, str, list[str]]:
    """Give the campaign, what it was read from, and what was assumed of a log."""
    assumed: list[str] = []
    if source.is_dir():
        campaign = read_campaign(source)
        kind = f"{campaign.nominal.kind} campaign"
    else:
        name, imported = read_any(source)
        with tempfile.TemporaryDirectory(prefix="skiplatch-") as folder:
            write_imported(Path(folder) / "made", imported, (source,))
            campaign = replace(read_campaign(Path(folder) / "made"), path=source)
        kind, assumed = f"log of {name}", imported.assumed
    return campaign, f"{source}: {kind}, {len(campaign.touches)} touches", assumed


def sentence(found: Repeatability) -> str:
    """Say it in one sentence."""
    unit = found.unit
    parts = [f"{_what(found)} by σ = {_words(found.sigma, unit)}"]
    if found.is_limited_by_resolution:
        step = f" of {found.step:.4g} {unit}" if found.step else ""
        parts.append(f"that is limited by the resolution{step}")
    if found.slope is not None and "speed" in found.told:
        sense = "later" if found.slope.value > 0.0 else "earlier"
        parts.append(f"they come {sense} with the feed, by {_words(found.slope, 'ms')}")
    if found.first is not None and "first" in found.told:
        way = way_of(found, found.first.value, ("higher", "lower"))
        parts.append(f"the first of a series is off by {_words(found.first, unit)}, {way}")
    if found.drift is not None and "order" in found.told:
        way = way_of(found, found.drift.value, ("rises", "falls"))
        parts.append(f"they drift {_drift(found, found.drift)}, {way}")
    if found.axis_drift is not None and "axis" in found.told:
        way = "up" if found.axis_drift.value > 0.0 else "down"
        parts.append(f"the axis drifts {way}, {_drift(found, found.axis_drift)}")
    parts += _without_warmth(found)
    if found.outliers:
        parts.append(_outside(len(found.outliers), len(found.touches)))
    parts += _all_in(found)
    if found.missed:
        parts.append(f"besides, {found.missed} {_were(found.missed)} missed")
    if found.false:
        parts.append(f"besides, {found.false} {_were(found.false)} latched without a contact")
    return "; ".join(parts) + "."


def _without_warmth(found: Repeatability) -> list[str]:
    """Say what scatter the temperature leaves, where touches go with it and that is less."""
    warmth = found.warmth.get(found.warmest)
    if not warmth or warmth.sigma.value > (1.0 - DIFFERS) * found.sigma.value:
        return []
    slope = f"by {_words(warmth.slope, f'{found.unit}/K')}"
    sigma = f"σ = {_words(warmth.sigma, found.unit)}"
    return [f"they go with the temperature ({found.warmest}), {slope}, and without that {sigma}"]


def _all_in(found: Repeatability) -> list[str]:
    """Give the plain standard deviation where it is another one, as controllers print it."""
    if not differs(found):
        return []
    return [f"all touches as they are scatter by {number(found.plain, 3)} {found.unit}"]


def differs(found: Repeatability) -> bool:
    """Tell whether lines, first touches or outliers make the scatter another one."""
    return abs(found.plain - found.sigma.value) > DIFFERS * found.plain


def way_of(found: Repeatability, value: float, words: tuple[str, str]) -> str:
    """Say in words which way a figure along the approach goes; of an axis that is known, its own.

    Args:
        found: Of which touches.
        value: Positive is further along the approach, or later.
        words: Of the axis where its coordinate is larger, and smaller.
    """
    if found.unit == "µs":
        return "later" if value > 0.0 else "earlier"
    if found.coordinate and not found.is_directed:
        return f"{found.coordinate} {words[0 if value > 0.0 else 1]}"
    way = "further along the approach" if value > 0.0 else "less far along the approach"
    if not found.coordinate or not found.sense:
        return way
    return f"{way} ({found.coordinate} {words[0 if value * found.sense > 0.0 else 1]})"


def _were(n: int) -> str:
    return "was" if n == 1 else "were"


def _outside(n: int, touches: int) -> str:
    if n > MOST_OUTSIDE * touches:
        return (
            f"{n} lie apart from the others: what is taken for one condition are two, "
            "such as two feeds that were not recorded, or two input paths"
        )
    return f"{n} {'lies' if n == 1 else 'lie'} far outside"


def _what(found: Repeatability) -> str:
    n = len(found.touches)
    if found.unit == "µs":
        return f"{n} latches come {_words(found.mean, 'µs')} after their edges and scatter"
    surfaces = "one surface" if found.surfaces == 1 else f"{found.surfaces} surfaces"
    return f"{n} touches of {surfaces} scatter"


def _drift(found: Repeatability, drift: Interval) -> str:
    """Say how fast touches drift, by what they go with."""
    an_hour = _an_hour(found, drift)
    if an_hour is None:
        return f"by {_words(drift, found.unit)} a touch"
    return f"with time, by {_words(an_hour, found.unit)} an hour"


def _an_hour(found: Repeatability, drift: Interval | None) -> Interval | None:
    """Give a drift an hour; None where it goes by the number of the touch."""
    rate = found.touches_per_h
    if drift is None or rate is None:
        return None
    return Interval(drift.value * rate, drift.low * rate, drift.high * rate)


def _words(figure: Interval, unit: str) -> str:
    value, interval = with_interval(figure)
    return f"{value} {unit} ({interval})"


def _drift_rows(found: Repeatability) -> list[tuple[str, Interval | None]]:
    drifts = {"drift": found.drift, "drift of the axis": found.axis_drift}
    if found.touches_per_h is None:
        return [(f"{name}, {found.unit}/touch", drift) for name, drift in drifts.items()]
    return [(f"{name}, {found.unit}/h", _an_hour(found, drift)) for name, drift in drifts.items()]


def _rows(found: Repeatability) -> list[tuple[str, ...]]:
    unit = found.unit
    mean = "mean from edge to latch" if unit == "µs" else "mean deviation"
    figures: list[tuple[str, Interval | None]] = [
        (f"{mean}, {unit}", found.mean),
        (f"σ, {unit}", found.sigma),
        (f"first touch, {unit}", found.first),
        *_drift_rows(found),
        ("slope with the feed, ms", found.slope),
        *((f"drift by {name}, {unit}/K", slope) for name, slope in found.per_kelvin.items()),
    ]
    rows: list[tuple[str, ...]] = [
        (name, *with_interval(figure)) for name, figure in figures if figure is not None
    ]
    if differs(found):
        rows.insert(2, (f"σ of all as they are, {unit}", number(found.plain, 3), ""))
    rows.insert(2, (f"widest range, {unit}", f"{found.range:.4g}", ""))
    return rows


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
        f"first_touch_{unit}": found.first,
        f"drift_{unit}_per_touch": found.drift,
        f"axis_drift_{unit}_per_touch": found.axis_drift,
        f"drift_{unit}_per_h": _an_hour(found, found.drift),
        f"axis_drift_{unit}_per_h": _an_hour(found, found.axis_drift),
        "slope_ms": found.slope,
        **{f"drift_{unit}_per_k_{name}": slope for name, slope in found.per_kelvin.items()},
    }
    document: dict[str, Any] = {"n": len(found.touches), "surfaces": found.surfaces}
    for name, figure in figures.items():
        document[name] = None if figure is None else figure.value
        document[f"{name}_interval"] = None if figure is None else [figure.low, figure.high]
    return document | {
        f"range_{unit}": found.range,
        f"plain_sigma_{unit}": found.plain,
        "thermometer": found.warmest or None,
        "told": sorted(_TOLD[name] for name in found.told),
        "outliers": list(found.outliers),
        "missed": found.missed,
        "false": found.false,
        f"resolution_{unit}": found.step,
        "limited_by_resolution": found.is_limited_by_resolution,
    }
