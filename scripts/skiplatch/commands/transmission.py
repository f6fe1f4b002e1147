"""``skiplatch transmission``: the error of a drive chain from the pulses of two encoders."""

import re
from fractions import Fraction
from pathlib import Path

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.numbers import CountType, NumberType
from skiplatch.commands.options import html_option, json_option, write_document, write_json
from skiplatch.errors import quoted
from skiplatch.transmission.firmware import Method
from skiplatch.transmission.measure import Chain, Measurement, measure, measure_all
from skiplatch.transmission.text import as_json, as_text, methods_json, methods_text
from skiplatch.transmission.train import GearTrain, read_train

EPILOG = """\b
Example:
  skiplatch transmission PULSES.csv --lines1 1024 --lines2 3600 --ratio 407/10 --json build/te.json
"""
MOST_LINES = 1 << 24
SHORT_NUMBER = re.compile(r"[+-]?\d{1,12}(\.\d{1,12}|/\d{1,12})?", re.ASCII)


class RatioType(click.ParamType[Fraction]):
    """Turns of the input in a turn of the output, as an exact fraction: ``407/10`` or ``40.7``."""

    name = "ratio"

    def convert(
        self, value: str | Fraction, param: click.Parameter | None, ctx: click.Context | None
    ) -> Fraction:
        """See `click.ParamType.convert`."""
        if isinstance(value, Fraction):
            return value
        try:
            ratio = Fraction(value if SHORT_NUMBER.fullmatch(value) else "none")
        except (ValueError, ZeroDivisionError):
            self.fail(f"{quoted(value)} is no fraction such as 407/10", param, ctx)
        if ratio <= 0:
            self.fail(f"{value} is not above zero: input turns in an output turn", param, ctx)
        return ratio


@click.command(epilog=EPILOG)
@click.argument("pulses", type=Source())
@click.option(
    "--lines1", type=CountType(1, MOST_LINES), required=True, help="Of the input encoder."
)
@click.option(
    "--lines2", type=CountType(1, MOST_LINES), required=True, help="Of the output encoder."
)
@click.option(
    "--ratio",
    type=RatioType(),
    required=True,
    help="Turns of the input in a turn of the output, as an exact fraction: 407/10.",
)
@click.option(
    "--method",
    type=click.Choice([method.value for method in Method]),
    default=Method.SUBDIVIDED.value,
    show_default=True,
    help="How the trains are compared.",
)
@click.option(
    "--all-methods", is_flag=True, help="Run all five methods and show the limit of each."
)
@click.option(
    "--meter-ms",
    type=NumberType(1e-3, 1e4),
    default=10.0,
    show_default=True,
    help="Time constant of the meter of analog phase comparison.",
)
@click.option(
    "--train",
    "train_path",
    type=Source(),
    help="Description of the train in TOML: orders are then given their shaft, and the tooth "
    "pitch is that of its last stage instead of a turn of the input.",
)
@json_option
@html_option
def command(
    pulses: Path,
    lines1: int,
    lines2: int,
    ratio: Fraction,
    method: str,
    all_methods: bool,  # noqa: FBT001
    meter_ms: float,
    train_path: Path | None,
    json_path: Path | None,
    html_path: Path | None,
) -> None:
    """Measure the transmission error of a drive chain from two trains of PULSES.

    PULSES is a CSV file with the columns channel (1 input, 2 output) and t_ns in order of time,
    or the binary file of docs/TRANSMISSION.md. The error is that of the output's angle,
    theta2 - theta1/i, in arcsec; orders count periods in a turn of the output, and the phase is
    that of a sine at the first line of the output.
    """
    if all_methods and html_path is not None:
        raise click.UsageError("--html shows one method: leave out --all-methods")
    chain = Chain(lines1, lines2, ratio, meter_ms * 1e-3)
    train = read_train(train_path) if train_path is not None else None
    if train is not None:
        train.refuse_other_ratio(ratio)
    if all_methods:
        results = measure_all(pulses, chain, train)
        click.echo(methods_text(pulses.name, chain, results))
        write_json(json_path, methods_json(chain, results))
        return
    result = measure(pulses, chain, Method(method), train)
    click.echo(as_text(pulses.name, method, result, train))
    write_json(json_path, as_json(method, result, train))
    if html_path is not None:
        write_document(html_path, _page(pulses.name, method, chain, result, train))


def _page(
    name: str, method: str, chain: Chain, result: Measurement, train: GearTrain | None
) -> str:
    # Drawing takes time to load, which only those pay who want a page.
    from skiplatch.report.transmission import as_html  # noqa: PLC0415

    return as_html(name, method, chain, result, train)
