"""``--units`` and ``--inch``: the unit of a log, which it may not say itself."""

import click

from skiplatch.commands.inputs import Source
from skiplatch.commands.options import Decorator
from skiplatch.units import INCH, MM

units_option: Decorator = click.option(
    "--units",
    type=click.Choice([MM, INCH], case_sensitive=False),
    help="The unit that its program began in, where no G20 or G21 tells it.",
)
inch_option: Decorator = click.option("--inch", is_flag=True, help="The same as --units inch.")
ini_option: Decorator = click.option(
    "--ini", type=Source(), help="The machine's INI file: its unit, and the servo period."
)


def is_inch(units: str | None, *, inch: bool = False) -> bool | None:
    """Tell whether the options say inches, or mm, or nothing.

    Raises:
        click.UsageError: They say both.
    """
    if inch and units == MM:
        message = "--inch and --units mm contradict each other"
        raise click.UsageError(message)
    return True if inch else None if units is None else units == INCH
