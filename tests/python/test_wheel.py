"""The wheel: it works in an environment that has neither the checkout nor a compiler."""

import re
import subprocess
import sysconfig
import tomllib
import venv
import zipfile
from email import message_from_bytes
from email.policy import default
from pathlib import Path

import pytest

import pack_python
import skiplatch
from packages_rig import run

WHEELS = Path("build/wheel")
BARE = {"PATH": "/nowhere", "LANG": "C.UTF-8", "MPLCONFIGDIR": "matplotlib"}
# Not the surrounding make's, which would have its own ideas of what to build.
MAKE = ("env", "-u", "MAKEFLAGS", "-u", "MAKELEVEL", "-u", "INNER", "-u", "RESULTS", "make")


def test_the_version_is_that_of_the_firmware() -> None:
    stated = re.search(r'SKIPLATCH_VERSION "(.*)"', Path("firmware/skiplatch.h").read_text())

    assert stated is not None
    assert skiplatch.__version__ == stated[1]


def test_what_is_packed_states_the_licence_of_all_that_is_compiled_in() -> None:
    """Where Random123 is used is known without building: who adds another finds this test."""
    project = tomllib.loads(pack_python.project_table())["project"]
    foreign = {
        name
        for path in (*Path("host_sim").rglob("*.[ch]"), *Path("firmware").rglob("*.[ch]"))
        for name in re.findall(r"#include <(\w+)/", path.read_text())
    }

    assert project["license"] == "Apache-2.0 AND BSD-3-Clause"
    assert project["license-files"] == ["LICENSE", pack_python.RANDOM_NOTICE]
    assert project["readme"] == "README.md"
    assert foreign - {"sys", "zephyr"} == {"Random123"}


def installed(wheel: Path, folder: Path) -> Path:
    """Make an environment with the wheel; this one lends what that depends on, no checkout."""
    venv.create(folder, with_pip=False)
    program = folder / "bin" / "python"
    site = run(program, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip()
    (Path(site) / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n")
    run(program, "-m", "pip", "install", "--quiet", "--no-index", "--ignore-installed", "--no-deps",
        wheel.resolve())  # fmt: skip
    return program


def assert_metadata(wheel: zipfile.ZipFile) -> None:
    """Its licences are those of all that is compiled in, and their texts are inside."""
    (place,) = [name for name in wheel.namelist() if name.endswith(".dist-info/METADATA")]
    stated = message_from_bytes(wheel.read(place), policy=default)
    notices = place.replace("METADATA", "licenses")

    assert stated["License-Expression"] == "Apache-2.0 AND BSD-3-Clause"
    assert stated.get_all("License-File") == ["LICENSE", "LICENSE.Random123"]
    assert b"Apache License" in wheel.read(f"{notices}/LICENSE")
    random = wheel.read(f"{notices}/LICENSE.Random123").decode()
    assert "D. E. Shaw Research" in random
    assert "Redistributions in binary form must reproduce" in random
    assert "Latch touch-probe triggers" in stated.get_content()
    assert stated["Author"] == "skiplatch maintainers"
    assert "Typing :: Typed" in stated.get_all("Classifier", [])


def assert_complete(wheel: Path, sdist: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    sources = run("tar", "--list", "--file", sdist)

    assert re.search(r"-py3-none-manylinux_2_\d+_\w+\.whl$", wheel.name)
    assert "skiplatch/tree/build/host/libskiplatch_sim.so" in names
    assert "skiplatch/tree/docs/injection.dbc" in names
    assert not [name for name in names if name.endswith((".c", ".pyc")) or "Random123/" in name]
    assert_metadata(zipfile.ZipFile(wheel))
    for needed in ("philox.h", "copyright"):
        assert f"skiplatch/tree/Random123/{needed}" in sources


@pytest.mark.long
def test_it_diagnoses_a_sample_without_checkout_and_compiler(tmp_path: Path) -> None:
    """All in one test, as two processes may not build it side by side."""
    run(*MAKE, "wheel")
    (wheel,), (sdist,) = WHEELS.glob("*.whl"), WHEELS.glob("*.tar.gz")
    python = installed(wheel, tmp_path / "environment")
    where = "from skiplatch.places import ROOT; print(ROOT)"
    root = Path(run(python, "-I", "-c", where).strip())
    sample = str(root / "scripts" / "samples" / "bench_isr_latency")

    said = subprocess.run(
        [python, "-m", "skiplatch", "diagnose", sample, "--seed", "1", "--html", "page.html"],
        cwd=tmp_path, env=BARE, capture_output=True, text=True, check=False,
    )  # fmt: skip

    assert_complete(wheel, sdist)
    assert python.parents[1] in root.parents
    assert skiplatch.__version__ in run(python, "-I", "-m", "skiplatch", "--version")
    assert said.returncode == 0, said.stderr
    assert "isr_latency (latch stage, skip)" in said.stdout
    assert "</html>" in (tmp_path / "page.html").read_text()
