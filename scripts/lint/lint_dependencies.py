"""Check that dependencies point one way; started in the project's folder.

Every C file stands in a room, and each room may include only from certain others. No two modules
include one another, directly or by way of others. Python reaches C through one module alone.
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

PYTHON_PACKAGE = Path("scripts/skiplatch")
# What the boards of a family share stands in a folder of hal/ports that is no board itself.
FAMILIES = tuple(
    f"{folder.as_posix()}/"
    for folder in Path("hal/ports").glob("*")
    if folder.is_dir() and not (folder / "board.mk").exists()
)

# Which rooms the files of a room may include from; a file's room is the first pattern it matches.
# "own" is the file's own folder, "above" the one that this is in. What is found in no room is a
# header of the system.
ROOMS: dict[str, set[str]] = {
    r"firmware/comp/": {"own"},
    r"firmware/inject/": {"own"},
    r"firmware/report/": {"own", "firmware/input/", "hal/include/"},
    r"firmware/transmission/": {"own", "firmware/comp/", "hal/include/"},
    r"firmware/input/": {"own", "hal/include/"},
    r"firmware/cycle/": {
        "own",
        "firmware/comp/",
        "firmware/input/",
        "firmware/report/",
        "hal/include/",
    },
    r"hal/include/": {"own"},
    r"hal/ports/\w+/(?:main\w*|wiring\w*)\.c": {"own", "firmware/", "hal/include/", *FAMILIES},
    # An injector is a program beside the port: it drives the line that the port watches.
    r"hal/ports/\w+/injector\w*\.[ch]": {"own", "firmware/inject/"},
    # A port's tests stand in its folder and may see all of it.
    r"hal/ports/\w+/tests/": {"own", "above", "hal/include/", "firmware/", *FAMILIES},
    r"hal/ports/": {"own", "hal/include/", *FAMILIES},
    r"host_sim/api/": {"own", "host_sim/", "firmware/", "hal/include/"},
    r"host_sim/main\.c": {"host_sim/"},
    r"host_sim/": {"host_sim/", "hal/include/"},
    r"scripts/skiplatch/diagnosis/density/": {"own", "host_sim/angle.h"},
    r"scripts/skiplatch/diagnosis/likelihood/": {
        "own",
        "host_sim/angle.h",
        "scripts/skiplatch/diagnosis/density/",
    },
}
WIRING = "host_sim/api/"  # includes the rest, and is included by itself, the program and tests
PROGRAM = "host_sim/main.c"
TOPS = ("firmware", "hal", "host_sim", PYTHON_PACKAGE.as_posix())
INCLUDE_FOLDERS = ("firmware", "hal/include", "host_sim", PYTHON_PACKAGE.as_posix(), *FAMILIES)
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*["<]([^">]+)[">]', re.MULTILINE)

PYTHON_BRIDGE = PYTHON_PACKAGE / "simulator" / "library.py"
PYTHON_TO_C = {"cffi", "ctypes", "_cffi_backend"}


def resolve(source: Path, name: str) -> Path | None:
    """Return the project's file that `source` gets by including `name`, if it is the project's."""
    for folder in (source.parent, *map(Path, INCLUDE_FOLDERS)):
        if (folder / name).is_file():
            return Path(*_normal_parts(folder / name))
    return None


def _normal_parts(path: Path) -> list[str]:
    parts: list[str] = []
    for part in path.parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return parts


def is_allowed(source: Path, target: Path) -> bool:
    """Tell whether `source` may include `target`."""
    if target.parent == source.parent:
        return True
    if target.as_posix().startswith(WIRING):
        return source.as_posix() == PROGRAM
    for room, allowed in ROOMS.items():
        if re.match(room, source.as_posix()):
            if "above" in allowed and target.parent == source.parent.parent:
                return True
            return any(target.as_posix().startswith(f) for f in allowed - {"own", "above"})
    return True


def check_c() -> list[str]:
    """Return the includes that point the wrong way."""
    faults = []
    for top in TOPS:
        for source in sorted(Path(top).rglob("*.[ch]")):
            for name in INCLUDE.findall(source.read_text(encoding="utf-8")):
                target = resolve(source, name)
                if target is not None and not is_allowed(source, target):
                    faults.append(f"{source}: must not include {target}")
    return faults


def module_of(path: Path) -> str:
    """Give the module of a file: a header and the source of the same name are one."""
    return path.with_suffix("").as_posix()


def module_graph(files: str) -> dict[str, set[str]]:
    """Give which modules each module includes in files of these names, other than itself."""
    graph: dict[str, set[str]] = {}
    for top in TOPS:
        for source in Path(top).rglob(files):
            found = (resolve(source, name) for name in INCLUDE.findall(source.read_text("utf-8")))
            targets = {module_of(target) for target in found if target is not None}
            graph.setdefault(module_of(source), set()).update(targets - {module_of(source)})
    return graph


def circles(graph: Mapping[str, set[str]]) -> list[list[str]]:
    """Give the groups of modules of which each one comes, by its includes, to all others."""
    reached = {module: _reached(graph, module) for module in graph}
    groups = {
        tuple(sorted(other for other in reach if module in reached.get(other, ())))
        for module, reach in reached.items()
        if module in reach
    }
    return [list(group) for group in sorted(groups)]


def _reached(graph: Mapping[str, set[str]], module: str) -> set[str]:
    reached: set[str] = set()
    waiting = [module]
    while waiting:
        new = graph.get(waiting.pop(), set()) - reached
        reached |= new
        waiting += new
    return reached


def with_parts_joined(
    graph: Mapping[str, set[str]], headers: Mapping[str, set[str]]
) -> dict[str, set[str]]:
    """Give the graph of what is left once every part is joined to the module that it is part of.

    Args:
        graph: What modules include.
        headers: What their headers include; those without a header are left out.
    """
    joined = {module: set(targets) for module, targets in graph.items()}
    while parts := [
        (part, owner) for part in sorted(joined) if (owner := _owner(joined, headers, part))
    ]:
        part, owner = parts[0]
        joined = {m: {owner if t == part else t for t in targets} for m, targets in joined.items()}
        joined[owner] = (joined[owner] | joined.pop(part)) - {owner}
    return joined


def _owner(graph: Mapping[str, set[str]], headers: Mapping[str, set[str]], module: str) -> str:
    """Give the module of which another one is a part; nothing if it is a part of none.

    A part takes the structures of its owner's header, and of its folder only the owner uses it.
    """
    folder = Path(module).parent
    users = [m for m in headers if m in graph and module in graph[m] and Path(m).parent == folder]
    return users[0] if len(users) == 1 and users[0] in headers.get(module, ()) else ""


def check_circles() -> list[str]:
    """Return the circles of modules."""
    found = circles(with_parts_joined(module_graph("*.[ch]"), module_graph("*.h")))
    return [f"include one another: {', '.join(group)}" for group in found]


def _imported(tree: ast.Module) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names.add(node.module.split(".")[0])
    return names


def check_python() -> list[str]:
    """Return the Python modules that reach C past the bridge."""
    return [
        f"{source}: only {PYTHON_BRIDGE} may import {', '.join(sorted(found))}"
        for source in sorted(PYTHON_PACKAGE.rglob("*.py"))
        if source != PYTHON_BRIDGE
        and (found := _imported(ast.parse(source.read_text(encoding="utf-8"))) & PYTHON_TO_C)
    ]


def main() -> int:
    """Print the faults; 1 if there are any."""
    faults = check_c() + check_circles() + check_python()
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
