"""Pack the Python package: ``pack_python.py FOLDER --flags … --sources … --shown … --includes …``.

Started in the project's folder. Lays the source tree of an sdist out in FOLDER/tree: the package,
in it as ``skiplatch/tree`` what it reads of the project, and how CMake compiles the library.
Builds FOLDER/skiplatch-….tar.gz of it and, out of that alone, FOLDER/skiplatch-….whl.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

PACKAGE = Path("scripts/skiplatch")
WHEEL = Path("scripts/wheel")
READ = ("docs/injection.dbc", "scripts/samples")
"""What the package reads besides sources and headers, by its place in the project."""
HEADERS = (
    "firmware/*.h",
    "firmware/*/*.h",
    "hal/include/*.h",
    "host_sim/*.h",
    "host_sim/*/*.h",
    "scripts/skiplatch/*/*/*.h",
)
RUNS_LEAVE = ("__pycache__", "TCHPRAUTO*", "kinematics.bin")
LEFT_BY_RUNS = shutil.ignore_patterns(*RUNS_LEAVE)
C_OF_PACKAGE = shutil.ignore_patterns(*RUNS_LEAVE, "*.[ch]")
"""C of the package goes with all other C, at its place in the project."""
RANDOM = Path("/usr/include/Random123")
RANDOM_LICENCE = Path("/usr/share/doc/librandom123-dev/copyright")
RANDOM_NOTICE = "LICENSE.Random123"
OWN_LICENCE = 'license = "Apache-2.0"'
PACKED = f"""\
license = "Apache-2.0 AND BSD-3-Clause"
license-files = ["LICENSE", "{RANDOM_NOTICE}"]
readme = "README.md"\
"""
BACKEND = "import scikit_build_core.build as b, sys; b.build_sdist(sys.argv[1])"


def project_table() -> str:
    """Give [project] and its tables as scripts/pyproject.toml has them, and what is packed with it.

    The library that is compiled for the wheel has Random123 in it.
    """
    text = Path("scripts/pyproject.toml").read_text(encoding="utf-8")
    table = text[text.index("[project]") : text.index("[tool.")]
    before, own, after = table.partition(OWN_LICENCE)
    if not own:
        raise ValueError(f"scripts/pyproject.toml: expected {OWN_LICENCE}")
    return before + PACKED + after


def _copy(path: Path, tree: Path) -> None:
    target = tree / path
    target.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        shutil.copytree(path, target, ignore=LEFT_BY_RUNS)
    else:
        shutil.copy(path, target)


def lay_out(tree: Path, options: argparse.Namespace) -> None:
    """Write the source tree of the sdist."""
    shutil.rmtree(tree, ignore_errors=True)
    shutil.copytree(PACKAGE, tree / "skiplatch", ignore=C_OF_PACKAGE)
    inside = tree / "skiplatch" / "tree"
    headers = [path for pattern in HEADERS for path in Path().glob(pattern)]
    for path in (*map(Path, (*READ, *options.sources)), *headers):
        _copy(path, inside)
    shutil.copytree(RANDOM, inside / "Random123")
    shutil.copy(RANDOM_LICENCE, inside / "Random123" / "copyright")
    shutil.copy(RANDOM_LICENCE, tree / RANDOM_NOTICE)
    for path in (Path("LICENSE"), Path("README.md"), WHEEL / "CMakeLists.txt"):
        shutil.copy(path, tree)
    how = (WHEEL / "pyproject.toml").read_text(encoding="utf-8")
    (tree / "pyproject.toml").write_text(project_table() + how, encoding="utf-8")
    lists = {
        "FLAGS": options.flags.split(),
        "INCLUDES": [".", *options.includes],
        "SOURCES": options.sources,
        "SHOWN": options.shown,
    }
    lines = [f"set({name} {' '.join(values)})\n" for name, values in lists.items()]
    (tree / "packed.cmake").write_text("".join(lines), encoding="utf-8")


def _run(*words: str | Path, cwd: Path | None = None) -> None:
    """Run a program of this Python's environment, whose others it finds as well."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    command = [sys.executable, *map(str, words)]
    subprocess.run(command, cwd=cwd, env={**os.environ, "PATH": path}, check=True)  # noqa: S603


def build(folder: Path) -> None:
    """Build the sdist of the tree, and the wheel of the sdist."""
    for old in (*folder.glob("*.tar.gz"), *folder.glob("*.whl")):
        old.unlink()
    _run("-c", BACKEND, folder.resolve(), cwd=folder / "tree")
    (sdist,) = folder.glob("*.tar.gz")
    plain = folder / "plain"
    shutil.rmtree(plain, ignore_errors=True)
    pip = ("-m", "pip", "--disable-pip-version-check", "wheel", "--quiet")
    _run(*pip, "--no-deps", "--no-build-isolation", "--wheel-dir", plain, sdist)
    (wheel,) = plain.glob("*.whl")
    # Names the wheel after the oldest C library that it runs with.
    _run("-m", "auditwheel", "repair", "--wheel-dir", folder, wheel)


def main() -> int:
    """Lay out, build, and print what was built."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--flags", default="")
    for name in ("sources", "shown", "includes"):
        parser.add_argument(f"--{name}", nargs="+", default=[])
    options = parser.parse_args()
    lay_out(options.folder / "tree", options)
    build(options.folder)
    print(*sorted(map(str, options.folder.glob("skiplatch-*"))), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
