"""Options of the commands of a bench: its rig, its bus, its key."""

import re
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

from skiplatch.bench.bus import SOCKETCAN
from skiplatch.bench.protocol import LATCH_ID
from skiplatch.bench.run import Rig
from skiplatch.commands.inputs import FILE
from skiplatch.commands.numbers import CountType
from skiplatch.errors import quoted

CAN_ID = re.compile(r"0[xX][0-9a-fA-F]{1,3}|0|[1-9][0-9]{0,3}")

can_backend_option = click.option(
    "--can-backend",
    default=SOCKETCAN,
    show_default=True,
    help="Interface type of python-can, for a bus that is no SocketCAN.",
)


class _CanId(click.ParamType[int]):
    """A standard CAN id, hexadecimal with 0x or decimal."""

    name = "id"

    def convert(
        self, value: str | int, param: click.Parameter | None, ctx: click.Context | None
    ) -> int:
        """See `click.ParamType.convert`."""
        text = str(value)
        number = int(text, 0) if CAN_ID.fullmatch(text) else -1
        if not 0 <= number <= 0x7FF:
            self.fail(f"expected a CAN id from 0 to 0x7FF, got {quoted(text)}", param, ctx)
        return number


latch_id_option = click.option(
    "--latch-id",
    type=_CanId(),
    default=LATCH_ID,
    show_default=f"{LATCH_ID:#x}",
    help="CAN id of latch records.",
)
key_option = click.option(
    "--key",
    "key_path",
    type=FILE,
    help="File with the injector's key, 32 hexadecimal digits: for a bus that others share.",
)


def bench_rig_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options of the rig, and hand it what they describe as ``rig``."""
    options = [
        click.option("--can", "interface", required=True, help="CAN interface: can0, vcan0."),
        click.option("--chip", help="GPIO chip of the watched line: gpiochip0, a path or a label."),
        click.option("--line", type=CountType(0, 65535), help="Offset of the watched line."),
        click.option("--active-low", is_flag=True, help="The line is low while deflected."),
        click.option("--inject-line", metavar="CHIP:OFFSET", help="Output line to drive."),
        click.option("--sim-pull", type=FILE, help="Or: pull file of a gpio-sim line to drive."),
        click.option(
            "--attached",
            is_flag=True,
            help="Start neither controller nor injector: both are on the bus already.",
        ),
        click.option("--cpu", type=CountType(0, 1023), help="Processor of controller and load."),
        click.option("--fifo", type=CountType(1, 99), help="Priority of the controller."),
        click.option("--injector-fifo", type=CountType(1, 99), help="Priority of the injector."),
        latch_id_option,
        key_option,
    ]

    @wraps(function)
    def with_rig(*args: Any, **values: Any) -> Any:  # noqa: ANN401
        taken = {option: values.pop(option) for option in RIG_VALUES}
        return function(*args, rig=_rig(**taken), **values)

    described: Callable[..., Any] = with_rig
    for option in reversed(options):
        described = option(described)
    return described


RIG_VALUES = (
    *("interface", "chip", "line", "active_low", "inject_line", "sim_pull", "attached"),
    *("cpu", "fifo", "injector_fifo", "latch_id", "key_path"),
)


def _rig(
    *,
    interface: str,
    chip: str | None,
    line: int | None,
    active_low: bool,
    inject_line: str | None,
    sim_pull: Path | None,
    attached: bool,
    cpu: int | None,
    fifo: int | None,
    injector_fifo: int | None,
    latch_id: int,
    key_path: Path | None,
) -> Rig:
    """Check that the options name a whole bench."""
    if not attached and (chip is None or line is None):
        raise click.UsageError("--chip and --line are missing, the line to watch; see: gpioinfo")
    if not attached and (inject_line is None) == (sim_pull is None):
        raise click.UsageError("give one of --inject-line and --sim-pull, the line to drive")
    driven = ("--line", inject_line) if inject_line else ("--sim-pull", str(sim_pull))
    return Rig(
        interface=interface,
        chip=None if attached else chip,
        line=line or 0,
        active_low=active_low,
        inject_line=() if attached else driven,
        latch_id=latch_id,
        cpu=cpu,
        priority=fifo or 0,
        injector_priority=injector_fifo or 0,
        key_path=key_path,
    )
