"""A small fleet for the demo: weeks of simulated rigs, of which one wears, diagnosed and kept."""

import os
import tempfile
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime, timedelta
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from skiplatch.api.work import simulate
from skiplatch.campaign import TOUCHES_FILE, Campaign, read_campaign, write_campaign
from skiplatch.commands.diagnose_many import tell_all
from skiplatch.commands.examining import Asked
from skiplatch.commands.fleet_options import plain
from skiplatch.commands.kept import Kept
from skiplatch.commands.options import json_text
from skiplatch.files import atomic_write_text
from skiplatch.fleet.budget import ALARMS_A_MONTH
from skiplatch.fleet.diagnosed import DIAGNOSIS_FILE
from skiplatch.fleet.engine import MISSING
from skiplatch.fleet.findings import as_json, change_text, find
from skiplatch.fleet.history import read_history
from skiplatch.fleet.reading import opened
from skiplatch.fleet.store import opened_for_writing
from skiplatch.simulator.effects import Effect
from skiplatch.workers import Workers

RIGS, WEEKS = ("mill-1", "mill-2", "mill-3"), 7
WORN, WORN_SINCE = "mill-2", 5
WEAR = Effect("backlash", {"backlash_um": 8.0})
TOUCHES = 60
FIRST_WEEK = datetime(2026, 1, 5, 6, tzinfo=UTC)
NEWS_DAYS = 31.0


def show_fleet(sample: Path, page: Path, *, seed: int, jobs: int) -> Mapping[str, Any]:
    """Let rigs touch for some weeks, say which has changed, and write the page of the fleet.

    Args:
        sample: A campaign, of whose rig there are several.
        page: The page to write.
        seed: Picks the random numbers.
        jobs: Campaigns that are diagnosed at a time.
    """
    if find_spec("duckdb") is None:
        click.echo(f"no page of a fleet: duckdb is {MISSING}")
        return {}
    # Loads the colours of the pictures, which nothing else of the fleet needs.
    from skiplatch.report.fleet import as_html  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as temporary:
        recorded = list(_weeks(read_campaign(sample), Path(temporary), seed))
        told = tell_all(recorded, Asked(seed=seed), Workers(jobs=jobs), Kept(None))
        store = Path(temporary) / "store"
        with opened_for_writing(store) as writer:
            for campaign, one in zip(recorded, told, strict=True):
                atomic_write_text(campaign.path / DIAGNOSIS_FILE, json_text(one.document))
                writer.add(campaign.path)
            writer.commit()
        with opened(store, with_touches=False) as reader:
            history = read_history(reader)
    findings = find(history, days=NEWS_DAYS, alarms_a_month=ALARMS_A_MONTH)
    for change in findings.recent:
        click.echo(change_text(change))
    page.parent.mkdir(parents=True, exist_ok=True)
    atomic_write_text(page, as_html(findings, store="demo", weeks=WEEKS))
    found: Mapping[str, Any] = plain(as_json(findings))
    return found


def _weeks(sample: Campaign, folder: Path, seed: int) -> Iterator[Campaign]:
    """Simulate a campaign of each rig and week, and write it as if it came from there."""
    step = -(-len(sample.touches) // TOUCHES)
    conditions = sample.touches.select(slice(None, None, step))
    for week in range(WEEKS):
        for number, rig in enumerate(RIGS):
            effects = [WEAR] if rig == WORN and week >= WORN_SINCE else []
            played = simulate(
                sample, conditions, effects=effects, seed=seed + len(RIGS) * week + number
            )
            place = folder / rig / f"week-{week + 1}"
            write_campaign(place, played.nominal, played.touches)
            recorded_s = (FIRST_WEEK + week * timedelta(weeks=1)).timestamp()
            os.utime(place / TOUCHES_FILE, (recorded_s, recorded_s))
            yield read_campaign(place)
