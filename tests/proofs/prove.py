r"""Run CBMC over the proofs of this folder, and show that each of them fails on seeded mutants.

A proof says at its top, in comments, what it is made of:

    LINK: sources, beside the proof itself
    CBMC: options, such as --unwind 9
    SED: file: how sed changes the copy of the file, for instance to let interrupts in
    MUTANT: file: old text => new text; \\n is a new line

Whatever the proof includes of the project is taken from a copy of the tree, in which a mutant
replaces the first occurrence of its old text. A mutant that is not found, or that the proof does
not see, is a failure of the proof.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).parent
ROOT = FOLDER.parents[1]
CBMC = ROOT / "build" / "cbmc" / "cbmc"
TREES = ("firmware", "hal/include", "tests/proofs")
INCLUDES = ("firmware", "hal/include", "tests/proofs")
CHECKS = ("--drop-unused-functions",)
COMMENT = re.compile(r"/\* (LINK|CBMC|SED|MUTANT): (.*?) ?\*/", re.DOTALL)
PATIENCE_S = 300
PROVED, REFUTED = 0, 10


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of a source that the proof has to see."""

    path: Path
    old: str
    new: str

    def __str__(self) -> str:
        return " ".join(f"{self.path.name}: {self.old} => {self.new}".split())


@dataclass(frozen=True, slots=True)
class Proof:
    """One harness, and what its comments say."""

    path: Path
    sources: tuple[str, ...]
    options: tuple[str, ...]
    changes: tuple[tuple[str, str], ...]
    mutants: tuple[Mutant, ...]


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of a proof, of the code as it stands or of a mutant."""

    proof: Proof
    mutant: Mutant | None
    seconds: float
    fault: str | None

    def __str__(self) -> str:
        what = "the code as it stands" if self.mutant is None else f"mutant {self.mutant}"
        found = self.fault or ("proved" if self.mutant is None else "killed")
        return f"{self.proof.path.stem:24} {self.seconds:6.1f} s  {found:8}  {what}"


def read_proof(path: Path) -> Proof:
    """Read the comments at the top of a harness."""
    found: dict[str, list[str]] = {"LINK": [], "CBMC": [], "SED": [], "MUTANT": []}
    for kind, text in COMMENT.findall(path.read_text(encoding="utf-8")):
        found[kind].append(re.sub(r"\s*\n \*\s*", " ", text))
    mutants = []
    for text in found["MUTANT"]:
        name, _, change = text.partition(": ")
        old, arrow, new = change.partition(" => ")
        if not arrow:
            raise SystemExit(f"{path}: no mutant: {text}")
        mutants.append(Mutant(Path(name), _lines(old), _lines(new)))
    return Proof(
        path,
        tuple(" ".join(found["LINK"]).split()),
        tuple(" ".join(found["CBMC"]).split()),
        tuple((name, change) for name, _, change in (x.partition(": ") for x in found["SED"])),
        tuple(mutants),
    )


def _lines(text: str) -> str:
    return text.replace("\\n", "\n")


def mutate(tree: Path, mutant: Mutant) -> bool:
    """Change the copy of the tree; False if the old text does not stand there."""
    path = tree / mutant.path
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(mutant.old, mutant.new, 1), encoding="utf-8")
    return mutant.old in text


def check(proof: Proof, mutant: Mutant | None) -> Verdict:
    r"""Run CBMC over a copy of the tree, with a mutant or without."""
    start_s = time.monotonic()
    with tempfile.TemporaryDirectory(dir=ROOT / "build") as name:
        tree = Path(name)
        for folder in TREES:
            shutil.copytree(ROOT / folder, tree / folder)
        if mutant is not None and not mutate(tree, mutant):
            fault: str | None = "NOT FOUND"
        else:
            fault = _run(proof, tree, REFUTED if mutant else PROVED)
    return Verdict(proof, mutant, time.monotonic() - start_s, fault)


def _run(proof: Proof, tree: Path, wanted: int) -> str | None:
    for name, change in proof.changes:
        subprocess.run(["/usr/bin/env", "sed", "-i", change, tree / name], check=True)
    includes = [f"-I{folder}" for folder in INCLUDES]
    sources = (str(proof.path.relative_to(ROOT)), *proof.sources)
    command = [str(CBMC), *includes, *CHECKS, *proof.options, *sources]
    try:
        done = subprocess.run(
            command, cwd=tree, capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )
    except subprocess.TimeoutExpired:
        return "TOO SLOW"
    if done.returncode == wanted:
        return None
    if done.returncode == PROVED:
        return "SURVIVED"
    failures = re.findall(r"^\[.*FAILURE$", done.stdout, re.MULTILINE)
    print("\n".join(failures) or (done.stdout + done.stderr)[-2000:], file=sys.stderr)
    return "FAILED"


def _verdicts(proofs: list[Proof], jobs: int) -> Iterator[Verdict]:
    work = [(proof, mutant) for proof in proofs for mutant in (None, *proof.mutants)]
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda pair: check(*pair), work)


def main() -> int:
    """Print a line for each proof and each of its mutants; 1 if one is not as it should be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="proofs, all if none is named")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    paths = sorted(FOLDER.glob("prove_*.c"))
    proofs = [read_proof(path) for path in paths if not options.names or path.stem in options.names]
    faults = 0
    counts = {True: 0, False: 0}
    for verdict in _verdicts(proofs, options.jobs):
        print(verdict, flush=True)
        faults += verdict.fault is not None
        counts[verdict.mutant is None] += verdict.fault is None
    print(f"{counts[True]} proved, {counts[False]} mutants killed, {faults} faults")
    return 1 if faults or not proofs else 0


if __name__ == "__main__":
    sys.exit(main())
