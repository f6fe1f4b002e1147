"""A board is one folder: a copy of the template joins the build by what is edited inside it."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHARED = (".venv", "firmware", "host_sim", "mk", "scripts", "tests")
BOARD = "atmega1284p"
OBJECT = Path("build/boards", BOARD, "obj/firmware/input/latch.o")
ENVIRONMENT = {name: text for name, text in os.environ.items() if not name.startswith("MAKE")}


def call(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, check=False
    )


def make(folder: Path, *arguments: str) -> None:
    done = call(folder, "make", "-j2", "INNER=yes", *arguments)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project with one board more, compiled and linked."""
    if not shutil.which("avr-gcc"):
        pytest.skip("no avr-gcc here: scripts/setup/system.sh cross")
    folder = tmp_path_factory.mktemp("project")
    for name in SHARED:
        (folder / name).symlink_to(ROOT / name)
    for name in ("hal", "docs"):
        shutil.copytree(ROOT / name, folder / name)
    shutil.copy(ROOT / "Makefile", folder)

    board = folder / "hal/ports" / BOARD
    shutil.copytree(folder / "hal/ports/template", board)
    text = (board / "board.mk").read_text()
    text = text.replace("FAMILY.$(board) := host", "FAMILY.$(board) := avr")
    (board / "board.mk").write_text(f"{text}FLAGS.$(board) := -mmcu={BOARD}\n")
    make(folder, f"linked-{BOARD}")
    return folder


def test_it_is_listed(project: Path) -> None:
    done = call(project, "make", "board")

    assert done.returncode == 2
    assert BOARD in done.stderr
    assert "template" not in done.stderr


def test_its_contract_suites_are_built(project: Path) -> None:
    make(project, f"VARIANT=boards/{BOARD}", f"build/boards/{BOARD}/contract/test_hal_error")


def test_its_sizes_are_recorded(project: Path) -> None:
    record = project / "docs/SIZE.md"
    assert BOARD not in record.read_text()

    done = call(project, ".venv/bin/python", "scripts/lint/size_table.py", "record", f"{BOARD}:avr")
    assert done.returncode == 0, done.stderr
    row = re.search(rf"^\| {BOARD} \| program \| (\d+) \|", record.read_text(), re.MULTILINE)
    assert row is not None
    assert int(row[1]) > 1000


def test_a_rule_that_changes_compiles_nothing_anew_and_a_flag_does(project: Path) -> None:
    made_ns = (project / OBJECT).stat().st_mtime_ns
    (project / "Makefile").touch()
    (project / "hal/ports" / BOARD / "board.mk").touch()
    make(project, f"VARIANT=boards/{BOARD}", str(OBJECT))
    assert (project / OBJECT).stat().st_mtime_ns == made_ns

    with (project / "hal/ports" / BOARD / "board.mk").open("a") as rules:
        rules.write("FLAGS.$(board) += -DANOTHER\n")
    make(project, f"VARIANT=boards/{BOARD}", str(OBJECT))
    assert (project / OBJECT).stat().st_mtime_ns > made_ns


def test_no_other_file_of_the_build_names_a_board() -> None:
    boards = [path.parent.name for path in ROOT.glob("hal/ports/*/board.mk")]
    named = re.compile(rf"\b(?:{'|'.join(set(boards) - {'linux', 'template'})})\b")
    build = [ROOT / "Makefile", *ROOT.glob("mk/*.mk"), *ROOT.glob("scripts/*.*")]
    build += [*ROOT.glob("tests/boards/*"), *ROOT.glob("tests/support/*")]

    assert len(boards) >= 5
    found = [path.name for path in build if path.is_file() and named.search(path.read_text())]
    assert found == []
