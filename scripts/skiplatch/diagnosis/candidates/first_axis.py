"""Parameters of one axis beside those of the first one."""

from skiplatch.campaign import LINEAR_AXES, Axis, Touches

OF_AN_AXIS = {
    "y_excess_ratio": Axis.Y,
    "y_ahead_deg": Axis.Y,
    "z_excess_ratio": Axis.Z,
    "z_ahead_deg": Axis.Z,
}
"""Parameters that say what an axis has more than X."""
OF_FIRST = {
    "scale_error": ("scale_ppm",),
    "thermal_drift": ("drift_um_k", "expansion_ppm_k"),
    "transmission_error": ("amplitude_um", "amplitude2_um", "amplitude3_um"),
    "backlash": ("backlash_um", "positive_um"),
    "following_error": ("lag_us",),
}
"""Sizes by effect that are those of X, and that others have so many times more of."""
RATIOS = ("y_excess_ratio", "z_excess_ratio")
"""Parameters that tell what Y and Z have more than X."""
MOST_OVER = 1000.0
"""Times another axis' error may be that of X: about as many as in the table of effects."""
NOTHING_BESIDE = 2.0
"""Times the least share of another axis' error that X then has, which is nothing beside it."""


def within_ratio(effect_id: str, parameters: dict[str, float]) -> dict[str, float]:
    """Give X an error that others have no more of than may be; it is as good as none."""
    sizes = OF_FIRST.get(effect_id, ())
    over = max((abs(parameters[name]) for name in RATIOS if name in parameters), default=0.0)
    if not sizes or over < MOST_OVER:
        return parameters
    less = NOTHING_BESIDE * over / MOST_OVER
    ratios = {name: (1.0 + parameters[name]) / less - 1.0 for name in RATIOS if name in parameters}
    return parameters | {name: less * parameters[name] for name in sizes} | ratios


def first_axis(touches: Touches) -> Axis:
    """Give the axis that others are held against: X, or without it the first that moves."""
    moved = set(touches.axis.tolist())
    return next((axis for axis in LINEAR_AXES if axis in moved), Axis.X)


def first_of_its_own(touches: Touches) -> frozenset[str]:
    """Name the parameters that the first axis would have: what X has would make up for them."""
    first = first_axis(touches)
    return frozenset(name for name, axis in OF_AN_AXIS.items() if axis == first)
