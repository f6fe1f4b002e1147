"""The unit of an effect's parameter where axes turn: its name ends in that of linear ones."""

from skiplatch.simulator.effects import effects
from skiplatch.ways import Ways


def turned_unit(effect: str, parameter: str, axes: str) -> str:
    """Give the unit in which the numbers of a parameter count, if it is another than its name says.

    Args:
        effect: Its id.
        parameter: Its name.
        axes: What the axes of the campaign do; a value of `Ways`.

    Returns:
        The unit, or nothing where the name says it.
    """
    ways = Ways(axes)
    if ways is Ways.LINEAR:
        return ""  # without a look at the table, which loads the simulation
    described = effects().get(effect)
    known = {one.name: one.unit for one in described.parameters} if described else {}
    unit = known.get(parameter, "")
    turned = ways.unit_of_number(unit)
    return "" if turned == unit else turned
