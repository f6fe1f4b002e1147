"""``skiplatch fleet report``: a fleet as one page."""

from pathlib import Path

import click

from skiplatch.commands.fleet_options import days_option, plain, rate_option, store_option
from skiplatch.commands.numbers import CountType
from skiplatch.commands.options import html_option, json_option, write_document, write_json
from skiplatch.fleet.findings import as_json, find
from skiplatch.fleet.history import read_history
from skiplatch.fleet.reading import opened
from skiplatch.tables import counted

EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet report --store build/store --html build/fleet.html
"""


@click.command(epilog=EPILOG)
@store_option
@html_option
@json_option
@click.option(
    "--weeks",
    type=CountType(1, 520),
    default=52,
    show_default=True,
    help="How many of the newest weeks the page shows.",
)
@days_option
@rate_option
def command(
    store: Path,
    html_path: Path | None,
    json_path: Path | None,
    weeks: int,
    days: float,
    alarms_a_month: float,
) -> None:
    """Show the rigs by weeks, with the gap, the guilty stage and what to do next.

    One page that needs nothing else: --html. What has changed is what fleet check says.
    """
    from skiplatch.report.fleet import as_html  # noqa: PLC0415 - loads the pictures' colours

    if html_path is None and json_path is None:
        raise click.UsageError("--html names the page to write; or --json")
    with opened(store, with_touches=False) as reader:
        history = read_history(reader)
    findings = find(history, days=days, alarms_a_month=alarms_a_month)
    write_json(json_path, plain(as_json(findings)))
    if html_path is not None:
        write_document(html_path, as_html(findings, store=store.resolve().name, weeks=weeks))
        changed = len({change.rig for change in findings.recent})
        rigs = counted(findings.rigs, "rig")
        click.echo(f"{html_path}: {rigs}, {changed} changed in the last {counted(days, 'day')}")
