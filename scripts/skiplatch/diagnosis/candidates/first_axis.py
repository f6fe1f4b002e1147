"""Parameters of one axis beside those of the first one."""

from skiplatch.campaign import LINEAR_AXES, Axis, Touches

OF_AN_AXIS = {
    "y_excess_ratio": Axis.Y,
    "y_ahead_deg": Axis.Y,
    "z_excess_ratio": Axis.Z,
    "z_ahead_deg": Axis.Z,
}
"""Parameters that say what an axis has more than X."""


def first_axis(touches: Touches) -> Axis:
    """Give the axis that others are held against: X, or without it the first that moves."""
    moved = set(touches.axis.tolist())
    return next((axis for axis in LINEAR_AXES if axis in moved), Axis.X)


def first_of_its_own(touches: Touches) -> frozenset[str]:
    """Name the parameters that the first axis would have: what X has would make up for them."""
    first = first_axis(touches)
    return frozenset(name for name, axis in OF_AN_AXIS.items() if axis == first)
