"""What the single header puts into a user's C file beside his own names; the LinuxCNC component."""

import re
import shutil
from pathlib import Path

import pytest

from packages_rig import packed_into, run, tool
from tests.packages.halcompile import as_c

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
PLAIN = (
    *("arm", "disarm", "push", "pop", "clear", "count", "end", "get", "init", "keep", "next"),
    *("poll", "put", "reset", "start", "step", "stop", "take", "update", "wait"),
)
LOCAL = r" [tdbr] (?!ticks_)([A-Za-z]\w+)$"
"""In a list by nm; those of ticks.h are for everybody."""


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return packed_into(tmp_path_factory.mktemp("packed"))


@pytest.fixture(scope="module")
def core(packed: Path) -> list[Path]:
    """List the C files of the core."""
    return sorted((packed / "skiplatch/src").rglob("*.c"))


@pytest.fixture(scope="module")
def local(packed: Path, core: list[Path], tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Name what the C files of the core have for themselves."""
    made = tmp_path_factory.mktemp("objects")
    listed = ""
    for source in core:
        # What is inlined or unused has no name any more.
        run("gcc", "-std=c99", "-O0", f"-I{packed / 'skiplatch/src'}", "-c", source,
            "-o", made / "one.o")  # fmt: skip
        listed += run("nm", made / "one.o")
    return set(re.findall(LOCAL, listed, re.MULTILINE))


def macros(header: Path, *words: str) -> set[str]:
    defined = run("gcc", "-std=c99", *words, "-dM", "-E", "-x", "c", header)
    return set(re.findall(r"^#define (\w+)", defined, re.MULTILINE))


def test_single_header_stands_beside_a_users_functions_of_plain_names(
    packed: Path, local: set[str], tmp_path: Path
) -> None:
    names = sorted({*PLAIN, *local})
    user = tmp_path / "user.c"
    lines = ["#define SKIPLATCH_IMPLEMENTATION", '#include "skiplatch.h"']
    lines += [f"double {name}(double value);" for name in names]
    lines += [f"double {name}(double value) {{ return value; }}" for name in names]
    user.write_text("\n".join(lines) + "\n")

    run("gcc", *STRICT, f"-I{packed}", "-c", user, "-o", tmp_path / "user.o")

    assert {"arm", "count", "approach", "update_byte"} <= set(names)


def test_what_the_single_header_has_for_itself_bears_the_projects_name(
    packed: Path, tmp_path: Path
) -> None:
    text = (packed / "skiplatch.h").read_text()
    made = tmp_path / "all.o"
    run("gcc", *STRICT, "-O0", "-DSKIPLATCH_IMPLEMENTATION", "-x", "c", "-c",
        packed / "skiplatch.h", "-o", made)  # fmt: skip
    local = set(re.findall(LOCAL, run("nm", made), re.MULTILINE))
    system = tmp_path / "system.h"  # what the C library defines is not ours
    system.write_text("".join(re.findall(r"^#include <.*\n", text, re.MULTILINE)))
    shown = macros(packed / "skiplatch.h") | macros(system)
    own = macros(packed / "skiplatch.h", "-DSKIPLATCH_IMPLEMENTATION") - shown

    assert "skiplatch_latch_arm" in local
    assert [name for name in local if not name.startswith("skiplatch_")] == []
    assert "SKIPLATCH_OVERTRAVEL_UM_PER_MM" in own
    assert [name for name in own if not name.startswith("SKIPLATCH_")] == []


def test_members_and_comments_keep_their_names(packed: Path) -> None:
    text = (packed / "skiplatch.h").read_text()

    assert "->skiplatch_" not in text
    assert ".skiplatch_" not in text
    assert "/* The next record tells of it. */\nstatic void skiplatch_latch_count_lost(" in text


def test_the_component_of_linuxcnc_compiles_without_linuxcnc(packed: Path, tmp_path: Path) -> None:
    component = (packed / "linuxcnc/skiplatch.comp").read_text()
    source = tmp_path / "component.c"
    source.write_text(as_c(component))

    run("gcc", "-std=gnu99", "-O2", "-Wall", "-Wextra", "-Werror", f"-I{packed / 'linuxcnc'}",
        "-c", source, "-o", tmp_path / "component.o")  # fmt: skip

    exported = re.findall(r" T (\w+)", run("nm", tmp_path / "component.o"))
    assert {"fast", "servo", "latch_on_edge"} <= set(exported)


def test_the_component_compiles_by_halcompile(packed: Path, tmp_path: Path) -> None:
    halcompile = tool("halcompile", "linuxcnc")
    folder = tmp_path / "linuxcnc"
    shutil.copytree(packed / "linuxcnc", folder)

    run("env", "-C", folder, halcompile, "--compile", "skiplatch.comp")

    assert (folder / "skiplatch.so").is_file()
