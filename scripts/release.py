"""Check what a release needs: ``release.py [--built FOLDER] [--tag]``, in the project's folder.

The version stands in firmware/skiplatch.h; everything else has to state the same. With --built the
packages in FOLDER have to be of that version. With --tag an annotated tag is made, unless a check
fails. Prints a line a fault, and ends with 1 if there is one.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

STATED = {
    "firmware/skiplatch.h": r'^#define SKIPLATCH_VERSION "(.*)"$',
    "scripts/pyproject.toml": r'^version = "(.*)"$',
    "CITATION.cff": r"^version: (.*)$",
}
HOME = "firmware/skiplatch.h"
"""Where the version is at home."""
EXAMPLES = (
    "Containerfile",
    "docs/FLEET.md",
    "docs/PACKAGES.md",
    "firmware/examples/desk/CMakeLists.txt",
)
"""Files whose examples name the version, whole or without its last step."""
NAMED = re.compile(r"skiplatch[-: ](\d+\.\d+(?:\.\d+)?)\b")
SEMANTIC = re.compile(r"(\d+)\.(\d+)\.(\d+)")
UNRELEASED = re.compile(r"^## Unreleased\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)


def git(root: Path, *words: str) -> str:
    """Give what git prints."""
    command = ("git", "-C", str(root), *words)
    done = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603
    return done.stdout.strip()


def stated(root: Path, name: str) -> str:
    """Give the version that a file states, or nothing."""
    found = re.search(STATED[name], (root / name).read_text(encoding="utf-8"), re.MULTILINE)
    return found[1] if found else ""


def version_faults(root: Path, version: str) -> Iterator[str]:
    """Give what is wrong with the version itself, and where it is stated otherwise."""
    if not SEMANTIC.fullmatch(version):
        yield f"{HOME}: expected a version such as 1.2.3, got '{version}'"
    for name in STATED:
        if stated(root, name) != version:
            yield f"{name}: states {stated(root, name) or 'no version'}, {HOME} {version}"
    for name in EXAMPLES:
        named = set(NAMED.findall((root / name).read_text(encoding="utf-8")))
        for other in sorted(named - {version, version.rpartition(".")[0]}):
            yield f"{name}: an example names {other}, {HOME} states {version}"


def changelog_faults(root: Path, version: str) -> Iterator[str]:
    """Give what the change log lacks."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    heading = rf"^## {re.escape(version)} - \d{{4}}-\d\d-\d\d\n+(?!## |\Z)\S"
    if not re.search(heading, text, re.MULTILINE):
        yield f"CHANGELOG.md: expected a section '## {version} - YYYY-MM-DD' with what changed"
    waiting = UNRELEASED.search(text)
    if waiting and waiting[1].strip():
        yield "CHANGELOG.md: lines under Unreleased, which belong to the release"


def tree_faults(root: Path, version: str) -> Iterator[str]:
    """Give what is wrong with the state of the repository."""
    if changed := git(root, "status", "--porcelain"):
        yield f"{len(changed.splitlines())} files are changed and not committed"
    tags = git(root, "tag", "--list", "v*").split()
    if f"v{version}" in tags:
        yield f"v{version} is there already: raise the version in {HOME}"
    later = [tag for tag in tags if _parts(tag) > _parts(version)]
    if later:
        yield f"{max(later, key=_parts)} is there already, which is later than {version}"


def built_faults(folder: Path, version: str) -> Iterator[str]:
    """Give which packages are not built."""
    for pattern in (f"skiplatch-{version}-*.whl", f"skiplatch-{version}.tar.gz"):
        if not list(folder.glob(pattern)):
            yield f"{folder}: no {pattern}"


def _parts(version: str) -> tuple[int, ...]:
    found = SEMANTIC.search(version)
    return tuple(map(int, found.groups())) if found else ()


def faults(root: Path, built: Path | None) -> list[str]:
    """Give all that stands in the way of a release."""
    version = stated(root, HOME)
    found = [
        *version_faults(root, version),
        *changelog_faults(root, version),
        *tree_faults(root, version),
    ]
    return found if built is None else [*found, *built_faults(built, version)]


def main(root: Path) -> int:
    """Check, and tag when asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--built", type=Path)
    parser.add_argument("--tag", action="store_true")
    options = parser.parse_args()
    version = stated(root, HOME)
    if found := faults(root, options.built):
        print(f"release {version}: not ready", *found, sep="\n  ")
        return 1
    if options.tag:
        git(root, "tag", "--annotate", f"v{version}", "--message", f"skiplatch {version}")
    print(f"release {version}: {'tagged' if options.tag else 'ready'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path()))
