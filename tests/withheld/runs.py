"""Running the generator and the diagnosis, each in a process of its own, and going on with both.

A folder holds a set: OUT/campaigns, OUT/sealed, and OUT/ANSWERS with what came of each diagnosis.
What stands there in full is not made again, so that a check that was broken off goes on where it
stood; answers of another version of the diagnosis go to ANSWERS of another name.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from skiplatch.files import atomic_write_text
from skiplatch.progress import shown
from skiplatch.workers import Workers, in_order, opened
from tests.withheld.scoring import FAILED

ROOT = Path(__file__).parents[2]
SKIPLATCH = Path(sys.executable).with_name("skiplatch")
REPLICATES = 100  # of a prediction
TOUCHES = (200, 1000)
PASSED_ON = ("PATH", "HOME", "LANG", "TMPDIR")  # of the environment, to a diagnosis
ANSWERS = "found"
SET = "set.json"
DIAGNOSIS, PREDICTED, FAILURE = "diagnosis.json", "predicted.csv", "failure.txt"
ANSWERED = "answered.json"
"""Written last, so that an answer with it is a whole one."""
BROKEN: dict[str, Any] = {"verdict": FAILED, "effects": [], "where": [], "gap": {}}


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
    """What came of a diagnosis: its JSON, how long it took, and what it predicts, if anything."""

    diagnosis: dict[str, Any]
    seconds: float
    predicted: Path | None


def generate(out: Path, order: Order) -> None:
    """Let the generator write campaigns and sealed labels, but those that stand there already.

    Raises:
        SystemExit: Another set stands there, or the generator failed.
    """
    said = json.dumps(asdict(order)) + "\n"
    if (out / SET).exists() and (out / SET).read_text(encoding="utf-8") != said:
        raise SystemExit(f"gap-check: {out} holds another set, of {(out / SET).read_text()}")
    command = [sys.executable, "-m", "tests.withheld.generate", str(out)]
    command += ["--seed", str(order.seed), "--count", str(order.count)]
    command += ["--touches", *map(str, order.touches)]
    for option, value in (("--cases", order.cases), ("--kinds", order.kinds)):
        command += [option, value] if value else []
    made = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
    if made.returncode:
        raise SystemExit(f"gap-check: the generator failed: {made.stderr.strip()[-500:]}")
    atomic_write_text(out / SET, said)


def kept_order(out: Path) -> Order:
    """Read what a set was drawn from.

    Raises:
        SystemExit: No whole set stands there.
    """
    try:
        order = json.loads((out / SET).read_text(encoding="utf-8"))
    except OSError as error:
        raise SystemExit(f"gap-check: no set was drawn in {out}") from error
    return Order(**{**order, "touches": tuple(order["touches"])})


def diagnose_all(
    folder: Path,
    seed: int,
    workers: Workers,
    title: str,
    answers: str = ANSWERS,
) -> list[Answer]:
    """Diagnose the campaigns of a set, but those that were; in the order of their names.

    Workers wait for the processes of the diagnoses, and find the folder by its name.
    """
    there = folder.resolve()
    tasks = [(there / "campaigns" / name, seed, there / answers / name) for name in names(folder)]
    said = [f"{campaign}" for campaign, _, _ in tasks]
    with opened(replace(workers, loads=__name__)) as executor:
        return list(shown(in_order(executor, diagnose, tasks, said), len(tasks), title))


def names(folder: Path) -> Sequence[str]:
    """Name the campaigns of a set."""
    return sorted(path.name for path in (folder / "campaigns").iterdir())


def diagnose(campaign: Path, seed: int, out: Path) -> Answer:
    """Diagnose in a folder with nothing but a copy of the campaign, and predict from there.

    A diagnosis that breaks down is an answer too; its prediction is that of the unchanged chain.
    """
    if not (out / ANSWERED).exists():
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir(parents=True)
        with tempfile.TemporaryDirectory() as empty:
            shutil.copytree(campaign, Path(empty) / "campaign")
            seconds = _diagnose_in(Path(empty), seed, out)
        atomic_write_text(out / ANSWERED, json.dumps({"seconds": seconds}) + "\n")
    return _read_answer(out)


def _diagnose_in(folder: Path, seed: int, out: Path) -> float:
    """Diagnose and predict in a folder, copy what came of it, and give the seconds it took."""
    begin = time.perf_counter()
    said = run_skiplatch(folder, "diagnose", "campaign", "--json", DIAGNOSIS, "--seed", str(seed))
    seconds = time.perf_counter() - begin
    options = ["--conditions", "campaign/conditions.csv", "--out", PREDICTED]
    options += ["--replicates", str(REPLICATES), "--seed", str(seed)]
    options += [] if said else ["--diagnosis", DIAGNOSIS]
    said_then = run_skiplatch(folder, "predict", "campaign", *options)
    if said or said_then:
        text = f"diagnose: {said or 'well'}\npredict: {said_then or 'well'}\n"
        (out / FAILURE).write_text(text, encoding="utf-8")
    if not said and not said_then:
        shutil.copy(folder / DIAGNOSIS, out)
    if not said_then:
        shutil.copy(folder / PREDICTED, out)
    return seconds


def _read_answer(out: Path) -> Answer:
    """Read an answer that is whole; one of the two commands failing is a breakdown."""
    answered = json.loads((out / ANSWERED).read_text(encoding="utf-8"))
    diagnosis, predicted = out / DIAGNOSIS, out / PREDICTED
    document = json.loads(diagnosis.read_text(encoding="utf-8")) if diagnosis.exists() else BROKEN
    return Answer(document, answered["seconds"], predicted if predicted.exists() else None)


def run_skiplatch(folder: str | Path, *arguments: str) -> str:
    """Run a command in a folder; gives the end of what it said if it failed, else nothing."""
    environment = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    command = [str(SKIPLATCH), *arguments]
    done = subprocess.run(
        command, cwd=folder, env=environment, check=False, capture_output=True, text=True
    )
    return (done.stderr.strip()[-500:] or "no reason given") if done.returncode else ""
