"""Refuse in portable C what would tie it to one chip or to a heap; started in the project's folder.

In firmware/ and hal/include/: no memory allocation, no preprocessor condition on a processor, a
compiler or an operating system.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

FOLDERS = ("firmware", "hal/include")
REFUSED = {
    "allocates memory": re.compile(r"\b(?:malloc|calloc|realloc|free|alloca|strdup)\s*\("),
    "depends on the target": re.compile(
        r"^[ \t]*#[ \t]*(?:if|ifdef|ifndef|elif)\b.*"
        r"(?:avr|arm|cortex|stm32|atmega|__gnuc__|__clang__|_msc_ver|linux|unix|win32|freertos"
        r"|\bpico|esp32|riscv|x86)",
        re.IGNORECASE | re.MULTILINE,
    ),
}
COMMENT_OR_TEXT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.DOTALL)


def blank_comments(text: str) -> str:
    """Return the text with comments and strings blanked, every line where it was."""
    return COMMENT_OR_TEXT.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def main() -> int:
    """Print the faults; 1 if there are any."""
    faults = []
    for folder in FOLDERS:
        for path in sorted(Path(folder).rglob("*.[ch]")):
            text = blank_comments(path.read_text(encoding="utf-8"))
            for reason, pattern in REFUSED.items():
                for match in pattern.finditer(text):
                    line = text.count("\n", 0, match.start()) + 1
                    faults.append(f"{path}:{line}: {reason}: {match[0].strip()}")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
