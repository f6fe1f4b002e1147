"""The firmware from C++: every header compiles, and every exported function links, by g++."""

import re
import tomllib
from pathlib import Path

import pytest

from packages_rig import run, tool

HEADERS = sorted([*Path("firmware").glob("*/*.h"), *Path("hal/include").glob("*.h")])
UMBRELLA = Path("firmware/skiplatch.h")
INCLUDES = ("-Ifirmware", "-Ihal/include")
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", *INCLUDES)
OBJECTS = [
    Path("build/host/obj", f"{path.with_suffix('')}.o") for path in Path("firmware").glob("*/*.c")
]
MODULES = {path.stem for path in HEADERS}


@pytest.fixture(scope="module")
def compiler() -> str:
    return tool("g++", "packages")


@pytest.fixture(scope="module")
def exported() -> list[str]:
    """Name the global functions of the firmware, as the linker sees them."""
    listed = run("nm", "-g", "--defined-only", *OBJECTS)
    return sorted(re.findall(r"^[0-9a-f]+ T (\w+)$", listed, re.MULTILINE))


@pytest.mark.parametrize("standard", ["c++11", "c++20"])
def test_every_header_compiles_alone(compiler: str, standard: str, tmp_path: Path) -> None:
    for header in (*HEADERS, UMBRELLA):
        source = tmp_path / f"{header.stem}.cpp"
        source.write_text(f'#include "{header.resolve()}"\n')

        run(compiler, f"-std={standard}", *STRICT, "-fsyntax-only", source)


@pytest.mark.long
def test_every_function_links_from_a_port_in_cplusplus(
    compiler: str, exported: list[str], tmp_path: Path
) -> None:
    table = tmp_path / "exported.cpp"
    lines = [f'#include "{header.resolve()}"' for header in HEADERS]
    lines += ["extern void *const exported[];", "extern const unsigned exported_count;"]
    lines += ["void *const exported[] = {"]
    lines += [f"    reinterpret_cast<void *>(&{name})," for name in exported]
    lines += ["};", f"const unsigned exported_count = {len(exported)};"]
    table.write_text("\n".join(lines) + "\n")
    program = tmp_path / "port"

    run(compiler, "-std=c++11", *STRICT, "tests/packages/port.cpp", table,
        *OBJECTS, "-lm", "-o", program)  # fmt: skip

    assert len(exported) > 100
    assert run(program) == "1 1000 -4711 2\n"


def test_every_exported_name_begins_with_a_module(exported: list[str]) -> None:
    """A module is a header, or the first word or two of some: kinematics, transmission."""
    families = {"inject", "kinematics", "pretravel", "transmission"}
    strangers = [
        name
        for name in exported
        if not any(name == m or name.startswith(f"{m}_") for m in MODULES | families)
    ]

    assert strangers == []


def test_the_core_is_in_the_umbrella_header() -> None:
    text = UMBRELLA.read_text()
    core = [*Path("firmware/input").glob("*.h"), *Path("firmware/report").glob("*.h")]

    assert [path.name for path in core if f"{path.parent.name}/{path.name}" not in text] == []


def test_the_version_is_the_one_of_the_python_package() -> None:
    found = re.search(r'SKIPLATCH_VERSION "(\d+\.\d+\.\d+)"', UMBRELLA.read_text())
    project = tomllib.loads(Path("scripts/pyproject.toml").read_text())["project"]

    assert found is not None
    assert found[1] == project["version"]
