"""Name the quick test files: ``quick_tests.py JUNIT SECONDS FOLDER…``, in the project's folder.

Those that took less than SECONDS in the run that wrote JUNIT, are not in it, or were changed since
the last commit. Without that run, which is said: the changed ones alone.
"""

from __future__ import annotations

import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree as ET


def seconds_of(junit: Path) -> defaultdict[str, float]:
    """Give the time of each test file, by its path with points, as JUnit has it."""
    seconds: defaultdict[str, float] = defaultdict(float)
    for case in ET.parse(junit).getroot().iter("testcase"):  # noqa: S314 - our own
        seconds[case.get("classname", "")] += float(case.get("time", 0.0))
    return seconds


def changed() -> set[Path]:
    """Give the files that differ from the last commit, new ones included."""
    words = ("git", "status", "--porcelain", "--untracked-files=all", "--no-renames")
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout  # noqa: S603
    return {Path(line[3:]) for line in lines.splitlines()}


def quick(files: list[Path], junit: Path, limit_s: float) -> list[Path]:
    """Give the quick ones of the files."""
    touched = changed()
    if not junit.exists():
        print("make test has not run here: of Python only the changed test files", file=sys.stderr)
        return [path for path in files if path in touched]
    seconds = seconds_of(junit)
    named = {path: ".".join(path.with_suffix("").parts) for path in files}
    return [path for path in files if path in touched or seconds[named[path]] < limit_s]


def main() -> int:
    """Print the files, one a line."""
    junit, limit_s, *folders = sys.argv[1:]
    files = sorted(path for folder in folders for path in Path(folder).glob("test_*.py"))
    print(*quick(files, Path(junit), float(limit_s)), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
