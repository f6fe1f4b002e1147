"""Pack the core of the firmware: ``pack_firmware.py FOLDER``.

Writes a library for Arduino and PlatformIO into FOLDER/skiplatch, the core as a single header into
FOLDER/skiplatch.h, and what halcompile builds for LinuxCNC into FOLDER/linuxcnc. Prints the names
of these three.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FIRMWARE = ROOT / "firmware"
HAL = ROOT / "hal/include"
PATTERNS = re.compile(r"set\(SKIPLATCH_core ([^)]+)\)")
VERSION = re.compile(r'SKIPLATCH_VERSION "([0-9.]+)"')
INCLUDE = re.compile(r'^#include "([^"]+)"\n', re.MULTILINE)
OWN_NAME = re.compile(
    r"^#define (\w+)|^static [\w ]+?[ *](\w+)(?=[(\[ ;=])|^(?:typedef .*?|\} )(\w+);$", re.MULTILINE
)
"""What a C file of the firmware defines for itself: macros, static functions and data, types."""
WORD = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|(?:\.|->)?\b[A-Za-z_]\w*', re.DOTALL)
"""A comment, a text, a member behind its dot or arrow, or any other name."""
GUARD = re.compile(r"^#ifndef (\w+)\n#define \1\n(.*)^#endif\n\Z", re.MULTILINE | re.DOTALL)

HEAD = """\
/*
 * skiplatch {version}: the core in one header. Define SKIPLATCH_IMPLEMENTATION in one C file that
 * includes nothing else of yours before it. Licence: Apache-2.0.
 */
"""


def core_sources() -> list[Path]:
    """List the C files of the core, as parts.cmake has them."""
    found = PATTERNS.search((FIRMWARE / "parts.cmake").read_text(encoding="utf-8"))
    if found is None:
        message = "firmware/parts.cmake: no SKIPLATCH_core"
        raise ValueError(message)
    return sorted(path for pattern in found[1].split() for path in FIRMWARE.glob(pattern))


def core_headers() -> dict[str, Path]:
    """Give the headers of the core by the name they are included by, what is needed first."""
    headers: dict[str, Path] = {}

    def add(name: str) -> None:
        path = next(folder / name for folder in (FIRMWARE, HAL) if (folder / name).is_file())
        for needed in INCLUDE.findall(path.read_text(encoding="utf-8")):
            if needed not in headers:
                add(needed)
        headers[name] = path

    add("skiplatch.h")
    return headers


def version() -> str:
    """Give the version that skiplatch.h states."""
    found = VERSION.search((FIRMWARE / "skiplatch.h").read_text(encoding="utf-8"))
    if found is None:
        message = "firmware/skiplatch.h: no SKIPLATCH_VERSION"
        raise ValueError(message)
    return found[1]


def pack_library(folder: Path) -> None:
    """Lay the core out as Arduino and PlatformIO want it: everything under src."""
    shutil.rmtree(folder, ignore_errors=True)
    copies = {path: str(path.relative_to(FIRMWARE)) for path in core_sources()}
    copies |= {path: name for name, path in core_headers().items()}
    for path, name in copies.items():
        target = folder / "src" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, target)
    shutil.copy(FIRMWARE / "arduino/skiplatch_arduino.hpp", folder / "src")
    for manifest in ("library.properties", "library.json"):
        text = (FIRMWARE / manifest).read_text(encoding="utf-8")
        (folder / manifest).write_text(text.replace("@VERSION@", version()))
    for example in sorted((FIRMWARE / "examples").glob("*/*.ino")):
        shutil.copytree(example.parent, folder / "examples" / example.parent.name)
    shutil.copy(ROOT / "LICENSE", folder)
    (folder / "extras").mkdir()
    shutil.copy(ROOT / "docs/injection.dbc", folder / "extras")


def _inline(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    guarded = GUARD.search(text)
    body = text[: guarded.start()] + guarded[2] if guarded else text
    return INCLUDE.sub("", body)


def with_long_names(text: str, stem: str) -> str:
    """Put the file's name before what a C file defines for itself.

    In the single header such names stand in the user's own file, where `arm` is likely to be taken.
    """
    longer = {}
    for match in OWN_NAME.finditer(text):
        name = str(match[match.lastindex or 0])
        before = f"skiplatch_{stem}_"
        longer[name] = f"{before.upper() if name.isupper() else before}{name}"
    return WORD.sub(lambda match: longer.get(match[0], match[0]), text)


def single_header(sources: list[Path]) -> str:
    """Join the headers of the core, and these sources with long names."""
    parts = [HEAD.format(version=version()), "#ifndef SKIPLATCH_H\n#define SKIPLATCH_H\n\n"]
    parts += [_inline(path) + "\n" for path in core_headers().values()]
    parts.append("#ifdef SKIPLATCH_IMPLEMENTATION\n\n")
    parts += [with_long_names(_inline(path), path.stem) + "\n" for path in sources]
    parts.append("#endif\n\n#endif\n")
    return "".join(parts)


def pack_linuxcnc(folder: Path) -> None:
    """Put the component beside the one module it needs, which halcompile includes from there."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(FIRMWARE / "linuxcnc/skiplatch.comp", folder)
    latch = single_header([FIRMWARE / "input/latch.c"])
    (folder / "skiplatch.h").write_text(
        f"#define SKIPLATCH_IMPLEMENTATION\n{latch}", encoding="utf-8"
    )


def main() -> int:
    """Pack both."""
    folder = Path(sys.argv[1])
    pack_library(folder / "skiplatch")
    (folder / "skiplatch.h").write_text(single_header(core_sources()), encoding="utf-8")
    pack_linuxcnc(folder / "linuxcnc")
    print(f"{folder}/skiplatch\n{folder}/skiplatch.h\n{folder}/linuxcnc")
    return 0


if __name__ == "__main__":
    sys.exit(main())
