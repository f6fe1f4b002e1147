"""The call graph of a linked program, and the checks that live on it."""

import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts" / "lint"

AVR_PROGRAM = """
00000100 <main>:
     100:\t0e 94 90 00 \tcall\t0x120\t; 0x120 <work>
     104:\t00 d0       \trcall\t.+0      \t; 0x106 <main+0x6>
     106:\tfc cf       \trjmp\t.-8      \t; 0x100 <main>

00000120 <work>:
     120:\tcf 93       \tpush\tr28
     122:\t0e 94 a0 00 \tcall\t0x140\t; 0x140 <__udivmodhi4>
     126:\tcf 91       \tpop\tr28
     128:\t08 95       \tret

00000140 <__udivmodhi4>:
     140:\tdf 93       \tpush\tr29
     142:\t00 00       \tnop

00000144 <__udivmodhi4_ep>:
     144:\t08 95       \tret

00000150 <__vector_3>:
     150:\t0e 94 90 00 \tcall\t0x120\t; 0x120 <work>
     154:\t18 95       \treti

00000160 <__vector_4>:
     160:\t78 94       \tsei
     162:\t18 95       \treti
"""


def script(name: str) -> ModuleType:
    sys.path.insert(0, str(SCRIPTS))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(SCRIPTS))


@pytest.fixture
def graphs() -> ModuleType:
    return script("call_graph")


def avr_graph(graphs: ModuleType, text: str, **stated_bytes: int) -> Any:  # noqa: ANN401 -- of a script that is no package
    return graphs.CallGraph(graphs.parse_disassembly(text, graphs.AVR), stated_bytes, 3)


def test_the_deepest_path_adds_up_stated_and_pushed_bytes(graphs: ModuleType) -> None:
    graph = avr_graph(graphs, AVR_PROGRAM, main=7, work=20)

    bytes_, path = graph.deepest("main")
    assert path == ["main", "work", "__udivmodhi4", "__udivmodhi4_ep"]
    assert bytes_ == 7 + 20 + (1 + 3) + 3


def test_space_taken_by_a_call_to_the_next_instruction_is_no_recursion(graphs: ModuleType) -> None:
    graph = avr_graph(graphs, AVR_PROGRAM, main=7)

    assert graph.functions["main"].calls == {"work"}


def test_a_function_that_comes_back_to_itself_is_refused(graphs: ModuleType) -> None:
    text = AVR_PROGRAM.replace("0x140 <__udivmodhi4>\n     126", "0x100 <main>\n     126")
    graph = avr_graph(graphs, text, main=7, work=20)

    with pytest.raises(RecursionError, match="work comes back to main"):
        graph.deepest("main")


def with_local_labels(text: str) -> str:
    """AVR_PROGRAM as binutils 2.43 prints it: labels inside `main` and `work`, a jump to one."""
    text = text.replace("     104:", "\n00000104 <L0^A>:\n     104:")
    text = text.replace("     126:", "\n00000126 <.Loc.7>:\n     126:")
    return text.replace("0x106 <main+0x6>", "0x106 <L0^A+0x2>")


def test_local_labels_are_no_functions(graphs: ModuleType) -> None:
    text = with_local_labels(AVR_PROGRAM)

    assert text.count(">:") == AVR_PROGRAM.count(">:") + 2
    assert graphs.parse_disassembly(text, graphs.AVR) == graphs.parse_disassembly(
        AVR_PROGRAM, graphs.AVR
    )


def test_a_jump_to_a_local_label_of_another_function_counts(graphs: ModuleType) -> None:
    text = with_local_labels(AVR_PROGRAM).replace(
        "78 94       \tsei", "e1 cf       \trjmp\t.-62     \t; 0x126 <.Loc.7>"
    )

    assert graphs.parse_disassembly(text, graphs.AVR)["__vector_4"].jumps == {"work"}


def test_division_is_found_behind_an_interrupt_and_not_before_it(graphs: ModuleType) -> None:
    lint = script("lint_isr_calls")
    graph = avr_graph(graphs, AVR_PROGRAM)

    assert lint.faults_below("__vector_4", graph) == []
    assert lint.faults_below("__vector_3", graph) == [
        "__vector_3: divides in software (__udivmodhi4)",
        "__vector_3: divides in software (__udivmodhi4_ep)",
    ]


def test_a_call_through_a_pointer_is_refused_in_an_interrupt(graphs: ModuleType) -> None:
    lint = script("lint_isr_calls")
    graph = avr_graph(graphs, AVR_PROGRAM.replace("78 94       \tsei", "09 95       \ticall"))

    assert lint.faults_below("__vector_4", graph) == [
        "__vector_4: calls through a pointer (__vector_4)"
    ]


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("__udivmodsi4", "divides"),
        ("__udivdi3", "divides"),
        ("__aeabi_uidiv", "divides"),
        ("__aeabi_uldivmod", "divides"),
        ("__addsf3", "floating"),
        ("__divdf3", "floating"),
        ("__floatunsisf", "floating"),
        ("__aeabi_dmul", "floating"),
        ("__aeabi_ui2d", "floating"),
        ("__mulsi3", ""),
        ("__aeabi_lmul", ""),
        ("__aeabi_memcpy", ""),
        ("divide_by_table", ""),
    ],
)
def test_routines_of_the_compiler_are_told_apart(name: str, kind: str) -> None:
    lint = script("lint_isr_calls")

    assert bool(lint.DIVISION.match(name)) == (kind == "divides")
    assert bool(lint.FLOATING_POINT.match(name)) == (kind == "floating")


def test_a_handler_of_a_cortex_runs_on_only_if_nothing_ends_it(graphs: ModuleType) -> None:
    text = (
        "00000100 <handler>:\n"
        "     100:\tb510      \tpush\t{r4, lr}\n"
        "     102:\tb084      \tsub\tsp, #16\n"
        "     104:\tbd10      \tpop\t{r4, pc}\n"
        "     106:\tbf00      \tnop\n"
        "     108:\t40006000 \t.word\t0x40006000\n"
        "\n"
        "0000010c <__udivmoddi4>:\n"
        "     10c:\t4770      \tbx\tlr\n"
    )
    functions = graphs.parse_disassembly(text, graphs.CORTEX_M)

    assert functions["handler"].reached == set()
    assert functions["handler"].pushed_bytes == 8 + 16
    assert not functions["__udivmoddi4"].indirect


def test_a_handler_of_a_riscv_is_told_by_its_name_and_its_pushes(graphs: ModuleType) -> None:
    text = (
        "80000100 <timer_trap>:\n"
        "80000100:\t1141                \tadd\tsp,sp,-16\n"
        "80000102:\t02050463          \tbeqz\ta0,8000012a <work+0x2>\n"
        "80000106:\t2031                \tjal\t80000128 <work>\n"
        "80000108:\t30200073          \tmret\n"
        "\n"
        "80000128 <work>:\n"
        "80000128:\t9782                \tjalr\ta5\n"
        "8000012a:\t8082                \tret\n"
        "\n"
        "80000130 <work_trap_later>:\n"
        "80000130:\tb7dd                \tj\t80000100 <timer_trap>\n"
    )
    functions = graphs.parse_disassembly(text, graphs.RISCV)
    graph = graphs.CallGraph(functions, {}, 0)

    assert functions["timer_trap"].calls == {"work"}
    assert functions["timer_trap"].pushed_bytes == 16
    assert not functions["timer_trap"].runs_on
    assert functions["work"].indirect
    assert functions["work_trap_later"].jumps == {"timer_trap"}
    assert graphs.interrupt_roots(Path("none"), graph, graphs.RISCV) == ["timer_trap"]


@pytest.mark.parametrize(
    ("old", "new", "too_much"),
    [
        (100, 116, False),
        (100, 117, True),
        (5000, 5100, False),
        (5000, 5101, True),
        (100, 10, False),
    ],
)
def test_growth_is_let_pass_up_to_the_margin(old: int, new: int, too_much: bool) -> None:
    assert script("size_table").is_too_much(old, new) is too_much


def test_a_figure_that_grows_is_named_with_the_way_to_record_it() -> None:
    table = script("size_table")
    row = ("a_board", "program")

    _, faults = table.compare({row: table.Size(100, 10, 50)}, {row: table.Size(100, 10, 90)})
    assert len(faults) == 1
    assert faults[0].startswith("a_board, program: stack grew from 50 to 90 bytes;")
    assert faults[0].endswith("make size RECORD=yes")


def test_a_figure_without_a_record_is_a_fault_of_a_board_that_has_others() -> None:
    table = script("size_table")
    size = table.Size(1, 1, 1)

    _, faults = table.compare({("a_board", "input"): size}, {("a_board", "program"): size})
    assert faults == ["a_board, program: not in docs/SIZE.md: make size RECORD=yes"]


def test_goals_are_held(monkeypatch: pytest.MonkeyPatch) -> None:
    table = script("size_table")
    row, families = ("a_board", "input + report"), {"a_board": "avr"}

    assert table.missed_goals({row: table.Size(3072, 128, 1)}, families) == []
    assert table.missed_goals({row: table.Size(3073, 128, 1)}, {"a_board": "arm"}) == []
    assert table.missed_goals({row: table.Size(3073, 128, 1)}, families) == [
        "a_board, input + report: flash is 3073 bytes, goal 3072"
    ]


def test_the_record_is_read_as_it_was_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    table = script("size_table")
    monkeypatch.setattr(table, "RECORD", tmp_path / "SIZE.md")
    rows = {("a_board", "input + report"): table.Size(1, 2, 3)}
    table.RECORD.write_text(table.format_record(rows, {"arm": "gcc 12.2 (Debian)"}))

    assert table.read_record() == (rows, {"arm": "gcc 12.2 (Debian)"})


def test_stack_is_taken_of_sources_that_are_still_there(
    graphs: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("present", "removed"):
        usage = tmp_path / f"obj/firmware/{name}.su"
        usage.parent.mkdir(parents=True, exist_ok=True)
        usage.write_text(f"{name}.c:1:1:{name}\t8\tstatic\n")
    (tmp_path / "firmware").mkdir()
    (tmp_path / "firmware/present.c").touch()

    assert graphs.parse_stack_usage(Path("obj"), "firmware") == {"present": 8}


def test_an_object_that_does_not_tell_its_stack_is_refused(
    graphs: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("firmware/mute.c", "obj/firmware/mute.o"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).touch()

    with pytest.raises(SystemExit, match=r"mute\.o: compiled without -fstack-usage"):
        graphs.parse_stack_usage(Path("obj"), "firmware")
