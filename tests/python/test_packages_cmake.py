"""The CMake package, pkg-config, and what ESP-IDF and Zephyr read: built, installed and used."""

import json
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest

from packages_rig import run, tool

FIRMWARE = Path("firmware")
DESK = FIRMWARE / "examples/desk"
TOUCHED = "touched at tick 1000, count 4711, bounces 1\n"
EXTENSIONS = ("kinematics", "pretravel", "transmission", "injection")


def configure(source: Path, build: Path, *definitions: str) -> None:
    tool("ninja", "packages")
    run(tool("cmake", "packages"), "-G", "Ninja", "-S", source, "-B", build, *definitions)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the package and install it into a folder of its own."""
    folder = tmp_path_factory.mktemp("cmake")
    configure(FIRMWARE, folder / "build", f"-DCMAKE_INSTALL_PREFIX={folder / 'usr'}",
              "-DCMAKE_INSTALL_LIBDIR=lib", "-DCMAKE_C_FLAGS=-Wall -Wextra -Werror")  # fmt: skip
    run("cmake", "--build", folder / "build", "--target", "install")
    return folder / "usr"


def test_find_package_builds_the_example(installed: Path, tmp_path: Path) -> None:
    configure(DESK, tmp_path, f"-DCMAKE_PREFIX_PATH={installed}")
    run("cmake", "--build", tmp_path)

    assert run(tmp_path / "desk") == TOUCHED


@pytest.mark.parametrize(
    ("wanted", "refusal"),
    [("COMPONENTS core polishing", "polishing"), ("0.1", '"0.1"'), ("0.99", '"0.99"')],
)
def test_find_package_refuses_what_is_not_there(
    installed: Path, tmp_path: Path, wanted: str, refusal: str
) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(refused LANGUAGES C)\n"
        f"find_package(skiplatch {wanted} REQUIRED)\n"
    )
    done = subprocess.run(
        [tool("cmake", "packages"), "-S", tmp_path, "-B", tmp_path / "b",
         f"-DCMAKE_PREFIX_PATH={installed}"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip

    assert done.returncode != 0
    assert refusal in done.stderr


INTERNAL = ("kinematics_problem", "kinematics_qr", "kinematics_coverage", "kinematics_slots",
            "kinematics_writes", "kinematics_requests", "transmission_gate")  # fmt: skip


def test_installed_headers_are_those_for_users_and_whole(installed: Path) -> None:
    """Whatever says who alone uses it stays behind, and no header that is there asks for it."""
    folder = installed / "include/skiplatch"
    headers = sorted(folder.rglob("*.h"))
    assert not {path.stem for path in headers} & set(INTERNAL)
    for header in headers:
        run("gcc", "-std=c99", "-fsyntax-only", "-Wno-pragma-once-outside-header", f"-I{folder}",
            "-include", header, "-x", "c", "/dev/null")  # fmt: skip


def test_the_messages_are_installed_as_a_dbc(installed: Path) -> None:
    assert (installed / "share/skiplatch/injection.dbc").read_bytes() == Path(
        "docs/injection.dbc"
    ).read_bytes()


def beside_a_parent(folder: Path, *definitions: str) -> Path:
    """Build the firmware within another project, install that, and give where it went."""
    (folder / "parent.c").write_text("int main(void) { return 0; }\n")
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(parent LANGUAGES C)\n"
        f"add_subdirectory({FIRMWARE.resolve()} skiplatch)\n"
        "add_executable(parent parent.c)\n"
        "target_link_libraries(parent PRIVATE skiplatch::core)\n"
        "install(TARGETS parent)\n"
    )
    usr = folder / "usr"
    configure(folder, folder / "build", f"-DCMAKE_INSTALL_PREFIX={usr}", *definitions)
    run("cmake", "--build", folder / "build", "--target", "install")
    return usr


def test_within_another_project_nothing_is_installed(tmp_path: Path) -> None:
    usr = beside_a_parent(tmp_path)

    assert [path.relative_to(usr) for path in usr.rglob("*") if path.is_file()] == [
        Path("bin/parent")
    ]


def test_within_another_project_it_is_installed_if_asked_for(tmp_path: Path) -> None:
    usr = beside_a_parent(tmp_path, "-DSKIPLATCH_INSTALL=ON")

    assert (usr / "include/skiplatch/skiplatch.h").is_file()


def flags_of_the_latch(folder: Path, *definitions: str) -> str:
    configure(FIRMWARE, folder, "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *definitions)
    entries = json.loads((folder / "compile_commands.json").read_text())
    return next(str(entry["command"]) for entry in entries if entry["file"].endswith("latch.c"))


@pytest.mark.parametrize(
    ("definitions", "is_independent"),
    [
        ([], False),
        (["-DCMAKE_POSITION_INDEPENDENT_CODE=ON"], True),
        (["-DBUILD_SHARED_LIBS=ON"], True),
    ],
)
def test_code_is_independent_of_its_position_only_where_asked_for(
    definitions: list[str], *, is_independent: bool, tmp_path: Path
) -> None:
    """On a microcontroller it would move constants from flash into RAM."""
    assert ("-fPIC" in flags_of_the_latch(tmp_path, *definitions)) == is_independent


def build_by_pkg_config(folder: Path, program: Path) -> None:
    environment = {**os.environ, "PKG_CONFIG_PATH": str(folder)}
    flags = subprocess.run(
        [tool("pkg-config", "packages"), "--cflags", "--libs", "skiplatch"],
        env=environment, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    run("gcc", DESK / "main.c", *shlex.split(flags), "-o", program)


def test_pkg_config_builds_the_example(installed: Path, tmp_path: Path) -> None:
    build_by_pkg_config(installed / "lib/pkgconfig", tmp_path / "desk")

    assert run(tmp_path / "desk") == TOUCHED


@pytest.mark.parametrize("prefix", ["elsewhere", "with a space"])
def test_pkg_config_finds_what_was_installed_elsewhere(
    installed: Path, tmp_path: Path, prefix: str
) -> None:
    run("cmake", "--install", installed.parent / "build", "--prefix", tmp_path / prefix)
    build_by_pkg_config(tmp_path / prefix / "lib/pkgconfig", tmp_path / "desk")

    assert run(tmp_path / "desk") == TOUCHED


@pytest.mark.parametrize("absolute", [("LIBDIR",), ("INCLUDEDIR",), ("LIBDIR", "INCLUDEDIR")])
def test_pkg_config_finds_absolute_folders(absolute: tuple[str, ...], tmp_path: Path) -> None:
    folders = {name: str(tmp_path / "far off" / name.lower()) for name in absolute}
    definitions = [f"-DCMAKE_INSTALL_{name}={folder}" for name, folder in folders.items()]
    prefix = f"-DCMAKE_INSTALL_PREFIX={tmp_path / 'to here'}"
    configure(FIRMWARE, tmp_path / "build", prefix, *definitions)
    run("cmake", "--build", tmp_path / "build", "--target", "install")
    found = next(tmp_path.glob("*/**/pkgconfig/skiplatch.pc"))
    build_by_pkg_config(found.parent, tmp_path / "desk")

    assert run(tmp_path / "desk") == TOUCHED


def test_every_file_belongs_to_one_library(installed: Path) -> None:
    names = {"core": "skiplatch", **{part: f"skiplatch_{part}" for part in EXTENSIONS}}
    members: list[str] = []
    for name in names.values():
        members += run("ar", "t", installed / f"lib/lib{name}.a").split()

    assert sorted(members) == sorted(f"{path.name}.o" for path in FIRMWARE.glob("*/*.c"))


def test_the_core_needs_no_extension(installed: Path) -> None:
    listed = run("nm", "--undefined-only", installed / "lib/libskiplatch.a")
    undefined = set(re.findall(r"U (\w+)", listed))
    own = set(re.findall(r"T (\w+)", run("nm", installed / "lib/libskiplatch.a")))
    of_others = {name for name in undefined - own if not name.startswith("hal_")}

    assert of_others <= {"memcmp", "memcpy", "memmove", "sqrt", "__stack_chk_fail",
                         "_GLOBAL_OFFSET_TABLE_"}  # fmt: skip


@pytest.mark.parametrize(("system", "extension"), [("esp_idf", "inject"), ("zephyr", "pretravel")])
def test_a_stand_in_builds_component_and_example(
    system: str, extension: str, tmp_path: Path
) -> None:
    """The true systems are not at hand: what their CMake would be asked is answered here."""
    module = (FIRMWARE / "zephyr/module.yml").read_text()
    cmake_folder = re.search(r"cmake: (\w+)", module)
    assert cmake_folder is not None
    definitions = {
        "FIRMWARE": FIRMWARE.resolve(),
        "MODULE_CMAKE": cmake_folder[1],
        "CMAKE_EXPORT_COMPILE_COMMANDS": "ON",
    }
    stand_in = Path("tests/packages", system)
    configure(stand_in, tmp_path, *(f"-D{name}={value}" for name, value in definitions.items()))
    run("cmake", "--build", tmp_path)

    compiled = {
        Path(entry["file"]).relative_to(FIRMWARE.resolve())
        for entry in json.loads((tmp_path / "compile_commands.json").read_text())
    }
    assert Path("input/latch.c") in compiled
    assert any(path.name.startswith(extension) for path in compiled)
    assert not any("kinematics" in path.name for path in compiled)
    assert Path("examples", system) in {
        path.parents[-3] for path in compiled if len(path.parents) > 2
    }


@pytest.mark.parametrize(
    ("system", "source", "ticks"),
    [
        ("esp_idf", "main/main.c", "CONFIG_FREERTOS_HZ"),
        ("zephyr", "src/main.c", "CONFIG_SYS_CLOCK_TICKS_PER_SEC"),
    ],
)
def test_an_example_refuses_a_clock_by_which_it_would_poll_too_seldom(
    system: str, source: str, ticks: str
) -> None:
    """A glitch and a touch between two polls are one: the rule is to poll within confirm_ticks."""
    command: list[str | Path] = [
        "gcc", "-std=gnu11", "-fsyntax-only", f"-Itests/packages/{system}/include", f"-I{FIRMWARE}",
        "-Ihal/include", FIRMWARE / "examples" / system / source,
    ]  # fmt: skip
    done = subprocess.run([*command, f"-D{ticks}=100"], capture_output=True, text=True, check=False)

    assert done.returncode != 0
    assert f"{ticks}=" in done.stderr
    run(*command, f"-D{ticks}=10000" if system == "zephyr" else f"-D{ticks}=1000")


def test_kconfig_offers_every_extension() -> None:
    offered = re.findall(r"^config SKIPLATCH_(\w+)", (FIRMWARE / "Kconfig").read_text(), re.M)

    assert sorted(name.lower() for name in offered) == sorted(EXTENSIONS)
