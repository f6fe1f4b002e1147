"""The program ends without a traceback whatever comes: 0, 1 for a gap, 2, or by a signal."""

import signal
import subprocess
import sys

import pytest

FAULT = """
from skiplatch import cli
def invoke(self, ctx):
    raise RuntimeError("what nobody\\nmeant")
cli._LazyGroup.invoke = invoke
cli.main()
"""
AT_IMPORT = """
import importlib.abc, os, signal, sys
HANDLER = signal.{handler}
class Interrupts(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "skiplatch.{module}":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupts())
signal.signal(signal.SIGINT, HANDLER)
from skiplatch.__main__ import main
main()
"""
IN_CONTEXT = """
import click
from skiplatch import cli
def make_context(*words, **options):
    raise KeyboardInterrupt
click.Group.make_context = make_context
cli.main()
"""


def run(script: str, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *options, "-c", script, "effects"]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_fault_of_its_own_is_one_line() -> None:
    done = run(FAULT)

    told = "skiplatch: a fault of skiplatch itself: RuntimeError: what nobody\\nmeant; "
    assert done.returncode == 2
    assert done.stderr == f"{told}PYTHONDEVMODE=1 shows where\n"


def test_whoever_develops_sees_where_a_fault_is() -> None:
    done = run(FAULT, "-X", "dev")

    assert done.returncode == 2
    assert ", in invoke" in done.stderr


@pytest.mark.parametrize("module", ["cli", "simulator.library"])
def test_an_interrupt_while_it_loads_ends_it_without_a_word(module: str) -> None:
    done = run(AT_IMPORT.format(handler="default_int_handler", module=module))

    assert done.returncode == -signal.SIGINT
    assert done.stderr == ""


def test_an_interrupt_while_a_command_loads_is_told() -> None:
    done = run(AT_IMPORT.format(handler="default_int_handler", module="commands.effects"))

    assert done.returncode == 128 + signal.SIGINT
    assert done.stderr == "interrupted\n"


def test_an_interrupt_while_the_command_line_is_read_is_told() -> None:
    done = run(IN_CONTEXT)

    assert done.returncode == 128 + signal.SIGINT
    assert done.stderr == "interrupted\n"


@pytest.mark.parametrize("module", ["cli", "commands.effects"])
def test_an_interrupt_that_the_caller_ignores_is_ignored(module: str) -> None:
    done = run(AT_IMPORT.format(handler="SIG_IGN", module=module))

    assert done.returncode == 0
    assert done.stderr == ""
