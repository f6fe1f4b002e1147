"""Score the tests of the verdict's rules: how many mutants of their source do they notice?

    python -m tests.mutation.python_score [--count 100 --seed 1] [--least 0.9]

Each mutant is loaded in place of its module, in a process forked for it, and the test file is run
until one test fails. Exit status 1 if a smaller share than the least is noticed.
"""

import argparse
import contextlib
import gc
import io
import multiprocessing
import random
import sys
from collections.abc import Sequence
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType

import pytest

from tests.mutation.python_mutants import mutants_of
from tests.mutation.score import KILLED, SURVIVED, status_of, told

PACKAGES = Path("scripts")
VERDICT = PACKAGES / "skiplatch/diagnosis/verdict"
SOURCES = [VERDICT / f"{name}.py" for name in ("accidents", "evidence", "rules", "verdict")]
TESTS = sorted(Path("tests/python").glob("test_diagnosis_verdict*.py"))
PYTEST = (
    *("-c", "scripts/pyproject.toml", "--rootdir=.", "-x", "-q", "-p", "no:cacheprovider"),
    "--noconftest",  # it loads the whole program, anew for each mutant
    "--assert=plain",  # nobody reads why a test failed
)
PATIENCE_S = 60.0
NOT_LOADED = 70
"""Exit status where the tests never loaded the module."""
FORKED = multiprocessing.get_context("fork")


class Instead(Loader):
    """Finds one module as another text, and all others where they are."""

    def __init__(self, module: str, text: str) -> None:
        self.module, self.text, self.is_loaded = module, text, False

    def find_spec(self, fullname: str, *_: object) -> ModuleSpec | None:
        """Find the module, by this very loader."""
        return ModuleSpec(fullname, self) if fullname == self.module else None

    def exec_module(self, module: ModuleType) -> None:
        """Run the text as the module."""
        self.is_loaded = True
        exec(compile(self.text, f"<{self.module}>", "exec"), module.__dict__)  # noqa: S102


def module_of(source: Path) -> str:
    """Name the module of a source."""
    return ".".join(source.relative_to(PACKAGES).with_suffix("").parts)


def load_others(module: str, tests: Sequence[Path]) -> None:
    """Load what the tests take, and forget what of it may hold on to the module."""
    with contextlib.redirect_stdout(io.StringIO()):
        pytest.main([*PYTEST, "--collect-only", *map(str, tests)])
    own = {module.partition(".")[0], *(path.stem for path in tests[0].parent.glob("*.py"))}
    for name in [name for name in sys.modules if name.partition(".")[0] in own]:
        del sys.modules[name]
    gc.freeze()  # or each process would look all of it through


def _run(module: str, text: str, tests: Sequence[Path]) -> None:
    """Run the tests on a text, and leave with pytest's status."""
    instead = Instead(module, text)
    sys.meta_path.insert(0, instead)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        status = int(pytest.main([*PYTEST, *map(str, tests)]))
    sys.exit(status if instead.is_loaded else NOT_LOADED)


def status_on(module: str, text: str, tests: Sequence[Path]) -> int | None:
    """Give pytest's status on a text, or none if the tests do not come to an end."""
    process = FORKED.Process(target=_run, args=(module, text, tests))
    process.start()
    process.join(PATIENCE_S)
    if process.exitcode is None:
        process.kill()
        process.join()
        return None
    return process.exitcode


def outcome_of(status: int | None) -> str:
    """Say whether the tests notice, by their status: failed, not collected, or without an end.

    Raises:
        SystemExit: The status tells nothing of the mutant, as that of no test found.
    """
    if status == pytest.ExitCode.OK:
        return SURVIVED
    if status in (None, pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED):
        return KILLED
    raise SystemExit(f"the tests were not run: status {status}")


def score(source: Path, tests: Sequence[Path], count: int | None, seed: int) -> tuple[int, int]:
    """Print a line for a source and each of its mutants that lives; give killed, and all.

    Raises:
        SystemExit: The tests fail on the source as it stands, or never load it.
    """
    text, module = source.read_text(encoding="utf-8"), module_of(source)
    load_others(module, tests)
    if outcome_of(status_on(module, text, tests)) == KILLED:
        raise SystemExit(f"{tests[0]}: fails without a mutant")
    mutants = list(mutants_of(text))
    if count is not None and count < len(mutants):
        mutants = random.Random(seed).sample(mutants, count)
    outcomes = [outcome_of(status_on(module, mutant.text, tests)) for mutant in mutants]
    return told(source, [mutant.change for mutant in mutants], outcomes)


def main() -> int:
    """Score the rules; 1 if too few mutants are killed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sources", type=Path, nargs="+", default=SOURCES, help="of scripts/")
    parser.add_argument("--tests", type=Path, nargs="+", default=TESTS, help="what tests it")
    parser.add_argument("--count", type=int, help="mutants of each, drawn; else all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--least", type=float, default=0.9, help="share to be killed")
    options = parser.parse_args()
    scored = [
        score(source, options.tests, options.count, options.seed) for source in options.sources
    ]
    return status_of(scored, options.least)


if __name__ == "__main__":
    sys.exit(main())
