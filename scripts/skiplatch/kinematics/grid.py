"""The grid of cycle 453: its positions, and the table of compensation over them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from math import prod
from sys import float_info
from typing import Any

from skiplatch.units import UM_PER_MM

AXES = ("A", "B", "C")
OFFSETS = "offset_um"
MOST_NODES, MOST_POSITIONS = 25, 75
"""As ``firmware/comp/kinematics_grid.h`` has them."""
TURN_DEG = 360.0
FARTHEST_UM = 1e5

Row = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Grid:
    """Positions that the machine's maker has set, and what is compensated there.

    Attributes:
        nodes_deg: Where A, B, C stand, rising; empty for an axis that is none of the grid.
        offset_mm: What the linear axes go more at each position, A slowest and C fastest; empty
            for nothing at all.
    """

    nodes_deg: tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]
    offset_mm: tuple[Row, ...] = ()

    @property
    def positions_deg(self) -> tuple[Row, ...]:
        """All positions, in the order of the table."""
        of_a, of_b, of_c = (nodes or (0.0,) for nodes in self.nodes_deg)
        return tuple(product(of_a, of_b, of_c))

    @property
    def table_mm(self) -> tuple[Row, ...]:
        """The table, also where nothing is compensated yet."""
        return self.offset_mm or ((0.0, 0.0, 0.0),) * len(self.positions_deg)

    def cleared(self) -> "Grid":
        """Give the grid with nothing compensated."""
        return replace(self, offset_mm=())


class GridError(Exception):
    """A key of the table ``[grid]`` is wrong.

    Attributes:
        key: Which of them; None for the table as a whole.
    """

    def __init__(self, key: str | None, message: str) -> None:
        super().__init__(message)
        self.key = key


def grid_of(table: Mapping[str, Any], letters: Sequence[str]) -> Grid:
    """Read the table ``[grid]`` of a machine with these axes.

    Raises:
        GridError: A value is wrong.
    """
    for key in table:
        if key != OFFSETS and key not in letters:
            axes = ", ".join(sorted(letters))
            raise GridError(key, f"expected an axis of the machine ({axes}) or {OFFSETS}")
    nodes = [_nodes(letter, table[letter]) if letter in table else () for letter in AXES]
    count = prod(len(of_axis) or 1 for of_axis in nodes)
    if not 1 < count <= MOST_POSITIONS:
        raise GridError(None, f"expected 2 to {MOST_POSITIONS} positions, got {count}")
    offsets_um = table.get(OFFSETS, [])
    if OFFSETS in table and not _is_table(offsets_um, count):
        raise GridError(OFFSETS, f"expected {count} rows of X, Y and Z, one for each position")
    offset_mm = [(x / UM_PER_MM, y / UM_PER_MM, z / UM_PER_MM) for x, y, z in offsets_um]
    return Grid((nodes[0], nodes[1], nodes[2]), tuple(offset_mm))


def _nodes(letter: str, value: object) -> tuple[float, ...]:
    fits = isinstance(value, list) and 0 < len(value) <= MOST_NODES and all(map(_is_number, value))
    if not fits:
        raise GridError(letter, f"expected a list of 1 to {MOST_NODES} angles in degrees")
    nodes = tuple(float(node) for node in value)  # type: ignore[attr-defined]
    rising = all(before < after for before, after in pairwise(nodes))
    if not rising or 0.0 not in nodes:
        raise GridError(letter, "expected rising angles, 0 among them")
    if max(-nodes[0], nodes[-1], nodes[-1] - nodes[0]) > TURN_DEG:
        raise GridError(letter, f"expected angles within {TURN_DEG:g}°")
    return nodes


def _is_table(value: object, count: int) -> bool:
    return (
        isinstance(value, list)
        and len(value) == count
        and all(isinstance(row, list) and len(row) == len(AXES) for row in value)
        and all(_is_number(um) and abs(um) <= FARTHEST_UM for row in value for um in row)
    )


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= float_info.max


def format_grid(grid: Grid) -> list[str]:
    """Write the table ``[grid]``, a line each; `grid_of` reads it back the same."""
    lines = ["", "[grid]"]
    for letter, nodes in zip(AXES, grid.nodes_deg, strict=True):
        if nodes:
            lines.append(f"{letter} = {list(nodes)}")
    if grid.offset_mm:
        rows = ([round(UM_PER_MM * mm, 4) for mm in row] for row in grid.offset_mm)
        lines += [f"{OFFSETS} = [", *(f"    {row}," for row in rows), "]"]
    return lines
