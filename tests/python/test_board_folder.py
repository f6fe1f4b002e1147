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
COMPILERS = {"avr": "avr-gcc", "arm": "arm-none-eabi-gcc", "riscv": "riscv64-unknown-elf-gcc"}
OBJECT = Path("build/boards", BOARD, "obj/firmware/input/latch.o")
ENVIRONMENT = {name: text for name, text in os.environ.items() if not name.startswith("MAKE")}


def call(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, check=False
    )


def make(folder: Path, *arguments: str) -> str:
    done = call(folder, "make", "-j2", "INNER=yes", *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def with_board(folder: Path, name: str, family: str, flags: str) -> Path:
    """Give the project with one board more, a copy of the template."""
    compiler = COMPILERS[family]
    if not shutil.which(compiler):
        pytest.skip(f"no {compiler} here: scripts/setup/system.sh cross riscv")
    for shared in SHARED:
        (folder / shared).symlink_to(ROOT / shared)
    for copied in ("hal", "docs"):
        shutil.copytree(ROOT / copied, folder / copied)
    shutil.copy(ROOT / "Makefile", folder)

    board = folder / "hal/ports" / name
    shutil.copytree(folder / "hal/ports/template", board)
    text = (board / "board.mk").read_text()
    text = text.replace("FAMILY.$(board) := host", f"FAMILY.$(board) := {family}")
    (board / "board.mk").write_text(f"{text}FLAGS.$(board) := {flags}\n")
    return folder


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project with one board more, compiled and linked."""
    folder = with_board(tmp_path_factory.mktemp("project"), BOARD, "avr", f"-mmcu={BOARD}")
    make(folder, f"linked-{BOARD}")
    return folder


@pytest.mark.parametrize(
    ("family", "flags"),
    [("arm", "-mcpu=cortex-m4 -mthumb"), ("riscv", "-march=rv32imac_zicsr -mabi=ilp32")],
)
def test_a_copy_of_the_template_compiles_for_each_family(
    family: str, flags: str, tmp_path: Path
) -> None:
    """Without the drivers that other boards share, and without an emulator: that is told."""
    folder = with_board(tmp_path, "myboard", family, flags)
    make(folder, "VARIANT=boards/myboard", "objects")

    emulators = {"arm": "qemu-system-arm", "riscv": "qemu-system-riscv32"}
    if shutil.which(emulators[family]):
        rule = "told:; @echo '$(call no_tools_of,myboard)'"
        told = make(folder, "--eval", rule, "told")
        assert told.startswith("no hal/ports/myboard/tests/emulator.py yet")


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
    named = re.compile(rf"\b(?:{'|'.join(boards)})\b")
    build = [ROOT / "Makefile", *ROOT.glob("mk/*.mk"), *ROOT.glob("scripts/*.*")]
    build += [ROOT / "scripts" / name for name in ("lint/size_table.py", "setup/system.sh")]
    for room in ("boards", "contract", "support"):
        build += ROOT.glob(f"tests/{room}/*")

    assert len(boards) >= 5
    found = [path.name for path in build if path.is_file() and named.search(path.read_text())]
    assert found == []
