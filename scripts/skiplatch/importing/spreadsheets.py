"""Tables as spreadsheets write them: many know no UTF-8 unless they are asked for it."""

import codecs
import re
from collections.abc import Iterable
from pathlib import Path

from skiplatch.campaign import KEYS
from skiplatch.campaign.csv_text import MAX_BYTES, UTF8, Row, read_rows
from skiplatch.errors import InputError
from skiplatch.files import failures_named, refuse_special_or_large
from skiplatch.importing.model import Imported

WINDOWS = "cp1252"
UTF16 = "utf-16"
_PLAIN = re.compile(r"[+-]?\d+[.,]?(\d*)$")


def read_spreadsheet(path: Path) -> tuple[list[Row], str]:
    """Give the rows of a table and the encoding it is in.

    Raises:
        InputError: It cannot be read or is no table.
    """
    encoding = _encoding(path)
    try:
        return list(read_rows(path, encoding)), encoding
    except UnicodeError as error:
        raise InputError(path, None, None, f"neither UTF-8 nor {encoding} text") from error


def say_encoding(found: Imported, encoding: str) -> None:
    """Say that a table was read in an encoding that it does not name."""
    if encoding == WINDOWS:
        found.assumed.append("no UTF-8: letters beyond ASCII were read as Windows-1252 has them")


def say_digit(found: Imported, cells: Iterable[str], unit_um: float) -> None:
    """Note the last digit of lengths as the resolution, where it is coarser than is believed.

    Args:
        found: Is told.
        cells: As they stand in the table; what is no number does not count.
        unit_um: Of the table, in µm.
    """
    decimals = [len(number[1]) for cell in cells if (number := _PLAIN.match(cell.strip()))]
    digit_um = unit_um * 10.0 ** -max(decimals, default=0)
    if decimals and digit_um > KEYS["axis", "resolution_um"].default:
        found.figure("axis", "resolution_um", digit_um, "the last digit of the table")


def _encoding(path: Path) -> str:
    with failures_named(path, "read"):
        refuse_special_or_large(path, MAX_BYTES)
        data = path.read_bytes()
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return UTF16
    try:
        data.decode(UTF8)
    except UnicodeDecodeError:
        return WINDOWS
    return UTF8
