"""The call graph of a linked program, from its disassembly: who calls whom, and at what stack.

Stack of a function is what the compiler says (`-fstack-usage`); of one without that (libgcc,
written in assembler) it is what its pushes come to. A jump into another function counts as a call
of it, so a tail call is paid for twice: the figure is a bound.

Newer assemblers for the AVR leave the compiler's local labels in a program: they are no functions.
"""

from __future__ import annotations

import re
import subprocess
from bisect import bisect_right
from dataclasses import dataclass, field
from pathlib import Path

HEADER = re.compile(r"^([0-9a-f]+) <([^>]+)>:$")
HANDLER = re.compile(r"__vector_\d+$|\w+_trap$")  # of an AVR, of a RISC-V
LOCAL = re.compile(r"\.L|L\d+(\^[AB]|[\x01\x02])")
INSTRUCTION = re.compile(r"^\s*[0-9a-f]+:\t[0-9a-f ]+\t([^.\s]\S*)\s*(.*)$")  # no .word
TARGET = re.compile(r"\b(?:0x)?([0-9a-f]+) <[^>]+>")
USAGE = re.compile(r":(\w+)\t(\d+)\t")
WORD_BYTES = 4


@dataclass(frozen=True)
class Processor:
    """What has to be known of an instruction set."""

    tools: str
    branches: re.Pattern[str]
    calls: re.Pattern[str]
    indirect: re.Pattern[str]  # of mnemonic and operands
    ends: re.Pattern[str]  # after it nothing runs on into the next function
    call_bytes: int  # of the return address on the stack
    interrupt_bytes: int  # pushed by the hardware beside what the handler itself accounts for
    interrupts_nest: bool


AVR = Processor(
    "avr-",
    re.compile(r"^(r?call|r?jmp|br\w+)$"),
    re.compile(r"^r?call$"),
    re.compile(r"^e?icall\b"),
    re.compile(r"^(reti?|r?jmp|e?ijmp)\b"),
    call_bytes=3,
    interrupt_bytes=0,
    interrupts_nest=False,
)
CORTEX_M = Processor(
    "arm-none-eabi-",
    re.compile(r"^(b|bl|cbn?z|b[a-z]{2})(\.[nw])?$"),
    re.compile(r"^bl$"),
    re.compile(r"^(blx r|bx r)"),
    re.compile(r"^(b(\.[nw])? |bx |pop.*pc|ldm.*pc|ldr.*pc, \[sp|tb[bh]|udf|\.)"),
    call_bytes=0,
    interrupt_bytes=9 * WORD_BYTES,  # eight registers and a word of alignment
    interrupts_nest=True,
)
RISCV = Processor(
    "riscv64-unknown-elf-",
    re.compile(r"^(j|jal|b\w+)$"),
    re.compile(r"^jal$"),
    re.compile(r"^(jalr|jr)\b"),
    re.compile(r"^(ret|mret|j|jr|tail|unimp)\b"),
    call_bytes=0,
    interrupt_bytes=0,  # a handler pushes for itself
    interrupts_nest=True,
)
PROCESSORS = {"avr": AVR, "arm": CORTEX_M, "riscv": RISCV}


@dataclass
class Function:
    """One function: whom it calls or jumps to, and what of it catches the eye."""

    name: str
    calls: set[str] = field(default_factory=set)
    jumps: set[str] = field(default_factory=set)
    indirect: bool = False
    enables_interrupts: bool = False
    pushed_bytes: int = 0
    runs_on: bool = True

    @property
    def reached(self) -> set[str]:
        """Whatever it calls or jumps to."""
        return self.calls | self.jumps


@dataclass(frozen=True)
class CallGraph:
    """The functions of a program."""

    functions: dict[str, Function]
    stated_bytes: dict[str, int]  # by the compiler
    call_bytes: int

    def own_bytes(self, name: str) -> int:
        """Stack of the function alone, with its return address."""
        if name in self.stated_bytes:
            return self.stated_bytes[name]
        return self.functions[name].pushed_bytes + self.call_bytes

    def reachable(self, root: str) -> set[str]:
        """`root` and all that it can come to."""
        found: set[str] = set()
        waiting = [root]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting += self.functions[name].reached & self.functions.keys()
        return found

    def deepest(self, root: str, within: set[str] | None = None) -> tuple[int, list[str]]:
        """Bytes and functions of the path from `root` that takes the most stack.

        Args:
            root: where the path begins
            within: the only functions to count; all if None

        Raises:
            RecursionError: A function can call itself.
        """
        return self._deepest(root, within, (), {})

    def _deepest(
        self,
        name: str,
        within: set[str] | None,
        above: tuple[str, ...],
        known: dict[str, tuple[int, list[str]]],
    ) -> tuple[int, list[str]]:
        if name in known:
            return known[name]
        best: tuple[int, list[str]] = (0, [])
        function = self.functions[name]
        for callee in sorted(function.reached & self.functions.keys()):
            if within is not None and callee not in within:
                continue
            if callee == name or callee in above:
                if callee in function.calls:
                    best = max(best, self._once_more(name, callee))
                continue
            best = max(best, self._deepest(callee, within, (*above, name), known))
        known[name] = (self.own_bytes(name) + best[0], [name, *best[1]])
        return known[name]

    def _once_more(self, name: str, callee: str) -> tuple[int, list[str]]:
        # Some routines of libgcc call themselves for the second operand, no deeper.
        if callee in self.stated_bytes:
            raise RecursionError(f"{name} comes back to {callee}")
        return self.own_bytes(callee), [callee]


class _Starts:
    """Where the functions of a disassembly begin."""

    def __init__(self, text: str) -> None:
        headers = (HEADER.match(line) for line in text.splitlines())
        named = [(int(found[1], 16), found[2]) for found in headers if found]
        self._names = {address: name for address, name in named if not LOCAL.match(name)}
        self._addresses = sorted(self._names)

    def at(self, address: int) -> str | None:
        """Return the function that begins at an address, None in the middle of one."""
        return self._names.get(address)

    def around(self, address: int) -> str | None:
        """Return the function that an address lies in, None before the first one."""
        index = bisect_right(self._addresses, address)
        return self._names[self._addresses[index - 1]] if index else None


def _note(
    function: Function, mnemonic: str, operands: str, processor: Processor, starts: _Starts
) -> None:
    line = f"{mnemonic} {operands}"
    if mnemonic != "nop":
        function.runs_on = processor.ends.match(line) is None
    function.indirect |= processor.indirect.match(line) is not None
    function.enables_interrupts |= mnemonic == "sei"
    function.pushed_bytes += _pushed_bytes(mnemonic, operands)
    target = TARGET.search(operands)
    if not processor.branches.match(mnemonic) or target is None or operands.startswith(".+0"):
        return
    address = int(target[1], 16)
    name = starts.around(address)
    if name is None:
        return
    if processor.calls.match(mnemonic) and (name != function.name or starts.at(address)):
        function.calls.add(name)
    elif name != function.name:
        function.jumps.add(name)


def _pushed_bytes(mnemonic: str, operands: str) -> int:
    registers = operands.count(",") + 1
    if mnemonic == "push":
        return registers * WORD_BYTES if operands.startswith("{") else 1
    if mnemonic.startswith("stmdb") and operands.startswith("sp!"):
        return (registers - 1) * WORD_BYTES
    if mnemonic.startswith("sub") and operands.startswith("sp,") and "#" in operands:
        return int(operands.split("#")[1].split(maxsplit=1)[0])
    if mnemonic in ("add", "addi") and (down := re.match(r"sp,sp,-(\d+)", operands)):
        return int(down[1])
    return 0


def parse_disassembly(text: str, processor: Processor) -> dict[str, Function]:
    """Return the functions of what `objdump --disassemble` printed."""
    functions: dict[str, Function] = {}
    present: Function | None = None
    starts = _Starts(text)
    for line in text.splitlines():
        if header := HEADER.match(line):
            if LOCAL.match(header[2]):
                continue
            following = functions.setdefault(header[2], Function(header[2]))
            if present is not None and present.runs_on:
                present.jumps.add(following.name)
            present = following
        elif present is not None and (code := INSTRUCTION.match(line)):
            _note(present, code[1], code[2], processor, starts)
    return functions


def compiled(objects: Path, room: str, ending: str) -> list[Path]:
    """Return what was compiled of a folder's sources that are still there, without its tests."""
    return [
        path
        for path in sorted((objects / room).rglob(f"*{ending}"))
        if path.relative_to(objects).with_suffix(".c").is_file() and path.parent.name != "tests"
    ]


def parse_stack_usage(objects: Path, room: str) -> dict[str, int]:
    """Return bytes of stack by function, of the `.su` files; of a name's several, the largest."""
    bytes_of: dict[str, int] = {}
    for path in compiled(objects, room, ".o"):
        if not path.with_suffix(".su").is_file():
            raise SystemExit(f"{path}: compiled without -fstack-usage; remove it and make it again")
    for path in compiled(objects, room, ".su"):
        for name, number in USAGE.findall(path.read_text(encoding="utf-8")):
            bytes_of[name] = max(bytes_of.get(name, 0), int(number))
    return bytes_of


def run_tool(*command: str) -> str:
    """Return what a tool of the compiler's printed."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def read_call_graph(program: Path, objects: Path, processor: Processor) -> CallGraph:
    """Return the call graph of a board's program; of `objects`, tests are no part of it."""
    text = run_tool(f"{processor.tools}objdump", "--disassemble", str(program))
    functions = parse_disassembly(text, processor)
    stated_bytes = parse_stack_usage(objects, "firmware") | parse_stack_usage(objects, "hal")
    return CallGraph(functions, stated_bytes, processor.call_bytes)


def programs(board: str) -> dict[str, Path]:
    """Return the linked programs of a board by what docs/SIZE.md calls them."""
    folder = Path("build/boards", board)
    others = [path for path in sorted(folder.glob("*.elf")) if not path.stem.startswith("firmware")]
    return {"program": folder / "firmware.elf"} | {f"{path.stem} program": path for path in others}


def task_root(graph: CallGraph) -> str:
    """Where the program's task begins."""
    return "reset" if "reset" in graph.functions else "main"


def interrupt_roots(program: Path, graph: CallGraph, processor: Processor) -> list[str]:
    """Return the interrupt handlers: by name, but of the table that comes first on a Cortex-M."""
    if processor is not CORTEX_M:
        return sorted(name for name in graph.functions if HANDLER.match(name))
    listing = run_tool(f"{processor.tools}nm", "--print-size", str(program))
    symbols = [line.split() for line in listing.splitlines() if len(line.split()) == 4]
    name_at = {int(address, 16) & ~1: name for address, _, kind, name in symbols if kind in "tTwW"}
    table = next(int(size, 16) for _, size, _, name in symbols if name == "vectors")
    raw = program.with_suffix(".bin")
    run_tool(f"{processor.tools}objcopy", "--output-target=binary", str(program), str(raw))
    words = memoryview(raw.read_bytes()[WORD_BYTES:table]).cast("I")
    found = {name_at[word & ~1] for word in words if word & 1}
    return sorted(found - {task_root(graph)})
