"""Name the quick test files: ``quick_tests.py JUNIT SECONDS FOLDER…``, in the project's folder.

Those that took less than SECONDS in the run that wrote JUNIT, or are not in it. Without that run:
all.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree as ET


def seconds_of(junit: Path) -> defaultdict[str, float]:
    """Give the time of each test file, by its path with points, as JUnit has it."""
    seconds: defaultdict[str, float] = defaultdict(float)
    if junit.exists():
        for case in ET.parse(junit).getroot().iter("testcase"):  # noqa: S314 - our own
            seconds[case.get("classname", "")] += float(case.get("time", 0.0))
    return seconds


def main() -> int:
    """Print the files, one a line."""
    junit, limit_s, *folders = sys.argv[1:]
    seconds = seconds_of(Path(junit))
    files = sorted(path for folder in folders for path in Path(folder).glob("test_*.py"))
    named = {path: ".".join(path.with_suffix("").parts) for path in files}
    print(*(path for path, name in named.items() if seconds[name] < float(limit_s)), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
