"""``skiplatch import``: from a log that people have to a campaign."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from skiplatch.campaign import Kind
from skiplatch.commands.imported import finish, nominal_option, path_option
from skiplatch.commands.importers import Importers
from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import FEED_MM_MIN, NumberType
from skiplatch.commands.options import Decorator, json_option
from skiplatch.commands.outputs import OutputFolder
from skiplatch.commands.units import inch_option, ini_option, is_inch, units_option
from skiplatch.importing.model import Imported

if TYPE_CHECKING:
    from skiplatch.importing.analyser import Capture

EPILOG = """\b
Example:
  skiplatch import klipper klippy.log --out build/printer
  skiplatch import linuxcnc probe.txt --program probe.ngc --out build/mill
"""

out_option: Decorator = click.option(
    "-o", "--out", type=OutputFolder(is_new=True), required=True, help="Folder of the campaign."
)
feed_option: Decorator = click.option(
    "--feed",
    type=FEED_MM_MIN,
    metavar="MM/MIN",
    help="Measuring feed, where the log does not say it.",
)
log_argument: Decorator = click.argument("log", type=Source())
axis_option: Decorator = click.option(
    "--axis", type=click.Choice(list("XYZABC"), case_sensitive=False), help="The axis that probed."
)


@click.group(cls=Importers, epilog=EPILOG)
def command() -> None:
    """Make a campaign out of a log, and say what is known, assumed, and cannot be told from it.

    The folder then goes through check, repeat, compare and diagnose.
    """


@command.command(epilog="Example: skiplatch import linuxcnc probe.txt --program probe.ngc -o mill")
@click.argument("logs", nargs=-1, required=True, metavar="LOG...", type=Source())
@click.option(
    "--program",
    "programs",
    multiple=True,
    type=Source(),
    help="The G-code whose G38.x moves made the log: feeds, axes, senses. One for each LOG.",
)
@axis_option
@feed_option
@units_option
@inch_option
@ini_option
@path_option
@nominal_option
@out_option
@json_option
def linuxcnc(
    *,
    logs: tuple[Path, ...],
    programs: tuple[Path, ...],
    axis: str | None,
    feed: float | None,
    units: str | None,
    inch: bool,
    ini: Path | None,
    **written: Any,  # noqa: ANN401
) -> None:
    """Read the LOG that (PROBEOPEN …) made, or several of one rig in their order."""
    from skiplatch.importing.linuxcnc import read_linuxcnc_logs  # noqa: PLC0415

    probed, unit = axis.upper() if axis else None, is_inch(units, inch=inch)
    found = read_linuxcnc_logs(logs, programs, probed, feed, inch=unit, ini=ini)
    finish(found, (*logs, *programs, *([ini] if ini else [])), **written)


@command.command(epilog="Example: skiplatch import grbl serial.log --out build/router")
@log_argument
@feed_option
@click.option("--inch", is_flag=True, help="Commands and replies are in inches.")
@path_option
@nominal_option
@out_option
@json_option
def grbl(*, log: Path, feed: float | None, inch: bool, **written: Any) -> None:  # noqa: ANN401
    """Read the LOG of a serial line with grbl, grblHAL, FluidNC or Grbl_Esp32."""
    from skiplatch.importing.grbl import read_grbl  # noqa: PLC0415

    finish(read_grbl(log, feed, inch=inch), (log,), **written)


@command.command(epilog="Example: skiplatch import klipper klippy.log --out build/printer")
@log_argument
@feed_option
@path_option
@nominal_option
@out_option
@json_option
def klipper(log: Path, feed: float | None, **written: Any) -> None:  # noqa: ANN401
    """Read klippy.log or a copied console as LOG."""
    from skiplatch.importing.klipper import read_klipper  # noqa: PLC0415

    finish(read_klipper(log, feed), (log,), **written)


@command.command(epilog="Example: skiplatch import marlin m48.log --feed 120 --out build/printer")
@log_argument
@feed_option
@path_option
@nominal_option
@out_option
@json_option
def marlin(log: Path, feed: float | None, **written: Any) -> None:  # noqa: ANN401
    """Read the console of M48 V4 or G30 as LOG, or of G30 S-1 on a Duet."""
    from skiplatch.importing.marlin import read_marlin  # noqa: PLC0415

    finish(read_marlin(log, feed), (log,), **written)


@command.command(
    epilog='Example: skiplatch import csv t.csv --map "deviation_um=Error [mm]" --out build/table'
)
@click.argument("table", type=Source())
@click.option(
    "--map",
    "mappings",
    multiple=True,
    required=True,
    metavar='COLUMN="HEAD [UNIT]"',
    help="A column of a campaign (skiplatch columns), or coordinate_mm, or date beside time, and "
    "the head of the table's column that stands for it, with its unit where that differs.",
)
@click.option(
    "--kind",
    type=click.Choice([kind.value for kind in Kind], case_sensitive=False),
    default=Kind.MACHINE.value,
    show_default=True,
)
@axis_option
@click.option("--sign", type=click.Choice(["1", "-1"]), help="Sense of the motion.")
@feed_option
@nominal_option
@out_option
@json_option
def csv(
    table: Path,
    mappings: tuple[str, ...],
    kind: str,
    axis: str | None,
    sign: str | None,
    feed: float | None,
    **written: Any,  # noqa: ANN401
) -> None:
    """Read any TABLE; units are converted."""
    from skiplatch.importing.mapped import parse_mapping  # noqa: PLC0415
    from skiplatch.importing.table import read_table  # noqa: PLC0415

    try:
        mapped = [parse_mapping(text) for text in mappings]
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--map") from error
    found = read_table(
        table,
        mapped,
        kind=Kind(kind),
        axis=axis.upper() if axis else None,
        sign=int(sign) if sign else None,
        feed=feed,
    )
    finish(found, (table,), **written)


def edge_options(function: Callable[..., None]) -> Callable[..., None]:
    """Give a command the channels of a capture."""
    for option in reversed(EDGE_OPTIONS):
        function = option(function)
    return function


EDGE_OPTIONS = (
    click.argument("capture", type=Source()),
    click.option("--probe", metavar="CHANNEL", help="Channel of the injected edge."),
    click.option("--latch", metavar="CHANNEL", help="Channel that changes at the latch."),
    click.option("--report", metavar="CHANNEL", help="Channel that changes at the report."),
    click.option(
        "--plc-latch",
        metavar="CHANNEL",
        help="Channel that changes at the latch of a PLC task that polls the same edges.",
    ),
    click.option(
        "--scan-us",
        type=NumberType(1.0, 1e6),
        help="Scan period that the PLC task is believed to have; 1000 where it is not given.",
    ),
    click.option(
        "--falling", is_flag=True, help="Falling edges of the probe count rather than rising ones."
    ),
    click.option(
        "--holdoff-us",
        type=NumberType(0.0, 1e9),
        default=1000.0,
        show_default=True,
        help="Edges of the probe within this time of one before, or of a release, are its bounces.",
    ),
    out_option,
    json_option,
)


@command.command(
    epilog="Example: skiplatch import edges capture.vcd --probe D0 --latch D1 --out build/bench"
)
@edge_options
def edges(*, capture: Path, out: Path, json_path: Path | None, **channels: Any) -> None:  # noqa: ANN401
    """Read the CAPTURE of a logic analyser (CSV, VCD, sigrok's .sr) or oscilloscope (CSV)."""
    from skiplatch.importing.captures import read_capture  # noqa: PLC0415

    finish(_touches_of(capture, read_capture(capture), **channels), (capture,), out, json_path)


@command.command(
    epilog="Example: skiplatch import mdf bench.mf4 --probe Edge --latch Latch --out build/bench"
)
@edge_options
def mdf(*, capture: Path, out: Path, json_path: Path | None, **channels: Any) -> None:  # noqa: ANN401
    """Read a CAPTURE in ASAM's MDF; needs asammdf."""
    from skiplatch.importing.mdf import read_mdf  # noqa: PLC0415

    finish(_touches_of(capture, read_mdf(capture), **channels), (capture,), out, json_path)


def _touches_of(
    path: Path,
    capture: "Capture",
    *,
    falling: bool,
    holdoff_us: float,
    scan_us: float | None,
    **channels: str | None,
) -> Imported:
    from skiplatch.importing.edge_channels import Channels  # noqa: PLC0415
    from skiplatch.importing.edges import read_edges  # noqa: PLC0415

    holdoff_s, named = holdoff_us / 1e6, Channels(**channels)
    found = read_edges(path, capture, named, falling=falling, holdoff_s=holdoff_s)
    if scan_us is not None:
        found.figure("plc", "scan_us", scan_us, "given by --scan-us")
    return found


@command.command(epilog="Example: skiplatch import can bus.log --out build/bench")
@log_argument
@out_option
@json_option
def can(log: Path, out: Path, json_path: Path | None) -> None:
    """Read a LOG of CAN traffic (candump -L, ASC, BLF) with the project's own frames."""
    from skiplatch.importing.can_frames import read_can  # noqa: PLC0415

    finish(read_can(log), (log,), out, json_path)


@command.command(epilog="Example: skiplatch import iso230 x_axis.csv --axis X --out build/x")
@click.argument("table", type=Source())
@axis_option
@click.option(
    "--unit",
    type=click.Choice(["um", "mm", "arcsec", "deg"]),
    help="Of the deviations, where the table names none; um, or arcsec of a rotary axis.",
)
@feed_option
@out_option
@json_option
def iso230(
    table: Path,
    axis: str | None,
    unit: str | None,
    feed: float | None,
    out: Path,
    json_path: Path | None,
) -> None:
    """Read a TABLE of positions × runs × senses, as ISO 230-2 has it.

    Runs stand in columns or in rows, or each touch in a line with its position and sense.
    """
    from skiplatch.importing.iso230 import read_iso230  # noqa: PLC0415

    found = read_iso230(table, (axis or "X").upper(), unit=unit, feed=feed)
    finish(found, (table,), out, json_path)
