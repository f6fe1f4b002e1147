"""``skiplatch predict``: conditions and a diagnosis in, predictions out."""

from pathlib import Path

import click

from skiplatch.admitted import REPLICATES
from skiplatch.api.predicted import predicted
from skiplatch.campaign import NOMINAL_FILE, Nominal, read_campaign, read_nominal
from skiplatch.commands.inputs import FILE, Source
from skiplatch.commands.numbers import CountType
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.commands.outputs import OutputFile
from skiplatch.diagnosis import rig_from_json
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.reported.schema import read_diagnosis_json
from skiplatch.files import atomic_write_text
from skiplatch.played_files import all_faults_told, read_played
from skiplatch.stand_ins import refuse_endless_move, refuse_unplayable

EPILOG = """\b
Example:
  skiplatch predict scripts/samples/bench_isr_latency --replicates 20 --out build/predicted.csv \\
      --conditions scripts/samples/bench_isr_latency/touches.csv
"""


def _rig(path: Path | None, nominal: Nominal) -> Rig:
    """Give the rig that a diagnosis says it is, or the believed one."""
    if path is None:
        return Rig(nominal)
    rig = read_diagnosis_json(path, lambda document: rig_from_json(document, nominal))
    refuse_unplayable(path, rig.nominal, rig.effects)
    return rig


@click.command(epilog=EPILOG)
@click.argument("campaign", type=Source())
@click.option("--diagnosis", type=FILE, help="JSON of a diagnosis; without it, the nominal chain.")
@click.option("--conditions", "conditions_path", type=FILE, required=True, help="Touches to play.")
@click.option(
    "--replicates",
    type=CountType.of(REPLICATES),
    default=1,
    show_default=True,
    help="How often to play them.",
)
@click.option("-o", "--out", type=OutputFile(), required=True, help="CSV to write.")
@seed_option
@jobs_option
@json_option
def command(
    campaign: Path,
    diagnosis: Path | None,
    conditions_path: Path,
    replicates: int,
    out: Path,
    seed: int,
    jobs: int,
    json_path: Path | None,
) -> None:
    """Play conditions on the rig of a CAMPAIGN, with the effects that a diagnosis found.

    Where the conditions give edge_us (on a bench), the contacts close there. With a diagnosis the
    scans of the PLC keep the phase that the recorded stamps show.
    """
    with all_faults_told(campaign / NOMINAL_FILE, conditions_path):
        nominal = read_nominal(campaign / NOMINAL_FILE)
        refuse_unplayable(campaign / NOMINAL_FILE, nominal)
        conditions = read_played(conditions_path, nominal)
        refuse_endless_move(campaign / NOMINAL_FILE, nominal, conditions)
    rig = _rig(diagnosis, nominal)
    recorded = read_campaign(campaign).touches if diagnosis else None
    prediction = predicted(rig, recorded, conditions, replicates=replicates, seed=seed, jobs=jobs)
    atomic_write_text(out, "\n".join(prediction.csv_lines()) + "\n")
    click.echo(f"{out}: {len(conditions)} touches, {replicates} times")
    write_json(json_path, {"out": str(out), "touches": len(conditions), "replicates": replicates})
