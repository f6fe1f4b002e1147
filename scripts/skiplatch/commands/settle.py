"""``skiplatch settle``: what the touches of a recommended experiment leave of a tie."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from skiplatch.campaign import COLUMNS, KEYS, NOMINAL_FILE, Campaign, Nominal
from skiplatch.campaign.datum import Datum
from skiplatch.campaign.nominal import in_version
from skiplatch.campaign.telling import HIDES_BACKLASH, hides_backlash
from skiplatch.commands.inputs import Source
from skiplatch.commands.options import jobs_option, json_option, seed_option, write_json
from skiplatch.diagnosis import diagnose
from skiplatch.diagnosis.experiment import Standing, borne_out_nats, outcome, rivals
from skiplatch.diagnosis.experiment.rivals import NO_EFFECT, Model
from skiplatch.diagnosis.experiment.words import A_GAUGE, name
from skiplatch.diagnosis.search.groups import TIED
from skiplatch.errors import InputError
from skiplatch.played_files import read_playable
from skiplatch.tables import number, prose, table

EPILOG = """\b
Example:
  skiplatch design build/tied --out build/next.csv
  (make the touches of build/next.csv and record them as the campaign build/made)
  skiplatch settle build/tied build/made
"""

BACKLASH = "backlash"


@click.command(epilog=EPILOG)
@click.argument("campaign", type=Source())
@click.argument("made", type=Source())
@seed_option
@jobs_option
@json_option
def command(campaign: Path, made: Path, seed: int, jobs: int, json_path: Path | None) -> None:
    """Say which of the effects that a CAMPAIGN leaves tied the touches MADE since bear out.

    MADE is a campaign of its own, on the same rig: the touches that `skiplatch design`
    recommends, with the column that it recommends. The models that the diagnosis of CAMPAIGN does
    not tell apart are fitted to both; one that falls behind the best one by a tie is ruled out,
    if the simulation expects such touches to do so. docs/DIAGNOSIS.md says how much a tie is. Where
    no effect at all suits the touches MADE as well, they told nothing, and it says so.
    """
    recorded, further = read_playable(campaign), read_playable(made)
    _refuse_another_rig(campaign, recorded, made, further)
    _refuse_the_same(campaign, recorded, made, further)
    models = rivals(diagnose(recorded, seed=seed, jobs=jobs, is_shown=True))
    standings = outcome(recorded, further, models, seed=seed, jobs=jobs) if models else []
    nats = borne_out_nats(recorded, further, standings[0].model) if standings else 0.0
    click.echo(prose(_text(standings, nats, further)))
    write_json(json_path, _json(standings, nats))


def _refuse_another_rig(campaign: Path, recorded: Campaign, made: Path, further: Campaign) -> None:
    """Refuse other beliefs; a datum is of the touches, and goes with them."""
    if _of_the_rig(recorded.nominal) != _of_the_rig(further.nominal):
        nominal = campaign / NOMINAL_FILE
        message = (
            f"nominal.toml is not that of {campaign}: another rig; a log of the same rig is "
            f"imported with --nominal {nominal}"
        )
        raise InputError(made, None, None, message)


def _of_the_rig(nominal: Nominal) -> Nominal:
    """Leave out what goes with the touches, and whether a later key was written or is a default."""
    unknown = frozenset(path for path in nominal.unknown if KEYS[path].since == 1)
    own = replace(nominal, datum=Datum.of_kind(nominal.kind), unknown=unknown)
    return in_version(own, 2)


def _refuse_the_same(campaign: Path, recorded: Campaign, made: Path, further: Campaign) -> None:
    mine, theirs = recorded.touches.columns(), further.touches.columns()
    if all(np.array_equal(mine[name], theirs[name], equal_nan=True) for name in COLUMNS):
        message = f"the touches are those of {campaign}; expected what was touched since"
        raise InputError(made, None, None, message)


def _text(standings: Sequence[Standing], nats: float, further: Campaign) -> str:
    """Say what is left, by nats behind the best model; so many is no effect at all behind it."""
    if not standings:
        return "The campaign leaves nothing to settle: no effect was named."
    left = [standing.model for standing in standings if standing.is_left]
    says = [f"{'Left' if len(left) == 1 else 'Still tied'}: {', '.join(map(name, left))}."]
    if nats < TIED:
        says += _not_borne_out(standings, nats)
    if nats < TIED and _is_hidden(left, further):
        says += [f"E{HIDES_BACKLASH[1:].partition(';')[0]}.", A_GAUGE]
    rows = [(name(s.model), number(s.behind_nats, 3)) for s in standings]
    rows.append((name(NO_EFFECT), number(round(nats, 2) + 0.0, 3)))
    return f"{' '.join(says)}\n" + table(("model", "behind by nats"), rows)


def _not_borne_out(standings: Sequence[Standing], nats: float) -> list[str]:
    """Say what touches tell that suit no effect at all as well."""
    if nats <= -TIED:
        return ["These touches speak against it: no effect at all suits them better."]
    if any(standing.behind_nats >= TIED for standing in standings):
        return ["No effect at all suits these touches as well as the best of them."]
    return [
        "That is by the campaign alone.",
        "These touches told nothing: no effect at all suits them as well.",
    ]


def _is_hidden(left: Sequence[Model], further: Campaign) -> bool:
    """Tell whether a backlash is left that looks like where surfaces lie."""
    has_backlash = any(effect.id == BACKLASH for model in left for effect in model)
    return has_backlash and hides_backlash(further.nominal, further.touches)


def _json(standings: Sequence[Standing], nats: float) -> dict[str, object]:
    return {
        "left": [[effect.id for effect in s.model] for s in standings if s.is_left],
        "models": [
            {"effects": [effect.id for effect in s.model], "behind_nats": s.behind_nats}
            for s in standings
        ],
        "no_effect_behind_nats": nats if standings else None,
    }
