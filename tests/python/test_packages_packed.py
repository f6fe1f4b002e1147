"""What pack_firmware.py writes: the single header, and the library for Arduino and PlatformIO."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from packages_rig import CORES, packed_into, run, stamps_of, tool, uno_run

EXAMPLES = ("SkipInput", "PlcTask")
TOUCHED = "touched at tick 1000, count 4711, bounces 1\n"
ALL_WARNINGS = ("-Wall", "-Wextra", "-Werror")
# The old compiler for the AVR does not give C++ this name of C99, which the Arduino core wants.
OLD_COMPILER = "compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__"


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return packed_into(tmp_path_factory.mktemp("packed"))


@pytest.fixture(scope="module")
def uno(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return uno_run(tmp_path_factory.mktemp("uno"))


def test_it_packs_the_same_from_anywhere(packed: Path, tmp_path: Path) -> None:
    script = Path("scripts/pack_firmware.py").resolve()
    done = subprocess.run(
        [sys.executable, script, "vendor"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == "vendor/skiplatch"
    found = {
        folder: {
            path.relative_to(folder): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file()
        }
        for folder in (packed, tmp_path / "vendor")
    }
    assert found[packed] == found[tmp_path / "vendor"]


def test_single_header_builds_the_example(packed: Path, tmp_path: Path) -> None:
    """Whatever of the core is not used is dropped, and with it the functions it would ask for."""
    run("gcc", "-std=c99", *ALL_WARNINGS, "-Wpedantic", "-DSKIPLATCH_IMPLEMENTATION", f"-I{packed}",
        "-ffunction-sections", "-Wl,--gc-sections", "firmware/examples/desk/main.c",
        "-lm", "-o", tmp_path / "desk")  # fmt: skip

    assert run(tmp_path / "desk") == TOUCHED


def test_single_header_holds_all_of_the_core(packed: Path, tmp_path: Path) -> None:
    run("gcc", "-std=c99", *ALL_WARNINGS, "-DSKIPLATCH_IMPLEMENTATION", "-x", "c", "-c",
        packed / "skiplatch.h", "-o", tmp_path / "all.o")  # fmt: skip
    exported = re.findall(r" T (\w+)", run("nm", tmp_path / "all.o"))

    for name in ("skip_input_on_edge", "plc_task_scan", "touch_cycle_poll", "latch_stream_take"):
        assert name in exported


def test_single_header_can_be_included_from_cplusplus(packed: Path, tmp_path: Path) -> None:
    source = tmp_path / "user.cpp"
    source.write_text('#include "skiplatch.h"\n#include "skiplatch.h"\nlatch_t latch;\n')

    run(
        tool("g++", "packages"), "-std=c++11", *ALL_WARNINGS, f"-I{packed}", "-fsyntax-only", source
    )


def build_for_uno(packed: Path, example: str, build: Path) -> Path:
    """Build a sketch by Arduino's own builder, from the core that Debian packs."""
    builder = tool("arduino-builder", "arduino")
    if not CORES.exists():
        pytest.skip("no Arduino core here: scripts/setup/system.sh arduino")
    build.mkdir()
    run(builder, "-compile", "-fqbn", "arduino:avr:uno", "-prefs", OLD_COMPILER,
        "-hardware", "/usr/share/arduino/hardware", "-hardware", "/usr/share/arduino-builder",
        "-tools", "/usr/bin", "-tools", "/usr/share/arduino", "-libraries", packed,
        "-build-path", build,
        packed / f"skiplatch/examples/{example}/{example}.ino")  # fmt: skip
    return build / f"{example}.ino.elf"


def test_skip_input_on_an_uno_stamps_the_first_edges(
    packed: Path, uno: Path, tmp_path: Path
) -> None:
    """Touches at 100,000 and 150,300 µs; micros() begins some 100 µs late and counts in fours."""
    stamps = stamps_of(uno, build_for_uno(packed, "SkipInput", tmp_path / "build"))

    assert len(stamps) == 2
    assert abs(stamps[1] - stamps[0] - 50_300) <= 8
    assert 99_800 <= stamps[0] <= 100_000


def test_plc_task_on_an_uno_stamps_its_scans(packed: Path, uno: Path, tmp_path: Path) -> None:
    """The scans are 1,000 µs apart, and the touches 50,300."""
    stamps = stamps_of(uno, build_for_uno(packed, "PlcTask", tmp_path / "build"))

    assert len(stamps) == 2
    assert abs(stamps[1] - stamps[0] - 51_000) <= 40
    assert 99_800 <= stamps[0] <= 101_000


def test_arduino_hal_keeps_the_contract(packed: Path, tmp_path: Path) -> None:
    """On the host, the core of the AVR stood in for; each line is a promise that is broken."""
    run(tool("g++", "packages"), "-std=gnu++11", *ALL_WARNINGS, f"-I{packed / 'skiplatch/src'}",
        "-Itests/packages/arduino", "tests/packages/arduino_hal.cpp",
        "-o", tmp_path / "hal")  # fmt: skip

    assert run(tmp_path / "hal") == ""


@pytest.mark.parametrize("example", EXAMPLES)
def test_sketches_compile_for_a_pico_against_a_stand_in(
    packed: Path, example: str, tmp_path: Path
) -> None:
    """No Arduino core of the RP2040 is at hand: its functions are declared by a stand-in."""
    tool("arm-none-eabi-gcc", "cross")
    library = packed / "skiplatch/src"
    flags = ("-Os", "-mcpu=cortex-m0plus", "-mthumb", *ALL_WARNINGS, f"-I{library}")
    sketch = packed / f"skiplatch/examples/{example}/{example}.ino"
    run("arm-none-eabi-g++", "-std=gnu++11", *flags, "-Itests/packages/arduino",
        "-x", "c++", "-c", sketch, "-o", tmp_path / "sketch.o")  # fmt: skip
    objects = []
    for source in sorted(library.rglob("*.c")):
        objects.append(tmp_path / f"{source.stem}.o")
        run("arm-none-eabi-gcc", *flags, "-c", source, "-o", objects[-1])
    run("arm-none-eabi-ld", "-r", tmp_path / "sketch.o", *objects, "-o", tmp_path / "all.o")

    undefined = set(re.findall(r"U (\w+)", run("arm-none-eabi-nm", tmp_path / "all.o")))
    assert {"skip_input_start", "plc_task_scan", "hal_axis_position_counts"}.isdisjoint(undefined)


def test_the_manifests_promise_what_the_hal_compiles_for(packed: Path) -> None:
    """AVR and Cortex-M: elsewhere skiplatch_arduino.hpp ends in an #error."""
    properties = (packed / "skiplatch/library.properties").read_text()
    manifest = json.loads((packed / "skiplatch/library.json").read_text())
    architectures = re.search(r"^architectures=(.*)$", properties, re.M)

    assert architectures is not None
    assert set(architectures[1].split(",")) <= {"avr", "sam", "samd", "rp2040", "stm32", "nrf52"}
    assert manifest["frameworks"] == "arduino"
    assert set(manifest["platforms"]) <= {"atmelavr", "atmelsam", "raspberrypi", "ststm32",
                                          "nordicnrf52"}  # fmt: skip


def test_the_library_brings_its_messages_as_a_dbc(packed: Path) -> None:
    assert (packed / "skiplatch/extras/injection.dbc").is_file()


def test_both_manifests_state_the_version(packed: Path) -> None:
    version = re.search(r'SKIPLATCH_VERSION "(.*)"', Path("firmware/skiplatch.h").read_text())
    properties = dict(
        line.split("=", 1)
        for line in (packed / "skiplatch/library.properties").read_text().splitlines()
    )

    assert version is not None
    assert properties["version"] == version[1]
    assert json.loads((packed / "skiplatch/library.json").read_text())["version"] == version[1]
