"""Refuse slow arithmetic in the interrupts of linked programs.

`lint_isr_calls.py BOARD...`, each `NAME:FAMILY` (avr, arm, riscv), its programs in
build/boards/NAME.
Follows every interrupt handler through the call graph. Neither an AVR nor a Cortex-M0+ has a
divider, and none of the boards has floating point, so either shows up as a call to a routine of the
compiler that takes hundreds of cycles. Calls through pointers cannot be followed and are refused.
"""

from __future__ import annotations

import re
import sys

from call_graph import PROCESSORS, CallGraph, interrupt_roots, programs, read_call_graph

DIVISION = re.compile(r"^__(?:aeabi_)?(?:u?[il])?u?(?:div|mod)(?!sf|df)\w*$")
FLOATING_POINT = re.compile(
    r"^__(?:(?:add|sub|mul|div|neg|cmp|eq|ne|lt|le|gt|ge|unord)[sd]f\d*\w*|float\w+|fix\w+|fp_\w+"
    r"|aeabi_(?:[cdf]\w+|u?[il]2[df]))$"
)


def faults_below(root: str, graph: CallGraph) -> list[str]:
    """Return what the handler `root` must not come to, and does."""
    faults = []
    for name in sorted(graph.reachable(root)):
        function = graph.functions[name]
        if FLOATING_POINT.match(name):
            faults.append(f"{root}: floating point ({name})")
        elif DIVISION.match(name):
            faults.append(f"{root}: divides in software ({name})")
        if function.indirect:
            faults.append(f"{root}: calls through a pointer ({name})")
    return faults


def check(board: str, family: str) -> list[str]:
    """Return the faults of one board's programs, after printing their handlers."""
    processor = PROCESSORS[family]
    faults = []
    for what, program in programs(board).items():
        graph = read_call_graph(program, program.parent / "obj", processor)
        roots = interrupt_roots(program, graph, processor)
        name = f"{board}, {what}"
        print(f"{name}: {', '.join(roots)}")
        if not roots:
            faults.append(f"{name}: no interrupt handlers found")
        faults += [f"{name}: {fault}" for root in roots for fault in faults_below(root, graph)]
    return faults


def main(arguments: list[str]) -> int:
    """Print the faults; 1 if there are any."""
    faults = [fault for argument in arguments for fault in check(*argument.split(":"))]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
