"""Count the outcomes of suites: `count_tests.py RESULTS_FOLDER SUITE...`.

A suite is a folder of outcomes: what a Unity program printed (`.log`), pytest's report in JUnit's
format (`.xml`), or one line `PASS: …`, `FAIL: …` or `SKIPPED: …` (`.check`). An outcome that is
missing, empty or cut short counts as one failure. The outcome of each suite is also written to
`RESULTS_FOLDER/SUITE.txt`; the last line printed is the sum.
"""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path

UNITY_TOTAL = re.compile(r"^(\d+) Tests (\d+) Failures (\d+) Ignored", re.MULTILINE)
UNITY_NOTABLE = re.compile(r"^\S+:\d+:\w+:(?:FAIL|IGNORE)\b.*$", re.MULTILINE)
EXIT_STATUS = re.compile(r"^exit status (\d+)$", re.MULTILINE)
LINES_SHOWN_OF_A_CRASH = 40


@dataclass
class Tally:
    """How many passed, failed and were skipped, and what there is to say about the latter two."""

    passed: int = 0
    failed: int = 0
    skipped: int = 0
    notes: list[str] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        """Add the numbers and notes of `other`."""
        self.passed += other.passed
        self.failed += other.failed
        self.skipped += other.skipped
        self.notes += other.notes

    def __str__(self) -> str:
        return f"{self.passed} passed, {self.failed} failed, {self.skipped} skipped"


def count_unity(path: Path) -> Tally:
    """Count what a Unity program printed; one that ended badly has one failure more."""
    text = path.read_text(encoding="utf-8", errors="replace")
    total = UNITY_TOTAL.search(text)
    status = EXIT_STATUS.search(text)
    if total is None or status is None:
        end = f"exit status {status[1]}" if status else "not built or not run"
        last = text.splitlines()[-LINES_SHOWN_OF_A_CRASH:]
        return Tally(failed=1, notes=[f"{path}: no result, {end}", *last])
    tests, failed, ignored = (int(number) for number in total.groups())
    tally = Tally(tests - failed - ignored, failed, ignored, UNITY_NOTABLE.findall(text))
    if failed == 0 and int(status[1]) != 0:
        last = text.splitlines()[-LINES_SHOWN_OF_A_CRASH:]
        tally.add(Tally(failed=1, notes=[f"{path}: exit status {status[1]}", *last]))
    return tally


def count_junit(path: Path) -> Tally:
    """Count the cases of a JUnit report."""
    try:
        root = ET.parse(path).getroot()  # noqa: S314 -- reads what our own pytest wrote
    except ET.ParseError:
        return Tally(failed=1, notes=[f"{path}: no result, not run or cut short"])
    tally = Tally()
    for case in root.iter("testcase"):
        name = f"{case.get('classname')}.{case.get('name')}"
        if case.find("failure") is not None or case.find("error") is not None:
            tally.add(Tally(failed=1, notes=[f"FAIL: {name}"]))
        elif (skip := case.find("skipped")) is not None:
            tally.add(Tally(skipped=1, notes=[f"SKIPPED: {name}: {skip.get('message')}"]))
        else:
            tally.passed += 1
    if not any(True for _ in root.iter("testcase")):
        tally.add(Tally(failed=1, notes=[f"{path}: no tests were collected"]))
    return tally


def count_check(path: Path) -> Tally:
    """Count one check."""
    line = path.read_text(encoding="utf-8").strip()
    if line.startswith("PASS:"):
        return Tally(passed=1)
    if line.startswith("SKIPPED:"):
        return Tally(skipped=1, notes=[line])
    return Tally(failed=1, notes=[line or f"FAIL: {path.stem}: not built or not run"])


COUNT = {".log": count_unity, ".xml": count_junit, ".check": count_check}


def count_suite(folder: Path) -> Tally:
    """Count all outcomes of one suite."""
    tally = Tally()
    if not folder.is_dir():
        return Tally(failed=1, notes=[f"FAIL: {folder.name}: the suite did not run"])
    for path in sorted(folder.iterdir()):
        if path.suffix in COUNT:
            tally.add(COUNT[path.suffix](path))
    return tally


def main(arguments: list[str]) -> int:
    """Print what failed and was skipped, a line for each suite and the sum; 1 if any failed."""
    results, *suites = arguments
    total = Tally()
    lines = []
    for suite in suites:
        tally = count_suite(Path(results, suite))
        total.add(tally)
        lines.append(f"{suite}: {tally}")
        if Path(results).is_dir():
            summary = "\n".join([*tally.notes, str(tally)])
            Path(results, f"{suite}.txt").write_text(summary + "\n", encoding="utf-8")
    print("\n".join([*total.notes, *lines, str(total)]))
    return 1 if total.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
