"""Fuzz every reader of files in Python: what is mutated is read, or refused in one line.

    python tests/fuzz/fuzz_readers.py SECONDS [--only READER] [--seed N]

Goes round `readers.READERS`, SECONDS each, from what is in corpus/readers and the samples: with
Atheris where it is installed, else by blind mutations, and then without those readers that
fuzz_campaign.py and fuzz_import.py mutate. What breaks the property is kept in the corpus, and the
exit status is 1.
"""

import argparse
import hashlib
import importlib.util
import random
import subprocess
import sys
import time
import traceback
from collections import Counter
from pathlib import Path

from mutations import mutated
from readers import FUZZ, READERS, check, kept, seeds

BUILD = FUZZ.parents[1] / "build" / "fuzz"
LONGEST_SECONDS = 120  # without an answer; processor time is limited by `patience`
MOST_BYTES = 16384


def main() -> int:
    """Run for the time asked and report."""
    parser = argparse.ArgumentParser(description="fuzz the readers of files")
    parser.add_argument("seconds", type=float)
    parser.add_argument("--only", choices=READERS)
    parser.add_argument("--seed", type=int)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    is_guided = arguments.seconds > 0.0 and importlib.util.find_spec("atheris") is not None
    if arguments.seconds > 0.0 and not is_guided:
        print("fuzz_readers: no Atheris here, mutating blindly")
    fuzz = guided if is_guided else blind
    all_names = [name for name, reader in READERS.items() if is_guided or not reader.has_other]
    names = [arguments.only] if arguments.only else all_names
    failures = sum(replay(name) or fuzz(name, arguments.seconds, rng) for name in names)
    print(f"fuzz_readers: {len(names)} readers, {failures} failures")
    return 1 if failures else 0


def replay(name: str) -> int:
    """Count what fails of the samples and of what is kept."""
    return sum(is_broken(name, data, file) for file, data in seeds(name).items())


def blind(name: str, seconds: float, rng: random.Random) -> int:
    """Mutate until the time is over, or something is found; count that."""
    known = {Path(file): data for file, data in seeds(name).items()}
    runs: Counter[bool] = Counter()
    end = time.monotonic() + seconds
    while time.monotonic() < end and not runs[True]:
        data = mutated(rng, rng.choice(list(known.values())), known)
        runs[is_broken(name, data, "mutated")] += 1
        if runs[True]:
            keep(name, data)
    print(f"fuzz_readers: {name}: {runs.total()} executions, {runs[True]} failures")
    return runs[True]


def guided(name: str, seconds: float, rng: random.Random) -> int:
    """Let Atheris look for as long as is asked; count what it finds, at most one."""
    corpus, findings = BUILD / "corpus" / "readers" / name, BUILD / "findings" / name
    for folder in (corpus, findings):
        folder.mkdir(parents=True, exist_ok=True)
    for file, data in seeds(name).items():
        (corpus / file).write_bytes(data)
    command = [sys.executable, str(FUZZ / "guided.py"), name, f"-max_total_time={seconds:.0f}"]
    command += [f"-artifact_prefix={findings}/", f"-timeout={LONGEST_SECONDS}", "-verbosity=0"]
    command += [f"-seed={rng.getrandbits(31)}", f"-max_len={MOST_BYTES}", "-print_final_stats=1"]
    found = set(findings.iterdir())
    run = subprocess.run([*command, corpus], capture_output=True, text=True, check=False)
    for path in sorted(set(findings.iterdir()) - found):
        keep(name, path.read_bytes())
    executions = [line for line in run.stderr.splitlines() if "number_of_executed" in line]
    print(f"fuzz_readers: {name}: {' '.join(executions) or 'ended early'}, status {run.returncode}")
    if run.returncode != 0:
        print(run.stdout[-4000:], run.stderr[-4000:], file=sys.stderr)
    return int(run.returncode != 0)


def is_broken(name: str, data: bytes, source: str) -> bool:
    """Tell whether the input breaks the property; if so print how."""
    try:
        check(name, data)
    except Exception:  # noqa: BLE001
        print(f"fuzz_readers: {name}: {source}", file=sys.stderr)
        traceback.print_exc()
        return True
    return False


def keep(name: str, data: bytes) -> None:
    """Store a finding beside the seeds."""
    path = kept(name) / f"found_{hashlib.sha256(data).hexdigest()[:12]}"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    print(f"fuzz_readers: kept {path}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
