"""The library in PlatformIO itself, which finds it by its library.json and builds sketches with it.

PlatformIO's compilers come from a registry of its own. In their place stands a platform of the same
name, `tests/packages/platformio`, with Debian's compiler and Arduino core.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from packages_rig import CORES, packed_into, stamps_of, tool, uno_run

PIO = Path("build/platformio/venv/bin/pio")
PLATFORM = Path("tests/packages/platformio").resolve()
SCONS_VERSION = "4.41101.0"  # of SCons 4.11.1, as PlatformIO counts
TOUCHES_US = (100_000, 150_300)
LATE_US = {"SkipInput": 0, "PlcTask": 1000}  # of the examples
PROGRAM = Path(".pio/build/uno/program.elf")


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Give PlatformIO a home of its own, with SCons of the same environment in its place there."""
    tool("avr-gcc", "cross")
    if not PIO.exists() or not CORES.exists():
        pytest.skip("no PlatformIO or Arduino core here: make setup-test")
    home = tmp_path_factory.mktemp("home")
    scons = home / "packages/tool-scons"
    scons.mkdir(parents=True)
    (scons / "scons.py").write_text("import SCons.Script\nSCons.Script.main()\n")
    (scons / "SCons").symlink_to(next(PIO.parents[1].resolve().glob("lib/python*/*/SCons")))
    manifest = {"name": scons.name, "version": SCONS_VERSION}
    parts = ("owner", "id", "name", "requirements", "uri")
    asked_for = dict.fromkeys(parts) | {"owner": "platformio", "name": scons.name}
    (scons / "package.json").write_text(json.dumps(manifest | {"description": "SCons"}))
    (scons / ".piopm").write_text(json.dumps(manifest | {"type": "tool", "spec": asked_for}))
    return {"PLATFORMIO_CORE_DIR": str(home), "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no"}


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return packed_into(tmp_path_factory.mktemp("packed"))


@pytest.fixture(scope="module")
def uno(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return uno_run(tmp_path_factory.mktemp("uno"))


def built(
    library: Path, example: str, project: Path, settings: dict[str, str]
) -> subprocess.CompletedProcess[str]:
    """Build an example as a project that depends on the library, and on what it says it runs on."""
    (project / "src").mkdir(parents=True)
    sketch = library / f"examples/{example}/{example}.ino"
    (project / "src" / sketch.name).write_text(sketch.read_text())
    (project / "platformio.ini").write_text(
        f"[env:uno]\nplatform = symlink://{PLATFORM}\nboard = uno\nframework = arduino\n"
        f"lib_compat_mode = strict\nlib_deps = symlink://{library}\n"
    )
    return subprocess.run(
        (PIO, "run", "--project-dir", project),
        env=os.environ | settings,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.long
@pytest.mark.parametrize("example", LATE_US)
def test_platformio_builds_the_example_and_it_runs_on_an_uno(
    packed: Path, uno: Path, settings: dict[str, str], example: str, tmp_path: Path
) -> None:
    """A touch is latched at once, or at the next scan; micros() begins some 100 µs late."""
    done = built(packed / "skiplatch", example, tmp_path, settings)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "skiplatch @ " in done.stdout

    stamps = stamps_of(uno, tmp_path / PROGRAM)
    assert len(stamps) == len(TOUCHES_US)
    for stamp, touch_us in zip(stamps, TOUCHES_US, strict=True):
        assert touch_us - 200 <= stamp <= touch_us + LATE_US[example]
    apart_us = stamps[1] - stamps[0]
    if example == "PlcTask":
        assert abs(apart_us - round(apart_us, -3)) <= 40  # scans, 1000 µs apart
    else:
        assert abs(apart_us - (TOUCHES_US[1] - TOUCHES_US[0])) <= 8


def test_platformio_takes_no_library_for_other_platforms(
    packed: Path, settings: dict[str, str], tmp_path: Path
) -> None:
    """So that the test above says something of library.json."""
    library = tmp_path / "skiplatch"
    shutil.copytree(packed / "skiplatch", library)
    manifest = json.loads((library / "library.json").read_text())
    (library / "library.json").write_text(json.dumps(manifest | {"platforms": ["ststm32"]}))
    done = built(library, "SkipInput", tmp_path / "project", settings)

    assert done.returncode != 0
    assert "skiplatch_arduino.hpp: No such file" in done.stderr
