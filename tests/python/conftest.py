"""What all Python tests share."""

import shutil
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

from browser import Browser, browser, chromium
from refusals import Program
from skiplatch import cli

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "scripts" / "samples"

# Every run tries the same cases, so that a red build can be repeated; `--hypothesis-profile
# explore` looks for new ones.
settings.register_profile("steady", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, max_examples=2000)
settings.load_profile("steady")


@cache
def is_group(file: str) -> bool:
    """Whether the tests of a file share what is dear to make."""
    return "pytest.mark.xdist_group(" in (ROOT / file).read_text(encoding="utf-8")


def scope_of(nodeid: str) -> str:
    """Give what a test is handed out with: its file, if that is marked as a group, else itself."""
    file = nodeid.partition("::")[0]
    return file if is_group(file) else nodeid


def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Hand out groups whole and first, all other tests one by one.

    xdist 3.8 has it from the names of tests, to which it adds their group; pytest 9.2 makes the
    names anew, so that no group is kept together.
    """
    if config.getoption("dist") != "loadgroup":
        return None
    scheduling = LoadScopeScheduling(config, log)
    scheduling._split_scope = scope_of
    return scheduling


@pytest.fixture
def bench_sample() -> Path:
    """A recorded bench campaign whose skip input latches late."""
    return SAMPLES / "bench_isr_latency"


@pytest.fixture
def machine_sample() -> Path:
    """A recorded machine campaign without a gap."""
    return SAMPLES / "machine_no_gap"


@pytest.fixture
def refused(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Program:
    """The program, called with bad input: ends with 2; gives the one line that it says.

    Beside others that are good it may print what came of them, where `is_silent` is not asked for.
    """

    def call(*arguments: object, is_silent: bool = False) -> str:
        monkeypatch.setattr(sys, "argv", ["skiplatch", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        out, said = capsys.readouterr()
        assert not (is_silent and out)
        assert ended.value.code == cli.BAD_INPUT
        assert said.count("\n") == 1
        return said

    return call


@pytest.fixture
def unrendered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages have empty pictures, with their words: to render them takes most of a page's time."""
    empty = '<svg viewBox="0 0 1 1"></svg>'
    monkeypatch.setattr("skiplatch.figures.theme.svg_of", lambda _: empty)


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A headless browser; without one what needs it is skipped."""
    program = chromium()
    if program is None:
        pytest.skip("no Chromium that sees temporary files: no page is opened in a browser")
    profile = tmp_path_factory.mktemp("chromium")
    with browser(program, profile) as opened:
        yield opened
    shutil.rmtree(profile, ignore_errors=True)
