"""Commands in README, docs and --help: each is run, and prints what stands below it.

Every command of skiplatch is parsed as it stands, effects and choices with it, and the project's
own files that it names are there. The blocks of a page are run in their order, in a folder of
their own; users_files.py has what stands for the files of a user. What stands below a command is
what it prints, in whole paragraphs, and on the pages of WHOLE all of it. What is not run here is
listed below: ELSEWHERE by the test that runs it, NOWHERE by the reason.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner

from documents import PAGES, ROOT, Example, examples, leaves, shown_by_help, words_of
from skiplatch.campaign import Campaign, fingerprint
from skiplatch.cli import group
from skiplatch.diagnosis import Diagnosis, diagnose
from users_files import put

WHOLE = "TUTORIAL.md"
NOT_YET = "stylus_bending"
"""An effect that a reader of docs/WITHHELD.md adds."""
FEWEST = {"blocks": 45, "commands": 55, "help": 65, "outputs": 9, "run": 45}
LONG = (
    "adopt",
    "bench believe",
    "compare scripts/samples/bench_isr_latency --pictures",
    "design",
    "diagnose",
    "kinematics run",
    "latch",
    "plan",
    "predict",
    "pretravel",
    "settle",
)
"""Beginnings of what takes more than a few seconds: run by `make long`."""
NIGHTLY = ("demo",)
"""Beginnings of what other tests run in parts, as test_demo_command.py does: by `make nightly`."""
MAKE = "make "
RIGS = ".venv/bin/python -m hal.ports."
EXPERIMENT = "tests/python/test_pretravel_experiment.py"
ELSEWHERE = {
    RIGS: "mk/on_board.mk",
    "build/host/skiplatch-recorder": "tests/bench/test_pulses.py",
    "candump vcan0 |": "tests/python/test_packages_can.py",
    "cc -DSKIPLATCH_IMPLEMENTATION": "tests/python/test_packages_packed.py",
    "cc main.c": "tests/python/test_packages_cmake.py",
    "cmake -S firmware": "tests/python/test_packages_cmake.py",
    "design build/tied": "tests/python/test_design_command.py",
    "design mill": "tests/python/test_design_command.py",
    "diagnose /srv/touches": "tests/python/test_spread_commands.py",
    "diagnose build/bench/nominal": "tests/python/test_bench_samples.py",
    "diagnose build/closed/after": EXPERIMENT,
    "diagnose build/cpu_load": "tests/python/test_bench_samples.py",
    "diagnose mill": "tests/python/test_ten_minutes.py",
    "diagnose scripts/samples/bench_isr_latency scripts": "tests/python/test_diagnose_command.py",
    "fleet watch": "tests/python/test_fleet_watch.py",
    "bench monitor": "tests/python/test_bench_command.py",
    "bench run": "tests/bench/test_bench_run.py",
    "pip install skiplatch": "tests/python/test_wheel.py",
    "python3 firmware/examples/can/read_log.py": "tests/python/test_packages_can.py",
    "python3 scripts/pack_firmware.py": "tests/python/test_packages_packed.py",
}
"""Beginnings of what another test runs, with other figures; what needs a bus or an emulator."""
NOWHERE = {
    "(umask 077; od": "draws a key at random; test_bench_seal.py has keys that are told",
    "/srv/skiplatch/bin/pip": "installs on a node of a cluster, over the network",
    "BENCH_OUT=": "records the samples in a virtual machine for twenty minutes",
    "candump -L": "needs a CAN bus of the kernel",
    "cd build/packages/linuxcnc": "installs into LinuxCNC as root; make linuxcnc compiles it",
    "diagnose build/boards/": "make boards records it in an emulator, for minutes",
    "diagnose build/haas/before": "takes minutes; of fewer runs it is diagnosed in " + EXPERIMENT,
    "import linuxcnc next-1.txt": "what a machine logs of its touches is missing",
    "modprobe vcan": "needs root and a module of the kernel",
    "python3.11 -m venv /srv": "installs on a node of a cluster",
    "settle mill made": "what a machine logs of its touches is missing",
    "sudo apt-get": "needs root",
    "sudo ip link": "needs root and a CAN controller",
}
"""Beginnings of what no test runs, and why."""
PYTHON_ELSEWHERE = {
    "API.md": "tests/python/test_api.py",
    "INJECTION.md": "tests/python/test_bench_command.py",
}
"""Pages with Python, and what runs it."""
PYTHON_NOWHERE = {"FLEET.md": "needs the scheduler of a cluster, Slurm"}
OUTPUT_ELSEWHERE = {
    "README.md: make demo": "tests/python/test_demo_command.py",
    "FLEET.md: skiplatch fleet check": "tests/python/test_fleet_check.py",
}
"""Beginnings of examples whose output another test compares."""
OUTPUT_NOWHERE = {
    "COMPENSATION.md: skiplatch pretravel --rig haas --seed 1 --record": "is that of a diagnosis "
    "of minutes"
}
EXAMPLES = [example for path in PAGES for example in examples(path) if NOT_YET not in example.text]
BLOCKS = [example for example in EXAMPLES if example.language == "sh"]

pytestmark = pytest.mark.xdist_group("documents")


def begins(text: str, beginnings: Sequence[str]) -> bool:
    return text.startswith(tuple(beginnings))


def named(line: str) -> str:
    """Give a command as the tables above name it: without `skiplatch`."""
    return " ".join(words_of(line)) or line


def is_run(line: str) -> bool:
    """Whether it is one of skiplatch that can be run here."""
    return bool(words_of(line)) and not begins(named(line), [*ELSEWHERE, *NOWHERE])


def is_long(block: Example) -> bool:
    return any(is_run(line) and begins(named(line), [*LONG, *NIGHTLY]) for line in block.lines)


def documented() -> list[tuple[str, list[str]]]:
    return [
        (block.page, words) for block in BLOCKS for line in block.lines if (words := words_of(line))
    ]


def runnable_pages() -> list[Any]:
    """Give the blocks of each page that are run: the quick ones, and if there are others, all."""
    pages: dict[str, list[Example]] = {}
    for block in BLOCKS:
        if any(map(is_run, block.lines)):
            pages.setdefault(block.page, []).append(block)
    cases = []
    for page, blocks in pages.items():
        quick = [block for block in blocks if not is_long(block)]
        if quick:
            cases.append(pytest.param(quick, id=page))
        if len(quick) < len(blocks):
            cases.append(pytest.param(blocks, id=f"{page}, all", marks=pytest.mark.long))
    return cases


def marks_of(commands: Sequence[str]) -> list[pytest.MarkDecorator]:
    """Give the suite that commands are run in, if it is not `make test`."""
    marks = [(pytest.mark.nightly, NIGHTLY), (pytest.mark.long, LONG)]
    return [mark for mark, some in marks if any(begins(one, some) for one in commands)][:1]


def runnable_help() -> list[Any]:
    """Give the examples of each --help that run here and on no page."""
    on_pages = [words for _, words in documented()]
    examples: dict[str, list[list[str]]] = {}
    for where, words in shown_by_help():
        if not begins(" ".join(words), [*ELSEWHERE, *NOWHERE]):
            examples.setdefault(where, []).append(words)
    return [
        pytest.param(
            commands,
            id=where,
            marks=marks_of([" ".join(words) for words in commands]),
        )
        for where, commands in examples.items()
        if not all(words in on_pages for words in commands)
    ]


def parse(words: list[str]) -> None:
    """Parse a command to its end, without doing anything."""
    command: click.Command = group
    while isinstance(command, click.Group):
        found = command.get_command(click.Context(command), words[0])
        assert found is not None, f"no command {words[0]}"
        command, words = found, words[1:]
    with command.make_context(command.name, list(words)) as context:
        assert context.params


def run(words: list[str]) -> str:
    """Run a command of skiplatch; give what it prints."""
    put(words)
    result = CliRunner().invoke(group, words, catch_exceptions=False)
    assert result.exit_code == 0, f"{' '.join(words)}\n{result.output}"
    return "".join(f"{line.rstrip()}\n" for line in result.output.splitlines())


@pytest.fixture(autouse=True)
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that has the project's files, and an empty build/."""
    for name in ("scripts", "tests", "docs"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "build").mkdir()
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(("where", "words"), [*documented(), *shown_by_help()], ids=str)
def test_command_is_one(where: str, words: list[str]) -> None:
    if words in (["COMMAND"], ["--help"]):
        return
    parse(words)
    own = [word for word in words if word.startswith(("scripts/", "tests/", "docs/"))]
    assert [word for word in own if not Path(word).exists()] == []


DIAGNOSED: dict[str, Diagnosis] = {}


@pytest.fixture(autouse=True)
def diagnosed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Diagnose once what several pages diagnose, wherever it lies, asked in the same way."""

    def known(campaign: Campaign, **told: object) -> Diagnosis:
        touches = f"{fingerprint(campaign.touches)} {sorted(campaign.stood_in)}"
        key = f"{touches} {campaign.nominal!r} {told!r}"
        if key not in DIAGNOSED:
            DIAGNOSED[key] = diagnosis_of(campaign, **told)
        return DIAGNOSED[key]

    diagnosis_of: Callable[..., Diagnosis] = diagnose
    monkeypatch.setattr("skiplatch.commands.examining.diagnose", known)


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
@pytest.mark.parametrize("blocks", runnable_pages())
def test_commands_of_a_page_print_what_stands_below_them(blocks: list[Example]) -> None:
    for block in blocks:
        said = "".join(run(words_of(line)) for line in block.lines if is_run(line))

        if block.output and not begins(str(block), [*OUTPUT_ELSEWHERE, *OUTPUT_NOWHERE]):
            compare(block, said)


def compare(block: Example, said: str) -> None:
    if block.page == WHOLE:
        assert said == block.output, block
    for paragraph in block.output.strip().split("\n\n"):
        assert paragraph in said, block


@pytest.mark.filterwarnings("ignore::skiplatch.errors.CampaignWarning")
@pytest.mark.parametrize("commands", runnable_help())
def test_examples_of_help_run(commands: list[list[str]]) -> None:
    for words in commands:
        run(words)


def others() -> Iterator[str]:
    """Give what the pages and --help show and is not run here."""
    for block in BLOCKS:
        yield from (named(line) for line in block.lines if not is_run(line))
    for _, words in shown_by_help():
        if begins(" ".join(words), [*ELSEWHERE, *NOWHERE]):
            yield " ".join(words)


def test_what_is_not_run_here_is_listed() -> None:
    unlisted = [line for line in others() if not begins(line, [*ELSEWHERE, *NOWHERE, MAKE])]

    assert unlisted == []


@pytest.mark.parametrize("beginning", [*ELSEWHERE, *NOWHERE])
def test_what_is_listed_stands_on_a_page_or_in_help(beginning: str) -> None:
    assert any(line.startswith(beginning) for line in others())


@pytest.mark.parametrize(
    ("what", "why"), [*NOWHERE.items(), *PYTHON_NOWHERE.items(), *OUTPUT_NOWHERE.items()]
)
def test_what_no_test_runs(what: str, why: str) -> None:
    pytest.skip(f"{what} …: {why}")


@pytest.mark.parametrize(
    "path", sorted({*ELSEWHERE.values(), *PYTHON_ELSEWHERE.values(), *OUTPUT_ELSEWHERE.values()})
)
def test_what_runs_it_elsewhere_is_there(path: str) -> None:
    assert (ROOT / path).is_file()


def test_rigs_of_boards_are_there() -> None:
    modules = [line.split()[2] for line in others() if line.startswith(RIGS)]

    assert [name for name in modules if not (ROOT / f"{name.replace('.', '/')}.py").is_file()] == []


def test_python_and_outputs_are_tested_somewhere() -> None:
    with_python = {example.page for example in EXAMPLES if example.language == "python"}
    outputs = [str(block) for block in BLOCKS if block.output and not any(map(is_run, block.lines))]

    assert with_python == {*PYTHON_ELSEWHERE, *PYTHON_NOWHERE}
    assert [one for one in outputs if not begins(one, list(OUTPUT_ELSEWHERE))] == []


def test_targets_of_make_are_there() -> None:
    makefiles = [ROOT / "Makefile", *ROOT.glob("mk/*.mk"), *ROOT.glob("hal/ports/*/board.mk")]
    rules = "\n".join(path.read_text() for path in makefiles)
    lines = [line for block in BLOCKS for line in block.lines if line.startswith(MAKE)]

    for target in (line.split()[1] for line in lines):
        assert re.search(rf"^[\w -]*\b{target}\b[\w -]*:.* ##", rules, re.MULTILINE), target


def test_commands_are_found() -> None:
    assert len(BLOCKS) >= FEWEST["blocks"]
    assert len(documented()) >= FEWEST["commands"]
    assert sum(bool(block.output) for block in BLOCKS) >= FEWEST["outputs"]
    assert len(shown_by_help()) >= FEWEST["help"]
    assert len(runnable_help()) + len(runnable_pages()) >= FEWEST["run"]


def test_every_command_shows_an_example() -> None:
    shown = {where for where, _ in shown_by_help()}

    assert [name for name, _ in leaves(group, "skiplatch") if f"{name} --help" not in shown] == []
