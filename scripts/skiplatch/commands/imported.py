"""What ``skiplatch import`` writes and says, whatever it has read."""

from pathlib import Path

import click
import numpy as np

from skiplatch.campaign import Campaign, Kind, read_campaign
from skiplatch.campaign.plausibility import oddities
from skiplatch.campaign.telling import cannot_be_told
from skiplatch.commands.options import write_json
from skiplatch.importing.model import Imported
from skiplatch.importing.writing import write_imported


def finish(
    imported: Imported, sources: tuple[Path, ...], out: Path, json_path: Path | None
) -> None:
    """Write the campaign and say what is in it."""
    write_imported(out, imported, sources)
    campaign = read_campaign(out)
    untold = cannot_be_told(campaign)
    lines = [oddity.line for oddity in oddities(campaign)]
    odd = [line for line in lines if line not in imported.assumed]
    parts = (
        ("Known", imported.known),
        ("Assumed", imported.assumed),
        ("Could not be read", imported.unread),
        ("Odd", odd),
        ("Cannot be told from it", untold),
    )
    click.echo(f"wrote {out}: {campaign.nominal.kind} campaign, {len(campaign.touches)} touches")
    for head, lines in parts:
        if lines:
            click.echo(f"\n{head}")
            for line in lines:
                click.echo(f"  {line}")
    click.echo(f"\nNext: {_next(campaign, out)}")
    said = {name.lower().replace(" ", "_"): lines for name, lines in parts}
    about = {"out": str(out), "kind": campaign.nominal.kind, "touches": len(campaign.touches)}
    write_json(json_path, {**about, **said})


def _next(campaign: Campaign, out: Path) -> str:
    """Name the commands that take the campaign; a machine's diagnosis needs every feed."""
    steps = [f"skiplatch check {out}", f"skiplatch repeat {out}"]
    is_machine = campaign.nominal.kind is Kind.MACHINE
    if is_machine and np.isnan(campaign.touches.feed_mm_min).any():
        return (
            f"{', '.join(steps)}; skiplatch diagnose needs the feed: import once more with --feed"
        )
    return ", ".join([*steps, f"skiplatch diagnose {out}"])
