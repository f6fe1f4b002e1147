"""``skiplatch adopt``: what a diagnosis found becomes part of what is believed of the rig."""

from dataclasses import replace
from pathlib import Path

import click

from skiplatch.campaign import (
    NOMINAL_FILE,
    TOUCHES_FILE,
    fingerprint,
    read_campaign,
    read_nominal,
)
from skiplatch.commands.inputs import FILE, Source
from skiplatch.commands.options import json_option, other_touches_option, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.diagnosis.reported.adoption import adopted, with_effects
from skiplatch.diagnosis.reported.belonging import refuse_of_others
from skiplatch.diagnosis.reported.schema import read_diagnosis_json
from skiplatch.files import atomic_write_text
from skiplatch.played_files import all_faults_told
from skiplatch.stand_ins import refuse_unplayable

EPILOG = """\b
Example:
  skiplatch diagnose scripts/samples/bench_isr_latency --json build/diagnosis.json
  skiplatch adopt scripts/samples/bench_isr_latency \\
      --diagnosis build/diagnosis.json --out build/adopted.toml
"""


@click.command(epilog=EPILOG)
@click.argument("campaign", type=Source())
@click.option("--diagnosis", type=FILE, required=True, help="JSON of a diagnosis of the campaign.")
@click.option("-o", "--out", type=OutputFile(), required=True, help="nominal.toml to write.")
@other_touches_option
@json_option
def command(
    *, campaign: Path, diagnosis: Path, out: Path, other_touches: bool, json_path: Path | None
) -> None:
    """Write the effects that a diagnosis of a CAMPAIGN found into the beliefs about the rig.

    The new nominal.toml is that of the campaign, comments and all, with a table [[effect]] for each
    of them. Every command then plays the rig as it is, and the next diagnosis starts from there.
    An effect that ended by itself is left out. Adopting again what is believed changes nothing. A
    diagnosis of other touches is refused; --other-touches takes one of the same rig, such as that
    of an earlier campaign.
    """
    path = campaign / NOMINAL_FILE
    with all_faults_told(path):
        nominal = read_nominal(path)
        refuse_unplayable(path, nominal)
    found = read_diagnosis_json(diagnosis, adopted)
    if not other_touches and (campaign / TOUCHES_FILE).exists():
        known_as = fingerprint(read_campaign(campaign).touches)
        refuse_of_others(diagnosis, campaign, known_as)
    refuse_unplayable(diagnosis, replace(nominal, believed_effects=tuple(found)))
    atomic_write_text(out, with_effects(path, nominal, found))
    names = [effect.id for effect in found]
    click.echo(f"{out}: {', '.join(names) if names else 'nothing to adopt'}")
    write_json(json_path, {"out": str(out), "effects": names})
