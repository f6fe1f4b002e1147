"""``make gap-check``: diagnose campaigns whose effects are sealed, then open the seals.

The generator, each diagnosis and the scorer are processes of their own. A diagnosis is started in
a folder with nothing but one campaign; the labels lie elsewhere until all is diagnosed.
"""

import argparse
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.commands.kept import Kept
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_text
from skiplatch.workers import Workers
from tests.withheld import baselines, confusion, goals, page, reliability, verdicts
from tests.withheld.baselines import Baseline, guess_all
from tests.withheld.heldout import read_predictions, shrink_to_oracle
from tests.withheld.nats import nats
from tests.withheld.orders import Case
from tests.withheld.runs import ANSWERS, Answer, Order, diagnose_all, generate, kept_order, names
from tests.withheld.scoring import Found, Scored
from tests.withheld.sealed import LABEL, HeldBack, Label

FEW_TOUCHES = (200, 300)  # of the campaigns that are for false alarms alone
FORMAT = "skiplatch-gap-check/2"
GUESSES = "guesses"
"""Folder of what plainer ways have named."""
NOT_MEASURED = """\
Not measured here: parameters (the generator's forms have others than the catalogue), tried with
PLANTED=54; the recommended experiment (a sealed campaign cannot be gone on with), with TIES=40."""
EXAMPLE = """\
example, from the root of the tree: draw and seal, diagnose, and diagnose anew what was drawn
  python -m tests.withheld.check --count 60 --seed 7 --cases strangers,datum --keep build/kept --dry
  python -m tests.withheld.check --kept --keep build/kept --verdicts build/before.jsonl
  python -m tests.withheld.check --kept --keep build/kept --answers new --verdicts build/new.jsonl
"""


def open_seal(
    folder: Path, name: str, seed: int, answer: Answer, guesses: dict[str, str | None]
) -> Scored:
    """Score one campaign."""
    sealed = folder / "sealed" / name
    held_back = HeldBack.read(sealed)
    label = Label.read(sealed / LABEL)
    rng = np.random.default_rng(0)
    shrink = float("nan")
    if answer.predicted:
        predicted = read_predictions(answer.predicted, held_back.expected)
        shrink = shrink_to_oracle(held_back, predicted, rng)
    return Scored(
        label=label,
        found=Found.of(answer.diagnosis),
        seconds=answer.seconds,
        nats=nats(held_back, label.touches - len(held_back.touches), np.random.default_rng(0)),
        shrink=shrink,
        guesses=guesses,
        name=f"{seed}/{name}",
    )


def check(
    folder: Path,
    order: Order,
    compared: Sequence[Baseline],
    jobs: int,
    title: str = "diagnoses",
    answers: str = ANSWERS,
    cluster: str | None = None,
) -> list[Scored]:
    """Generate, diagnose, and only then open the seals."""
    generate(folder, order)
    return check_kept(folder, order.seed, compared, jobs, title, answers, cluster)


def check_kept(
    folder: Path,
    seed: int,
    compared: Sequence[Baseline],
    jobs: int,
    title: str = "diagnoses",
    answers: str = ANSWERS,
    cluster: str | None = None,
) -> list[Scored]:
    """Diagnose what was drawn, and only then open the seals."""
    workers = Workers(jobs=jobs, cluster=cluster)
    answered = diagnose_all(folder, seed, workers, title, answers)
    campaigns = names(folder)
    paths, kept = [folder / "campaigns" / name for name in campaigns], Kept(folder / GUESSES)
    guessed = guess_all(paths, compared, workers, kept)
    each = zip(campaigns, answered, guessed, strict=True)
    return [open_seal(folder, name, seed, answer, guess) for name, answer, guess in each]


def show(results: Sequence[Scored]) -> str:
    """Lay out all there is to say."""
    parts = [
        goals.as_text(goals.rows(results)),
        NOT_MEASURED,
        "Right by effect (name or group, campaigns of one effect)\n"
        + confusion.by_effect_text(results),
        "Right by size in units of the expected spread\n" + confusion.by_size_text(results),
        "What was taken for what (at most one effect): right, then the others\n"
        + confusion.matrix_text(results),
    ]
    if results[0].guesses:
        parts.append(
            "Beside plainer ways, on the same campaigns\n"
            + baselines.as_text([r for r in results if r.guesses])
        )
    return "\n\n".join(parts)


def as_json(results: Sequence[Scored], order: Order) -> dict[str, Any]:
    """Give the table, the confusion matrix and every campaign in plain types."""
    return {
        "format": FORMAT,
        "seed": order.seed,
        "table": [row.as_json() for row in goals.rows(results)],
        "confusion": [
            {"truth": truth, "named": named, "count": count}
            for (truth, named), count in sorted(confusion.matrix(results).items())
        ],
        "campaigns": [scored.as_json() for scored in results],
    }


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="gap-check",
        description=__doc__,
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20, help="number of campaigns")
    parser.add_argument("--cases", help=f"some of {','.join(Case)}")
    parser.add_argument("--kinds", help="some of bench,stamped,position")
    parser.add_argument("--jobs", type=int, default=1, help="diagnoses at the same time")
    parser.add_argument(
        "--cluster", help="diagnose on local:N, or the Dask scheduler there; all see --keep"
    )
    parser.add_argument(
        "--false-alarms", type=int, default=0, help="further small campaigns without an effect"
    )
    parser.add_argument("--no-baselines", action="store_true", help="leave the comparison out")
    parser.add_argument("--json", type=Path, help="write everything as JSON")
    parser.add_argument("--verdicts", type=Path, help="write a line of JSON for each campaign")
    parser.add_argument(
        "--reliability", type=Path, help="add how often names were right, for the diagnosis"
    )
    parser.add_argument(
        "--figures", type=Path, help="write the figures of docs/DIAGNOSIS.md (docs/withheld.json)"
    )
    parser.add_argument(
        "--keep", type=Path, help="folder of campaigns, seals and answers; what it has is kept"
    )
    parser.add_argument("--dry", action="store_true", help="draw and seal in --keep, and no more")
    parser.add_argument("--kept", action="store_true", help="draw nothing: take what --keep has")
    parser.add_argument(
        "--answers", default=ANSWERS, help="where in --keep answers stand; another name, anew"
    )
    return parser


def _order(options: argparse.Namespace) -> Order:
    return Order(options.seed, options.count, options.cases, options.kinds)


def run(options: argparse.Namespace, folder: Path) -> tuple[list[Scored], Order]:
    """Run the check in a folder; gives what it was drawn from, too."""
    order = kept_order(folder / "check") if options.kept else _order(options)
    compared = [] if options.no_baselines else baselines.all_baselines()
    if not options.kept:
        generate(folder / "check", order)
    how: dict[str, Any] = {"answers": options.answers, "cluster": options.cluster}
    results = check_kept(folder / "check", order.seed, compared, options.jobs, **how)
    if options.false_alarms:
        none = Order(order.seed, options.false_alarms, "none", options.kinds, FEW_TOUCHES)
        results += check(folder / "none", none, [], options.jobs, "false alarms", **how)
    return results, order


def main(arguments: Sequence[str] | None = None) -> None:
    """Read the command line and run the check."""
    options = _parser().parse_args(arguments)
    if options.count < 1 or options.jobs < 1 or options.false_alarms < 0:
        _parser().error("--count and --jobs must be at least 1, --false-alarms at least 0")
    if (options.dry or options.kept) and not options.keep:
        _parser().error("--dry and --kept need a folder: name it with --keep")
    if options.dry:
        generate(options.keep / "check", _order(options))
        return
    with tempfile.TemporaryDirectory() as temporary:
        try:
            results, order = run(options, options.keep or Path(temporary))
        except InputError as error:
            raise SystemExit(f"gap-check: {error}") from error
    print(show(results))
    _write(options, results, order)


def _write(options: argparse.Namespace, results: Sequence[Scored], order: Order) -> None:
    if options.json:
        document = json.dumps(as_json(results, order), indent=1, ensure_ascii=False)
        atomic_write_text(options.json, document + "\n")
    if options.reliability:
        text = reliability.with_set(options.reliability, results, order.seed)
        atomic_write_text(options.reliability, text)
    if options.figures:
        atomic_write_text(options.figures, page.figures(results, order.seed))
    if options.verdicts:
        atomic_write_text(options.verdicts, verdicts.as_lines(results))


if __name__ == "__main__":
    main()
