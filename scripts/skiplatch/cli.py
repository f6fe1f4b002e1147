"""The command line: ``skiplatch COMMAND``."""

import errno
import os
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager, suppress
from importlib import import_module
from io import TextIOWrapper
from pathlib import Path
from typing import Any, NoReturn, TextIO

import click

from skiplatch.errors import CampaignWarning, InputError, as_told, hint, one_line, quoted
from skiplatch.simulator.library import SimulationError
from skiplatch.undo import INTERRUPTED, TERMINATED, taken_back_on_failure

BAD_INPUT = 2
FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF}
"""Of a file that takes no more, or a closed stdout: only that is not named where it is written."""
NO_READER = 128 + signal.SIGPIPE
"""Exit status of a tool whose output nobody reads any longer, as a shell gives it."""
OWN_FAULT = "a fault of skiplatch itself"
WHERE = "PYTHONDEVMODE=1 shows where"

# Name of each command and what it does; its module is imported only when it is called.
COMMANDS = {
    "latch": "How well each input path latches a touch: the error distributions.",
    "simulate": "Play conditions through the nominal simulation and write a campaign.",
    "check": "Say what in a campaign is odd or missing, and what it cannot tell.",
    "columns": "List the columns and keys of a campaign.",
    "import": "Make a campaign out of a machine's or an instrument's log.",
    "init": "Write a commented nominal.toml for a kind of rig.",
    "repeat": "Say how well touches repeat, from a campaign or straight from a log.",
    "compare": "Hold a recorded campaign against the nominal simulation.",
    "diagnose": "Say where the gap lies, which effects cause it, and how far it shrinks.",
    "predict": "Play conditions with the effects that a diagnosis found.",
    "adopt": "Write what a diagnosis found into the beliefs about the rig.",
    "design": "Say which touches or which column would settle a diagnosis, and write them.",
    "settle": "Say what those touches leave of a tie.",
    "effects": "List the effects that a simulation can be given.",
    "transmission": "Measure the error of a drive chain from the pulses of two encoders.",
    "plan": "Find the best probing strategy for a wanted uncertainty.",
    "pretravel": "Map a simulated probe, compensate it by variable feeds, and map it again.",
    "compensate": "Map a probe's errors and even them out by the measuring feed.",
    "kinematics": "Find the location errors of rotary axes from touches of a sphere.",
    "bench": "Play a plan on a Linux bench and record a campaign, or watch its latches live.",
    "fleet": "Keep the campaigns of many rigs and months in one store, and ask it.",
    "samples": "Copy the sample campaigns that the examples name.",
    "demo": "Show all of it on simulated and recorded data, with pictures.",
}

MODULES = {"import": "import_log"}  # a keyword is no name of a module


@contextmanager
def _interrupted_in_order() -> Iterator[None]:
    """Say that the user or the system ended it; click would exit with 1 after a SIGINT."""
    try:
        yield
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
        sys.exit(INTERRUPTED)
    except SystemExit as ended:
        if ended.code == TERMINATED:
            click.echo("interrupted", err=True)
        raise


@contextmanager
def _ended_by_closed_pipe() -> Iterator[None]:
    """Exit as other tools do; click would exit with 1, which says that there is a gap."""
    try:
        yield
    except BrokenPipeError:
        sys.exit(NO_READER)


class _Refusal(click.ClickException):
    """What is wrong with a command line."""

    exit_code = BAD_INPUT


@contextmanager
def _refused_in_one_line() -> Iterator[None]:
    """Say what is wrong with a command line without the usage above it, as of any bad input."""
    try:
        yield
    except click.exceptions.NoArgsIsHelpError:
        raise
    except click.UsageError as error:
        raise _Refusal(one_line(error.format_message().replace("\n\t", " "))) from error


class _LazyGroup(click.Group):
    """A group whose commands live in ``skiplatch.commands``, one module each."""

    def make_context(self, *args: Any, **kwargs: Any) -> click.Context:  # noqa: ANN401
        with _interrupted_in_order(), _ended_by_closed_pipe(), _refused_in_one_line():
            return super().make_context(*args, **kwargs)

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            ctx.fail(f"no command {quoted(args[0])}{hint(args[0], COMMANDS)}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> object:
        with (
            _interrupted_in_order(),
            _refused_in_one_line(),
            _ended_by_closed_pipe(),
            taken_back_on_failure(),
        ):
            result = super().invoke(ctx)
            sys.stdout.flush()
        return result

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        if cmd_name not in COMMANDS:
            return None
        module = MODULES.get(cmd_name, cmd_name)
        command: click.Command = import_module(f"skiplatch.commands.{module}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(
    cls=_LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(package_name="skiplatch")
def group() -> None:
    """Latch touch-probe triggers, and find out why a simulation of them is wrong.

    Example: skiplatch compare scripts/samples/bench_isr_latency
    """


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Show what the user can mend in one line, and everything else as Python does."""
    if issubclass(category, CampaignWarning):
        text = f"warning: {message}\n"
    else:
        text = warnings.formatwarning(message, category, filename, lineno, line)
    click.echo(text, err=True, nl=False, file=file)


def main() -> None:
    """Run the command line; bad input is one line on stderr and exit status 2."""
    _open_what_was_closed()
    _show_what_no_terminal_has()
    warnings.showwarning = _show_warning
    try:
        try:
            group(prog_name="skiplatch")
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        _drop_output()
        sys.exit(NO_READER)
    except (InputError, SimulationError) as error:
        _refuse(str(error))
    except BrokenExecutor:
        _refuse("a process that did a part of the work died, as out of memory; try fewer --jobs")
    except (OSError, MemoryError, RecursionError) as error:
        if isinstance(error, OSError) and error.errno in FULL and error.filename is None:
            _refuse(f"stdout: cannot write: {error.strerror}")
        _refuse(one_line(f"{type(error).__name__}: {error}"))
    except KeyboardInterrupt:  # outside of the commands
        sys.exit(INTERRUPTED)
    except Exception as error:  # noqa: BLE001
        if sys.flags.dev_mode:
            traceback.print_exc()
        _refuse(one_line(f"{OWN_FAULT}: {type(error).__name__}: {error}; {WHERE}"))


class _Nowhere(TextIOWrapper):
    """Stands for a stdout that was closed: a command whose result it would lose ends here."""

    def write(self, text: str) -> int:
        """See `io.TextIOBase.write`.

        Raises:
            OSError: All of the result goes here, or a document that was asked for.
        """
        from skiplatch.commands.claims import goes_to_files  # noqa: PLC0415

        if not goes_to_files():
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        return len(text)


def _open_what_was_closed() -> None:
    """Give a process that was started without stdout or stderr one that goes nowhere."""
    sys.stdout = sys.stdout or _Nowhere(Path(os.devnull).open("wb"))  # noqa: SIM115
    sys.stderr = sys.stderr or Path(os.devnull).open("w")  # noqa: SIM115


def _show_what_no_terminal_has() -> None:
    """Let a question mark stand for what the encoding of stdout has no character for."""
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="replace")


def _refuse(message: str) -> NoReturn:
    """Say it, if there is somewhere left to say it; what stdout still holds goes nowhere."""
    with suppress(OSError):
        click.echo(as_told(message), err=True)
    _drop_output()
    sys.exit(BAD_INPUT)


def _drop_output() -> None:
    """Let go of what cannot be written: Python would try once more at its end, and say so."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


if __name__ == "__main__":
    main()
