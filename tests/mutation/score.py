"""Score the unit tests of the firmware: how many mutants of its sources do they notice?

    python tests/mutation/score.py [FOLDER ...] [--count 100 --seed 1] [--least 0.9]

Each mutant is compiled and linked as make does it, and the unit tests that link its source are run
until one fails. What the compiler refuses is no mutant, nor is one whose object file is that of the
source as it stands. Exit status 1 if a smaller share than the least is noticed.
"""

import argparse
import os
import random
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tests.mutation.mutants import Mutant, mutants_of

FOLDERS = ("firmware/input", "firmware/report", "firmware/inject")
OUT = "build/host"
TESTS = Path("tests/unit")
PATIENCE_S = 30.0
OTHERWISE = {"-O3": "-O2", "-g": "-g0"}  # so that what the source is called does not show
LEFT_OUT = {"-Werror", "-flto", "-ffat-lto-objects", "-MMD", "-MP"}
NO_MUTANT, KILLED, SURVIVED = "no mutant", "killed", "SURVIVED"
# What an outer make hands on is of its own jobs, and would be spoken of where commands are read.
OUTSIDE_MAKE = {name: text for name, text in os.environ.items() if "MAKEFLAGS" not in name}


@dataclass(frozen=True, slots=True)
class Build:
    """How a source is compiled, and the tests that it is in are linked."""

    source: Path
    text: str
    compiling: list[str]
    linking: list[list[str]]
    sound: bytes  # the object file of the source as it stands


def commands_for(source: Path, programs: list[str]) -> list[list[str]]:
    """Ask make what it would run if the source had changed."""
    make = ["make", "--no-print-directory", "INNER=yes", *programs]
    subprocess.run(make, check=True, stdout=subprocess.DEVNULL, env=OUTSIDE_MAKE)
    text = subprocess.check_output([*make, "-n", "-W", str(source)], text=True, env=OUTSIDE_MAKE)
    return [shlex.split(line) for line in text.splitlines() if line.startswith("gcc ")]


def read_build(source: Path) -> Build:
    """Find out how a source and the unit tests that link it are built."""
    tests = [path for path in sorted(TESTS.glob("*.c")) if str(source) in _links(path)]
    named = f"test_{source.stem}"
    tests.sort(key=lambda path: (path.stem != named, path.stem))
    if not tests:
        raise SystemExit(f"{source}: no unit test links it")
    commands = commands_for(source, [f"{OUT}/{path.with_suffix('')}" for path in tests])
    compiling = next(words for words in commands if str(source) in words and "-c" in words)
    compiling = [OTHERWISE.get(word, word) for word in compiling if word not in LEFT_OUT]
    linking = [words for words in commands if "-c" not in words]
    order = [path.stem for path in tests]
    linking.sort(key=lambda words: order.index(Path(words[-1]).name))
    text = source.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as name:
        made = _compiled(compiling, source, text, Path(name))
        sound = made.read_bytes() if made else b""
    return Build(source, text, compiling, linking, sound)


def _links(test: Path) -> list[str]:
    return test.read_text(encoding="utf-8").split("#include")[0].split()


def _compiled(compiling: list[str], source: Path, text: str, folder: Path) -> Path | None:
    """Compile a text in place of the source; give the object file, or none."""
    place, made = folder / source.name, folder / "mutant.o"
    place.write_text(text, encoding="utf-8")
    words = [str(place) if word == str(source) else word for word in compiling]
    words[words.index("-o") + 1] = str(made)
    done = subprocess.run(words, check=False, capture_output=True)
    return made if done.returncode == 0 else None


def outcome_of(build: Build, mutant: Mutant) -> str:
    """Say whether a test fails on a mutant."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = _compiled(build.compiling, build.source, mutant.apply(build.text), folder)
        if made is None or made.read_bytes() == build.sound:
            return NO_MUTANT
        original = build.source.with_suffix(".o").as_posix()
        for words in build.linking:
            program = folder / "test"
            linked = [str(made) if word.endswith(original) else word for word in words[:-1]]
            subprocess.run([*linked, str(program)], check=True)
            if _fails(program):
                return KILLED
    return SURVIVED


def _fails(program: Path) -> bool:
    try:
        done = subprocess.run([str(program)], check=False, capture_output=True, timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def score(source: Path, count: int | None, seed: int, jobs: int) -> tuple[int, int]:
    """Print a line for a source and each of its mutants that lives; give killed, and all."""
    build = read_build(source)
    mutants = list(mutants_of(build.text))
    if count is not None and count < len(mutants):
        mutants = random.Random(seed).sample(mutants, count)
    with ThreadPoolExecutor(jobs) as pool:
        outcomes = list(pool.map(lambda mutant: outcome_of(build, mutant), mutants))
    return told(source, [mutant.describe(build.text) for mutant in mutants], outcomes)


def told(source: Path, changes: Sequence[str], outcomes: Sequence[str]) -> tuple[int, int]:
    """Print a line for a source and each change that lives; give killed, and all."""
    killed, lives = outcomes.count(KILLED), outcomes.count(SURVIVED)
    print(f"{source}: {killed} of {killed + lives} mutants killed", flush=True)
    for change, outcome in zip(changes, outcomes, strict=True):
        if outcome == SURVIVED:
            print(f"    {source}:{change}", flush=True)
    return killed, killed + lives


def status_of(scores: Sequence[tuple[int, int]], least: float) -> int:
    """Print what all sources come to; 1 if too few mutants are killed."""
    killed, mutants = map(sum, zip(*scores, strict=True))
    share = killed / mutants if mutants else 0.0
    print(f"{killed} of {mutants} mutants killed, {share:.1%}; {least:.0%} are asked for")
    return 0 if share >= least else 1


def main() -> int:
    """Score all sources of the folders; 1 if too few mutants are killed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("places", nargs="*", default=FOLDERS, help="folders, or sources")
    parser.add_argument("--count", type=int, help="mutants of a source, drawn; else all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--least", type=float, default=0.9, help="share to be killed")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    sources = [
        source
        for place in map(Path, options.places)
        for source in (sorted(place.glob("*.c")) if place.is_dir() else [place])
    ]
    scores = [score(source, options.count, options.seed, options.jobs) for source in sources]
    return status_of(scores, options.least)


if __name__ == "__main__":
    sys.exit(main())
