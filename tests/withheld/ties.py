"""``make gap-check TIES=40``: does the recommended experiment resolve a tie within 60 touches?

Campaigns are drawn whose effect is often tied with others. Where the diagnosis ends in a tie, the
touches that ``skiplatch design`` writes are made on the drawn rig, with the true effect and the
column that it recommends, and ``skiplatch settle`` says what is left. The commands run as a user
runs them, in a folder that holds nothing but what was recorded.
"""

import argparse
import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign import format_nominal, format_touches, read_conditions
from skiplatch.commands.kept import Kept
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_folder, atomic_write_text
from skiplatch.progress import shown
from skiplatch.statistics import proportion
from skiplatch.tables import table
from skiplatch.workers import Workers, in_order, opened
from tests.withheld.cases import Drawn, draw_campaign
from tests.withheld.conditions import Recording
from tests.withheld.orders import Case, Order
from tests.withheld.parts import recordings_for
from tests.withheld.resume import resume
from tests.withheld.runs import run_skiplatch
from tests.withheld.writing import write

GOAL = 0.95
TOUCHES = (150, 500)
PRONE = (
    "trigger_delay",
    "input_filter",
    "following_error",
    "contact_bounce",
    "link_retry",
    "isr_latency",
    "link_slotting",
    "servo_hold",
    "scale_error",
    "feed_error",
)
"""Effects that often end in a tie on a machine."""
WITHOUT_STAMPS = 0.75
"""Share of the campaigns, of those effects that show without."""


class Fate(StrEnum):
    """What became of a tie."""

    RESOLVED = "resolved"
    """Left are the truth and what the recommendation said would stay tied with it."""
    OPEN = "more is left"
    WRONG = "truth ruled out"
    SAME = "said to be inseparable"
    """The simulation tells none of the tied effects from another in any column."""
    ABSENT = "truth not in the tie"

    @property
    def counts(self) -> bool:
        """Whether the recommended experiment could have resolved it."""
        return self in {Fate.RESOLVED, Fate.OPEN, Fate.WRONG}


@dataclass(frozen=True, slots=True)
class Tie:
    """A campaign that ended in a tie, and what became of it.

    Attributes:
        truth: The effect that it has.
        form: The form of it.
        groups: The models that the recommended experiment is to tell apart, by group.
        record: The column recorded in addition.
        left: What `skiplatch settle` left; models by their effects.
    """

    truth: str
    form: str
    groups: Sequence[frozenset[str]]
    record: str | None
    left: frozenset[str]

    @property
    def fate(self) -> Fate:
        """What became of it."""
        own = next((group for group in self.groups if self.truth in group), None)
        if own is None:
            return Fate.ABSENT
        if len(self.groups) == 1:
            return Fate.SAME
        if self.truth not in self.left:
            return Fate.WRONG
        return Fate.RESOLVED if self.left <= own else Fate.OPEN

    @property
    def is_alone(self) -> bool:
        """Whether the truth and nothing else is left."""
        return self.left == {self.truth}

    def as_json(self) -> dict[str, Any]:
        """Give it in plain types."""
        return {
            "truth": self.truth,
            "form": self.form,
            "groups": [sorted(group) for group in self.groups],
            "record": self.record,
            "left": sorted(self.left),
            "fate": str(self.fate),
        }


def draw(seed: int, number: int) -> Drawn:
    """Draw a machine campaign with an effect that is prone to ties."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(7, number)))
    effect = PRONE[number % len(PRONE)]
    kinds = [kind for kind in recordings_for(effect) if kind is not Recording.BENCH]
    bare = Recording.POSITION in kinds and rng.random() < WITHOUT_STAMPS
    recording = Recording.POSITION if bare else Recording.STAMPED
    return draw_campaign(rng, Order(Case.SINGLE, recording, [effect]), TOUCHES)


def try_one(seed: int, number: int) -> Tie | None:
    """Draw a campaign, and go the user's way with it; None if it ends in no tie."""
    drawn = draw(seed, number)
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / "drawn", "one", drawn)
        user = Path(folder) / "user"
        user.mkdir()
        (Path(folder) / "drawn" / "campaigns" / "one").rename(user / "tied")
        return _go_on(user, seed, number, drawn)


def _go_on(user: Path, seed: int, number: int, drawn: Drawn) -> Tie | None:
    diagnosis = _command(user, seed, "diagnose", "tied")
    if not any(effect["alternatives"] for effect in diagnosis["effects"]):
        return None
    experiment = _command(user, seed, "design", "tied", "--out", "next.csv")
    record = experiment["record"]
    rng = np.random.default_rng([seed, number])
    made = resume(rng, drawn, read_conditions(user / "next.csv"), [record] if record else [])
    nominal = format_nominal(drawn.setup.nominal)
    atomic_write_folder(
        user / "made", {"nominal.toml": nominal, "touches.csv": format_touches(made)}
    )
    settled = _command(user, seed, "settle", "tied", "made")
    (part,) = drawn.parts
    return Tie(
        truth=part.id,
        form=part.form,
        groups=[frozenset(map(_model, group)) for group in experiment["separates"]],
        record=record,
        left=frozenset("+".join(sorted(model)) for model in settled["left"]),
    )


def _model(name: str) -> str:
    return "+".join(sorted(name.split(" + ")))


def _command(user: Path, seed: int, *arguments: str) -> Any:  # noqa: ANN401
    """Run a command in the user's folder, and give its JSON."""
    options = ("--seed", str(seed), "--jobs", "1", "--json", "said.json")
    if said := run_skiplatch(str(user), *arguments, *options):
        raise InputError(f"skiplatch {arguments[0]}", None, None, f"failed: {said}")
    return json.loads((user / "said.json").read_text(encoding="utf-8"))


def as_text(ties: Sequence[Tie], campaigns: int) -> str:
    """Say how many ties were resolved, and what became of each."""
    counted = [tie for tie in ties if tie.fate.counts]
    lines = [f"{campaigns} campaigns, {len(ties)} ties"]
    for title, hits in (
        ("resolved as far as expected", [t.fate is Fate.RESOLVED for t in counted]),
        ("  the truth alone is left", [t.is_alone for t in counted]),
    ):
        if hits:
            share = proportion(sum(hits), len(hits))
            lines.append(
                f"{title}: {sum(hits)} of {len(hits)}, {100 * share.value:.1f} % "
                f"({100 * share.low:.1f} … {100 * share.high:.1f} %)"
                + (f", goal ≥ {100 * GOAL:g} %" if title[0] != " " else "")
            )
    rows = [
        (t.truth, t.form, t.record or "", " | ".join(map(_listed, t.groups)), _listed(t.left), f)
        for t in ties
        for f in [str(t.fate)]
    ]
    heads = ("truth", "form", "recorded", "to be told apart", "left", "")
    return "\n".join(lines) + "\n\n" + table(heads, rows)


def _listed(names: frozenset[str]) -> str:
    return ", ".join(sorted(names))


def main(arguments: Sequence[str] | None = None) -> None:
    """Read the command line and run the check."""
    parser = argparse.ArgumentParser(prog="gap-check (ties)", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20, help="number of campaigns")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns at the same time")
    parser.add_argument("--cluster", help="local:N, or the address of a Dask scheduler")
    parser.add_argument("--json", type=Path, help="write every tie as JSON")
    options = parser.parse_args(arguments)
    tasks = [(options.seed, number) for number in range(options.count)]
    names = [f"campaign for ties {number} of seed {seed}" for seed, number in tasks]
    try:
        kept = Kept.beside(options.json)
        with opened(Workers(jobs=options.jobs, cluster=options.cluster)) as executor:
            coming = in_order(executor, try_one, tasks, names, kept)
            tried = list(shown(coming, len(tasks), "ties"))
    except InputError as error:
        raise SystemExit(f"gap-check: {error}") from error
    ties = [tie for tie in tried if tie is not None]
    print(as_text(ties, options.count))
    if options.json:
        document = json.dumps([tie.as_json() for tie in ties], indent=1)
        atomic_write_text(options.json, document + "\n")
    kept.drop()


if __name__ == "__main__":
    main()
