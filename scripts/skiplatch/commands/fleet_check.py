"""``skiplatch fleet check``: which rigs have changed."""

from pathlib import Path

import click

from skiplatch.commands.fleet_options import days_option, plain, rate_option, store_option
from skiplatch.commands.options import json_option, write_document, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.fleet.findings import (
    Findings,
    as_json,
    change_text,
    find,
    left_out_text,
    shared_text,
    unjudged_texts,
    unlike_text,
)
from skiplatch.fleet.history import read_history
from skiplatch.fleet.machine_texts import junit_xml, open_metrics
from skiplatch.fleet.reading import opened
from skiplatch.tables import counted

CHANGED = 1
"""Exit status if a rig has changed."""
EPILOG = """\b
Example:
  skiplatch fleet add scripts/samples/rig_nominal --rig bench-1 --store build/store
  skiplatch fleet check --store build/store --metrics build/fleet.prom
"""


@click.command(epilog=EPILOG)
@store_option
@days_option
@rate_option
@json_option
@click.option(
    "--junit", "junit_path", type=OutputFile(), help="Also write a test case a rig as JUnit XML."
)
@click.option(
    "--metrics",
    "metrics_path",
    type=OutputFile(),
    help="Also write gauges as OpenMetrics text, for Prometheus.",
)
@click.pass_context
def command(
    ctx: click.Context,
    store: Path,
    days: float,
    alarms_a_month: float,
    json_path: Path | None,
    junit_path: Path | None,
    metrics_path: Path | None,
) -> None:
    """Say which rigs have changed, a line each, and end with exit status 1 if any has.

    A rig has changed if the gap of its newest campaigns is not that of those before. For a nightly
    job: docs/FLEET.md says how it is told from chance, and how often that errs.
    """
    with opened(store, with_touches=False) as reader:
        history = read_history(reader)
    findings = find(history, days=days, alarms_a_month=alarms_a_month)
    _say(findings, days)
    write_json(json_path, plain(as_json(findings)))
    if junit_path:
        write_document(junit_path, junit_xml(findings))
    if metrics_path:
        write_document(metrics_path, open_metrics(findings))
    if findings.recent:
        ctx.exit(CHANGED)


def _say(findings: Findings, days: float) -> None:
    for change in findings.recent:
        click.echo(change_text(change))
    for shared in findings.shared:
        click.echo(f"shared cause: {shared_text(shared)}")
    for unlike in findings.unlike:
        click.echo(f"unlike the others: {unlike_text(unlike)}")
    for words in unjudged_texts(findings):
        click.echo(f"not judged: {words}")
    changed = len({change.rig for change in findings.recent})
    rigs, left = counted(findings.rigs, "rig"), left_out_text(findings)
    words = f"{rigs}, {changed} changed in the last {counted(days, 'day')}"
    click.echo("; ".join(filter(None, (words, left))))
