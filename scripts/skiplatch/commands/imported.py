"""What ``skiplatch import`` writes and says, whatever it has read."""

from pathlib import Path

import click
import numpy as np

from skiplatch.campaign import Campaign, InputPath, Kind, read_campaign
from skiplatch.campaign.plausibility import oddities
from skiplatch.campaign.telling import cannot_be_told
from skiplatch.commands.inputs import FILE
from skiplatch.commands.options import Decorator, write_json
from skiplatch.importing.model import Imported
from skiplatch.importing.writing import write_imported
from skiplatch.tables import counted, prose
from skiplatch.touched_often import touches_repeat

path_option: Decorator = click.option(
    "--path",
    type=click.Choice([path.name.lower() for path in InputPath]),
    help="What latched: the skip input, or a PLC task that polls; else as such controllers do.",
)
nominal_option: Decorator = click.option(
    "--nominal",
    "nominal_path",
    type=FILE,
    help="nominal.toml of a campaign of the same rig: what is believed of it, in place of what "
    "the log and the kind of controller say.",
)


def finish(
    imported: Imported,
    sources: tuple[Path, ...],
    out: Path,
    json_path: Path | None,
    *,
    path: str | None = None,
    nominal_path: Path | None = None,
) -> None:
    """Write the campaign and say what is in it."""
    if path is not None:
        imported.path_is_plc = path == InputPath.PLC.name.lower()
    write_imported(out, imported, sources, nominal_path)
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
    n = counted(len(campaign.touches), "touch")
    click.echo(f"wrote {out}: {campaign.nominal.kind} campaign, {n}")
    for head, lines in parts:
        if lines:
            click.echo(f"\n{head}")
            for line in lines:
                click.echo(prose(f"  {line}"))
    click.echo(f"\nNext: {_next(campaign, out)}")
    said = {name.lower().replace(" ", "_"): lines for name, lines in parts}
    about = {"out": str(out), "kind": campaign.nominal.kind, "touches": len(campaign.touches)}
    write_json(json_path, {**about, **said})


def _next(campaign: Campaign, out: Path) -> str:
    """Name the commands that take the campaign; a machine's diagnosis needs every feed."""
    steps = [f"skiplatch check {out}"]
    if touches_repeat(campaign):
        steps.append(f"skiplatch repeat {out}")
    is_touch = campaign.nominal.kind is Kind.MACHINE and not campaign.nominal.datum.is_at_rest
    if is_touch and np.isnan(campaign.touches.feed_mm_min).any():
        return (
            f"{', '.join(steps)}; skiplatch diagnose needs the feed: import once more with --feed"
        )
    return ", ".join([*steps, f"skiplatch diagnose {out}"])
