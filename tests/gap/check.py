"""``make gap-check``: diagnose campaigns whose effects are sealed, then open the seals.

The generator, each diagnosis and the scorer are processes of their own. A diagnosis is started in
a folder with nothing but one campaign; the labels lie elsewhere until all is diagnosed.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from skiplatch.campaign import Campaign, read_campaign
from skiplatch.files import atomic_write_text
from tests.gap import baselines, confusion, goals
from tests.gap.baselines import Baseline
from tests.gap.cases import Case
from tests.gap.heldout import read_predictions, shrink_to_oracle
from tests.gap.nats import nats
from tests.gap.scoring import FAILED, Found, Scored
from tests.gap.sealed import LABEL, HeldBack, Label

ROOT = Path(__file__).parents[2]
SKIPLATCH = Path(sys.executable).with_name("skiplatch")
REPLICATES = 100  # of a prediction
TOUCHES = (200, 1000)
FEW_TOUCHES = (200, 300)  # of the campaigns that are for false alarms alone
PASSED_ON = ("PATH", "HOME", "LANG", "TMPDIR")  # of the environment, to a diagnosis
FORMAT = "skiplatch-gap-check/1"
NOT_MEASURED = """\
Not measured here: parameters (the generator's forms have others than the catalogue), tried with
PLANTED=54; the recommended experiment (a sealed campaign cannot be gone on with), with TIES=40."""
DIAGNOSIS, PREDICTED = "diagnosis.json", "predicted.csv"
BROKEN: dict[str, Any] = {"verdict": FAILED, "effects": [], "where": []}


@dataclass(frozen=True, slots=True)
class Order:
    """What the generator is to draw."""

    seed: int
    count: int
    cases: str | None = None
    kinds: str | None = None
    touches: tuple[int, int] = TOUCHES


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a diagnosis: its JSON, how long it took, and what it predicts."""

    diagnosis: dict[str, Any]
    seconds: float
    predicted: Path


def generate(out: Path, order: Order) -> None:
    """Let the generator write campaigns and sealed labels."""
    command = [sys.executable, "-m", "tests.gap.generate", str(out)]
    command += ["--seed", str(order.seed), "--count", str(order.count)]
    command += ["--touches", *map(str, order.touches)]
    for option, value in (("--cases", order.cases), ("--kinds", order.kinds)):
        command += [option, value] if value else []
    made = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
    if made.returncode:
        raise SystemExit(f"gap-check: the generator failed: {made.stderr.strip()[-500:]}")


def diagnose(campaign: Path, seed: int, out: Path) -> Answer:
    """Diagnose in a folder with nothing but a copy of the campaign, and predict from there.

    A diagnosis that breaks down is an answer too; its prediction is that of the unchanged chain.
    """
    out.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as empty:
        shutil.copytree(campaign, Path(empty) / "campaign")
        begin = time.perf_counter()
        said = run_skiplatch(
            empty, "diagnose", "campaign", "--json", DIAGNOSIS, "--seed", str(seed)
        )
        seconds = time.perf_counter() - begin
        options = ["--conditions", "campaign/conditions.csv", "--out", PREDICTED]
        options += ["--replicates", str(REPLICATES), "--seed", str(seed)]
        if said:
            (out / "failure.txt").write_text(said, encoding="utf-8")
        else:
            options += ["--diagnosis", DIAGNOSIS]
            shutil.copy(Path(empty) / DIAGNOSIS, out)
        if said_then := run_skiplatch(empty, "predict", "campaign", *options):
            raise SystemExit(f"gap-check: skiplatch predict failed: {said_then}")
        shutil.copy(Path(empty) / PREDICTED, out)
    document = BROKEN if said else json.loads((out / DIAGNOSIS).read_text(encoding="utf-8"))
    return Answer(document, seconds, out / PREDICTED)


def run_skiplatch(folder: str, *arguments: str) -> str:
    """Run a command in a folder; gives the end of what it said if it failed, else nothing."""
    environment = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    command = [str(SKIPLATCH), *arguments]
    done = subprocess.run(
        command, cwd=folder, env=environment, check=False, capture_output=True, text=True
    )
    return (done.stderr.strip()[-500:] or "no reason given") if done.returncode else ""


def open_seal(folder: Path, name: str, answer: Answer, guesses: dict[str, str | None]) -> Scored:
    """Score one campaign."""
    sealed = folder / "sealed" / name
    held_back = HeldBack.read(folder / "campaigns" / name, sealed)
    label = Label.read(sealed / LABEL)
    rng = np.random.default_rng(0)
    recorded = label.touches - len(held_back.touches)
    predicted = read_predictions(answer.predicted, held_back.expected)
    return Scored(
        label=label,
        found=Found.of(answer.diagnosis),
        seconds=answer.seconds,
        nats=nats(held_back, recorded, rng),
        shrink=shrink_to_oracle(held_back, predicted, rng),
        guesses=guesses,
    )


def check(
    folder: Path, order: Order, compared: Sequence[Baseline], jobs: int, title: str = "diagnoses"
) -> list[Scored]:
    """Generate, diagnose, and only then open the seals."""
    generate(folder, order)
    campaigns = sorted((folder / "campaigns").iterdir())
    with ThreadPoolExecutor(jobs) as pool:
        answers = pool.map(lambda c: diagnose(c, order.seed, folder / "found" / c.name), campaigns)
        answered = list(_shown(answers, len(campaigns), title))
    guessed = _guess(campaigns, compared, jobs)
    names = [path.name for path in campaigns]
    return [open_seal(folder, *one) for one in zip(names, answered, guessed, strict=True)]


def _shown(steps: Iterable[Any], total: int, title: str) -> Iterable[Any]:
    return tqdm(steps, total=total, desc=title, leave=False, disable=None)


def _guess(
    campaigns: Sequence[Path], compared: Sequence[Baseline], jobs: int
) -> list[dict[str, str | None]]:
    """Let the baselines name an effect of each campaign."""
    if not compared:
        return [{} for _ in campaigns]
    tasks = [(baseline, path) for path in campaigns for baseline in compared]
    with ProcessPoolExecutor(jobs) as pool:
        names = list(_shown(pool.map(_name, tasks), len(tasks), "baselines"))
    titles = [baseline.title for baseline in compared]
    rows = [names[i : i + len(titles)] for i in range(0, len(names), len(titles))]
    return [dict(zip(titles, row, strict=True)) for row in rows]


def _name(task: tuple[Baseline, Path]) -> str | None:
    baseline, path = task
    campaign: Campaign = read_campaign(path)
    return baseline.name(campaign)


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
    parser = argparse.ArgumentParser(prog="gap-check", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=20, help="number of campaigns")
    parser.add_argument("--cases", help=f"some of {','.join(Case)}")
    parser.add_argument("--kinds", help="some of bench,stamped,position")
    parser.add_argument("--jobs", type=int, default=1, help="diagnoses at the same time")
    parser.add_argument(
        "--false-alarms", type=int, default=0, help="further small campaigns without an effect"
    )
    parser.add_argument("--no-baselines", action="store_true", help="leave the comparison out")
    parser.add_argument("--json", type=Path, help="write everything as JSON")
    parser.add_argument("--keep", type=Path, help="folder to keep campaigns, seals and answers in")
    parser.add_argument("--dry", action="store_true", help="draw and seal in --keep, and no more")
    return parser


def _order(options: argparse.Namespace) -> Order:
    return Order(options.seed, options.count, options.cases, options.kinds)


def run(options: argparse.Namespace, folder: Path) -> list[Scored]:
    """Run the check in a folder."""
    order = _order(options)
    compared = [] if options.no_baselines else baselines.all_baselines()
    results = check(folder / "check", order, compared, options.jobs)
    if options.false_alarms:
        none = Order(options.seed, options.false_alarms, "none", options.kinds, FEW_TOUCHES)
        results += check(folder / "none", none, [], options.jobs, "false alarms")
    return results


def main() -> None:
    """Read the command line and run the check."""
    options = _parser().parse_args()
    if options.count < 1 or options.jobs < 1 or options.false_alarms < 0:
        _parser().error("--count and --jobs must be at least 1, --false-alarms at least 0")
    if options.dry:
        if not options.keep:
            _parser().error("--dry draws campaigns and leaves them in --keep: name a folder")
        generate(options.keep / "check", _order(options))
        return
    with tempfile.TemporaryDirectory() as temporary:
        results = run(options, options.keep or Path(temporary))
    print(show(results))
    if options.json:
        order = Order(options.seed, options.count)
        document = json.dumps(as_json(results, order), indent=1, ensure_ascii=False)
        atomic_write_text(options.json, document + "\n")


if __name__ == "__main__":
    main()
