"""Run cppcheck and a few rules of MISRA C, from the project's folder.

    lint_cppcheck.py CACHE --portable PORT... --hosted PORT...

The ports are folders; of the hosted ones, as of HOSTED, MISRA is not asked.

The rules are named by their numbers with reasons of our own; the text of the standard is not ours
to give away. Most others are either covered by the compilers' warnings or cost more than they give.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

PORTABLE = ("firmware", "hal/include")
HOSTED = (
    "host_sim",
    "scripts/skiplatch/diagnosis/density",
    "scripts/skiplatch/diagnosis/likelihood",
)
EXAMPLES = "firmware/examples"  # they print, and leave errors to the reader

MISRA = {
    "12.2": "a shift as wide as its operand has no defined outcome",
    "13.5": "an effect on the right of && or || happens only sometimes",
    "15.1": "no goto: the reader would have to search for the label",
    "16.3": "falling through a case is hardly ever meant",
    "17.7": "an error code must not get lost; cast to void what is not needed",
    "18.8": "no array of variable length: the stack has to be bounded",
    "21.3": "no heap",
    "21.4": "no longjmp: it skips the release of locks",
    "21.5": "no signals: they exist on hosts only",
    "21.6": "no stdio: it needs a heap and an operating system",
    "21.8": "no exit or abort: there is nowhere to go",
    "21.10": "no wall clock: time is passed in",
}
# Not faults: fields that other files use, a local name that a function has as well, a parameter
# that is an array of arrays (C99 takes no plain one for a const one), and remarks of newer versions
# on how far they looked.
UNWANTED = (
    "checkersReport",
    "constParameter",
    "missingIncludeSystem",
    "normalCheckLevelMaxBranches",
    "shadowFunction",
    "unusedStructMember",
)
# What these return is their first argument again.
RETURN_NOTHING_NEW = re.compile(r"\b(?:memcpy|memmove|memset)\(")
FINDING = re.compile(r"^(?P<file>[^:]+):(?P<line>\d+): (?P<id>[\w.-]+): (?P<message>.*)$")


def run(folders: tuple[str, ...], cache: Path, *extra: str) -> list[re.Match[str]]:
    """Run cppcheck on the folders and return its findings."""
    present = [folder for folder in folders if any(Path(folder).rglob("*.[ch]"))]
    if not present:
        return []
    cache.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(
        [
            "cppcheck",
            "--quiet",
            "--std=c99",
            "--inline-suppr",
            "--platform=native",
            f"--cppcheck-build-dir={cache}",
            "--template={file}:{line}: {id}: {message}",
            "-Ifirmware",
            "-Ihal/include",
            "-Ihost_sim",
            "-Iscripts/skiplatch",
            f"-i{EXAMPLES}",
            *(f"-i{folder}/tests" for folder in present),
            *extra,
            *present,
        ],
        check=True,
        capture_output=True,
        text=True,
    )
    return [match for line in done.stderr.splitlines() if (match := FINDING.match(line))]


def is_meant(match: re.Match[str]) -> bool:
    """Tell whether a finding is one the project cares for."""
    rule = match["id"].removeprefix("misra-c2012-")
    if rule == "17.7":
        lines = Path(match["file"]).read_text(encoding="utf-8").splitlines()
        return not RETURN_NOTHING_NEW.search(lines[int(match["line"]) - 1])
    return rule in MISRA


def main(arguments: list[str]) -> int:
    """Print the findings; 1 if there are any."""
    parser = argparse.ArgumentParser()
    parser.add_argument("cache", type=Path)
    parser.add_argument("--portable", nargs="*", default=[])
    parser.add_argument("--hosted", nargs="*", default=[])
    given = parser.parse_args(arguments)
    cache: Path = given.cache
    portable = (*PORTABLE, *given.portable)
    hosted = (*HOSTED, *given.hosted)
    faults = [
        match[0]
        for match in run(
            (*portable, *hosted),
            cache / "plain",
            "--enable=warning,style,performance,portability",
            *(f"--suppress={name}" for name in UNWANTED),
        )
    ]
    faults += [
        f"{match['file']}:{match['line']}: {match['id']}: "
        f"{MISRA[match['id'].removeprefix('misra-c2012-')]}"
        for match in run(portable, cache / "misra", "--addon=misra")
        if is_meant(match)
    ]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
