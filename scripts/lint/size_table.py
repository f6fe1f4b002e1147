"""Measure flash, RAM and worst stack of every board and compare them with the record.

`size_table.py compare BOARD...` prints old, new and difference, and fails (1) if a figure has grown
by more than the margin, or misses a goal; where a board is not in the record yet, or that was made
by another compiler, it exits with 77, skipped. `size_table.py record BOARD...` writes docs/SIZE.md
anew. A BOARD is `NAME:FAMILY` (avr, arm, riscv); its program and objects are in build/boards/NAME.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

from call_graph import (
    PROCESSORS,
    CallGraph,
    Processor,
    compiled,
    interrupt_roots,
    parse_stack_usage,
    programs,
    read_call_graph,
    run_tool,
    task_root,
)

RECORD = Path("docs/SIZE.md")
FOLDERS = ("input", "report", "cycle", "inject")
COLUMNS = ("flash", "RAM", "stack")
MARGIN_BYTES = 16
MARGIN_PERCENT = 2
SKIPPED = 77

# Of the issue: what latching and reporting may take on a board of this family.
GOALS = {("input + report", "flash"): 3072, ("input + report", "RAM"): 128}
GOAL_FAMILY = "avr"

ROW = re.compile(r"^\| (\w+) \| ([^|]+?) \| (\d+) \| (\d+) \| (\d+) \|$", re.MULTILINE)
COMPILER = re.compile(r"^\* (\w+): (.+)$", re.MULTILINE)

TEXT = """\
# Flash, RAM and stack

What the firmware takes, in bytes, written by `make size RECORD=yes`. `make lint` compares every
change with it and refuses growth beyond {margin_bytes} bytes or {margin_percent} %, whichever is
more. A change that is worth it is recorded in the same commit.

| board | what | flash | RAM | stack |
|---|---|---|---|---|
{rows}

* **program** is the whole firmware of the board, linked. Flash is code, constants and initial
  values; RAM is variables. Stack is the deepest path of the task and, on top of it, of the
  interrupts that can come together. On an AVR that is one interrupt, beside such as let others in.
  On a Cortex-M it is all of them, each with the nine words that the processor may push. On a RISC-V
  it is all of them, too. That is a bound, as some share a priority.
* A **NAME program** is a second one, of `main_NAME.c`, for a chip that does nothing else.
* **input**, **report**, **cycle**, **inject** are the folders of `firmware/`, all that is compiled,
  whether a board needs it or not. RAM is one of each structure that a caller owns
  (`tests/boards/one_of_each.c`). Stack is the deepest path inside the folder, 0 where the program
  uses nothing of it.
* **input + report** is what latching on both paths and reporting take in that program. Goal on an
  AVR: {goal_flash} of flash, {goal_ram} of RAM. Flash is without what only a receiver of records
  uses (the decoder), which is not linked. RAM is `skip_input_t`, `plc_task_t` and `latch_report_t`.

A board that has no folder in `hal/ports` is another one's port compiled for that core (OTHER_CORES
in its `board.mk`), to keep it portable. With its floating-point unit on, a Cortex-M4F pushes up to
18 words more at each interrupt.

Stack comes from `-fstack-usage` and the call graph of the linked program
(`scripts/lint/call_graph.py`). A tail call is counted as a call, so it too is a bound.

Compiled with:

{compilers}
"""


@dataclass(frozen=True)
class Size:
    """One row, in bytes."""

    flash: int
    ram: int
    stack: int

    def columns(self) -> dict[str, int]:
        """The figures by the name of their column."""
        return dict(zip(COLUMNS, (self.flash, self.ram, self.stack), strict=True))


Table = dict[tuple[str, str], Size]


def sections(paths: list[Path], processor: Processor) -> tuple[int, int]:
    """Return flash and RAM of objects or programs: text + data, data + bss."""
    flash = ram = 0
    listing = run_tool(f"{processor.tools}size", *map(str, paths))
    for line in listing.splitlines()[1:]:
        text, data, bss = (int(field) for field in line.split()[:3])
        flash += text + data
        ram += data + bss
    return flash, ram


def interrupt_bytes(program: Path, graph: CallGraph, processor: Processor) -> int:
    """Return the stack that interrupts take at most, on top of the task."""
    nesting, closed = 0, [0]
    for root in interrupt_roots(program, graph, processor):
        size_bytes = graph.deepest(root)[0] + processor.interrupt_bytes
        opens = any(graph.functions[name].enables_interrupts for name in graph.reachable(root))
        if processor.interrupts_nest or opens:
            nesting += size_bytes
        else:
            closed.append(size_bytes)
    return nesting + max(closed)


def structures(objects: Path, processor: Processor) -> dict[str, int]:
    """Return the sizes of one of each structure, by name."""
    path = objects / "tests/boards/one_of_each.o"
    listing = run_tool(f"{processor.tools}nm", "--print-size", str(path))
    sized = (line.split() for line in listing.splitlines() if len(line.split()) == 4)
    return {name: int(size, 16) for _, size, _, name in sized}


def linked_flash(program: Path, objects: Path, rooms: list[str], processor: Processor) -> int:
    """Return the code that the program has of the folders, without what it does not use of them."""
    names = {name for room in rooms for name in parse_stack_usage(objects, room)}
    listing = run_tool(f"{processor.tools}nm", "--print-size", str(program))
    sized = (line.split() for line in listing.splitlines() if len(line.split()) == 4)
    return sum(int(size, 16) for _, size, kind, name in sized if kind in "tT" and name in names)


def folder_stack(objects: Path, room: str, graph: CallGraph) -> int:
    """Return the deepest path inside one folder, of what the program has of it."""
    inside = parse_stack_usage(objects, room).keys() & graph.functions.keys()
    return max((graph.deepest(name, set(inside))[0] for name in inside), default=0)


def program_size(program: Path, objects: Path, processor: Processor) -> Size:
    """Return what a whole program takes."""
    graph = read_call_graph(program, objects, processor)
    stack = graph.deepest(task_root(graph))[0] + interrupt_bytes(program, graph, processor)
    return Size(*sections([program], processor), stack)


def measure(board: str, processor: Processor) -> Table:
    """Return the rows of one board."""
    objects = Path("build/boards", board, "obj")
    table = {
        (board, what): program_size(path, objects, processor)
        for what, path in programs(board).items()
    }
    program = programs(board)["program"]
    graph = read_call_graph(program, objects, processor)
    owned = structures(objects, processor)
    for name in FOLDERS:
        room = f"firmware/{name}"
        flash, ram = sections(compiled(objects, room, ".o"), processor)
        ram += sum(size for variable, size in owned.items() if variable.startswith(name))
        table[board, name] = Size(flash, ram, folder_stack(objects, room, graph))
    inner, outer = table[board, "input"], table[board, "report"]
    rooms = ["firmware/input", "firmware/report"]
    table[board, "input + report"] = Size(
        linked_flash(program, objects, rooms, processor),
        inner.ram + outer.ram - owned["report_receiver"],
        max(inner.stack, outer.stack),
    )
    return table


def compiler(processor: Processor) -> str:
    """Return name and version of the compiler, which the figures depend on."""
    return run_tool(f"{processor.tools}gcc", "--version").splitlines()[0]


def read_record() -> tuple[Table, dict[str, str]]:
    """Return the recorded rows, and the compiler of each family."""
    text = RECORD.read_text(encoding="utf-8") if RECORD.is_file() else ""
    rows = {
        (board, what): Size(int(flash), int(ram), int(stack))
        for board, what, flash, ram, stack in ROW.findall(text)
    }
    return rows, dict(COMPILER.findall(text))


def format_record(table: Table, compilers: dict[str, str]) -> str:
    """Return docs/SIZE.md."""
    rows = [
        f"| {board} | {what} | {size.flash} | {size.ram} | {size.stack} |"
        for board in dict.fromkeys(board for board, _ in table)
        for (of, what), size in table.items()
        if of == board
    ]
    return TEXT.format(
        margin_bytes=MARGIN_BYTES,
        margin_percent=MARGIN_PERCENT,
        goal_flash=GOALS["input + report", "flash"],
        goal_ram=GOALS["input + report", "RAM"],
        rows="\n".join(rows),
        compilers="\n".join(f"* {family}: {name}" for family, name in compilers.items()),
    )


def is_too_much(old_bytes: int, new_bytes: int) -> bool:
    """Tell whether a figure has grown by more than the margin."""
    return new_bytes - old_bytes > max(MARGIN_BYTES, old_bytes * MARGIN_PERCENT // 100)


def unrecorded(old: Table, new: Table) -> list[str]:
    """Return the boards that have no row in the record yet."""
    recorded = {board for board, _ in old}
    return list(dict.fromkeys(board for board, _ in new if board not in recorded))


def compare(old: Table, new: Table) -> tuple[list[str], list[str]]:
    """Return the lines of old, new and difference, and the faults."""
    lines = [f"{'board':<17}{'what':<24}{'':<7}{'old':>7}{'new':>7}{'diff':>7}"]
    faults = []
    boards = unrecorded(old, new)
    for (board, what), size in new.items():
        for column, new_bytes in size.columns().items():
            if board in boards:
                lines.append(f"{board:<17}{what:<24}{column:<7}{'':>7}{new_bytes:>7}")
                continue
            if (board, what) not in old:
                faults.append(f"{board}, {what}: not in {RECORD}: make size RECORD=yes")
                break
            old_bytes = old[board, what].columns()[column]
            change = new_bytes - old_bytes
            lines.append(
                f"{board:<17}{what:<24}{column:<7}{old_bytes:>7}{new_bytes:>7}{change:>+7}"
            )
            if is_too_much(old_bytes, new_bytes):
                faults.append(
                    f"{board}, {what}: {column} grew from {old_bytes} to {new_bytes} bytes;"
                    " if it is worth that: make size RECORD=yes"
                )
    return lines, faults


def missed_goals(table: Table, families: dict[str, str]) -> list[str]:
    """Return the goals that are not reached, with the family of each board."""
    return [
        f"{board}, {what}: {column} is {table[board, what].columns()[column]} bytes, goal {goal}"
        for (what, column), goal in GOALS.items()
        for board, family in families.items()
        if family == GOAL_FAMILY and table[board, what].columns()[column] > goal
    ]


def main(arguments: list[str]) -> int:
    """Measure, then compare or record; see the top."""
    families = dict(argument.split(":") for argument in arguments[1:])
    compilers = {family: compiler(PROCESSORS[family]) for family in sorted(set(families.values()))}
    new: Table = {}
    for board, family in families.items():
        new |= measure(board, PROCESSORS[family])
    old, recorded = read_record()
    if arguments[0] == "record":
        RECORD.write_text(format_record(old | new, recorded | compilers), encoding="utf-8")
    lines, faults = compare(old, new)
    print("\n".join(lines))
    goals = missed_goals(new, families)
    print("\n".join(goals if arguments[0] == "record" else faults + goals))
    absent = unrecorded(old, new)
    foreign = [name for family, name in compilers.items() if recorded.get(family, name) != name]
    if foreign and arguments[0] == "compare":
        print(f"{RECORD} was not made by {', '.join(foreign)}")
        return 1 if goals else SKIPPED
    if absent and arguments[0] == "compare" and not faults + goals:
        print(f"{', '.join(absent)} not in {RECORD} yet: make size RECORD=yes")
        return SKIPPED
    return 1 if goals or (faults and arguments[0] == "compare") else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
