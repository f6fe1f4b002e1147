"""``skiplatch repeat``: how well touches repeat, without any nominal."""

import tempfile
from pathlib import Path
from typing import Any

import click

from skiplatch.campaign import Campaign, read_campaign
from skiplatch.commands.options import json_option, write_json
from skiplatch.importing.detect import read_any
from skiplatch.importing.writing import write_imported
from skiplatch.repeatability import Repeatability, repeatability
from skiplatch.statistics import Interval
from skiplatch.tables import table, with_interval

SHOWN = 12
EPILOG = """\b
Example:
  skiplatch repeat scripts/samples/machine_no_gap
  skiplatch repeat klippy.log --picture build/repeat.svg
"""


@click.command(epilog=EPILOG)
@click.argument("source", type=click.Path(path_type=Path), metavar="FILE|DIR")
@click.option(
    "--picture",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Draw the touches one after the other into this SVG file.",
)
@json_option
def command(source: Path, picture: Path | None, json_path: Path | None) -> None:
    """Say how well touches of one surface repeat, from a campaign or straight from a log.

    Nothing is believed of the rig: mean, scatter, drift from touch to touch and per kelvin, the
    first touch apart, outliers by number, and the slope with the feed in ms, which is a delay. With
    95 % intervals.
    """
    campaign, head = _read(source)
    found = repeatability(campaign)
    said = sentence(found)
    click.echo(f"{head}\n\n{said}\n")
    click.echo(table(("", "found", "95 % interval"), _rows(found)))
    if found.outliers:
        shown = ", ".join(str(touch) for touch in found.outliers[:SHOWN])
        more = len(found.outliers) - SHOWN
        click.echo(f"\noutliers: touches {shown}{f' and {more} more' if more > 0 else ''}")
    write_json(json_path, {"source": str(source), **as_json(found), "sentence": said})
    if picture is not None:
        # Drawing takes time to load, which only those pay who want a picture.
        from skiplatch.figures.repeatability import draw_repeatability  # noqa: PLC0415

        draw_repeatability(picture, found, said)
        click.echo(f"wrote {picture}")


def _read(source: Path) -> tuple[Campaign, str]:
    if source.is_dir():
        campaign = read_campaign(source)
        kind = f"{campaign.nominal.kind} campaign"
    else:
        name, imported = read_any(source)
        with tempfile.TemporaryDirectory(prefix="skiplatch-") as folder:
            write_imported(Path(folder) / "made", imported, (source,))
            campaign = read_campaign(Path(folder) / "made")
        kind = f"log of {name}"
    return campaign, f"{source}: {kind}, {len(campaign.touches)} touches"


def sentence(found: Repeatability) -> str:
    """Say it in one sentence."""
    sigma = _words(found.sigma, "µm")
    surfaces = "one surface" if found.surfaces == 1 else f"{found.surfaces} surfaces"
    parts = [f"{len(found.touches)} touches of {surfaces} scatter by σ = {sigma}"]
    if found.is_limited_by_resolution:
        step = f" of {found.step_um:.4g} µm" if found.step_um else ""
        parts.append(f"that is limited by the resolution{step}")
    if _shows(found.slope):
        parts.append(f"they come later with the feed, by {_words(found.slope, 'ms')}")
    if _shows(found.first):
        parts.append(f"the first of a series is off by {_words(found.first, 'µm')}")
    if _shows(found.drift):
        parts.append(f"they drift by {_words(found.drift, 'µm')} a touch")
    if found.outliers:
        n = len(found.outliers)
        parts.append(f"{n} {'lies' if n == 1 else 'lie'} far outside")
    return "; ".join(parts) + "."


def _words(figure: Interval | None, unit: str) -> str:
    if figure is None:
        return "an unknown amount"
    value, interval = with_interval(figure)
    return f"{value} {unit} ({interval})"


def _shows(figure: Interval | None) -> bool:
    return figure is not None and (figure.low > 0.0 or figure.high < 0.0)


def _rows(found: Repeatability) -> list[tuple[str, ...]]:
    figures: list[tuple[str, Interval | None]] = [
        ("mean deviation, µm", found.mean),
        ("σ, µm", found.sigma),
        ("first touch, µm", found.first),
        ("drift, µm/touch", found.drift),
        ("slope with the feed, ms", found.slope),
        *((f"drift by {name}, µm/K", slope) for name, slope in found.per_kelvin.items()),
    ]
    rows: list[tuple[str, ...]] = [
        (name, *with_interval(figure)) for name, figure in figures if figure is not None
    ]
    rows.insert(2, ("widest range, µm", f"{found.range_um:.4g}", ""))
    return rows


def as_json(found: Repeatability) -> dict[str, Any]:
    """Give it for programs."""
    figures = {
        "mean_um": found.mean,
        "sigma_um": found.sigma,
        "first_touch_um": found.first,
        "drift_um_per_touch": found.drift,
        "slope_ms": found.slope,
        **{f"drift_um_per_k_{name}": slope for name, slope in found.per_kelvin.items()},
    }
    document: dict[str, Any] = {"n": len(found.touches), "surfaces": found.surfaces}
    for name, figure in figures.items():
        document[name] = None if figure is None else figure.value
        document[f"{name}_interval"] = None if figure is None else [figure.low, figure.high]
    return document | {
        "range_um": found.range_um,
        "outliers": list(found.outliers),
        "resolution_um": found.step_um,
        "limited_by_resolution": found.is_limited_by_resolution,
    }
