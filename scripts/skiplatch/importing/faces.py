"""Coordinates beside which a table says where the face is: how far each touch is off that place."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skiplatch.campaign import Axis, Status
from skiplatch.importing.mapped import COORDINATE
from skiplatch.importing.model import Imported
from skiplatch.importing.placing import SAME_SURFACE_MM
from skiplatch.units import UM_PER_MM

PLACE = "position_mm"


def are_faces(found: Imported, columns: dict[str, NDArray[Any]], axis: Axis) -> bool:
    """Tell whether the positions beside coordinates are those of the faces; if not, say so.

    Args:
        found: Is told.
        columns: Of the table, coordinates and positions in mm; shape (n,) each.
        axis: That probed, where no column says it.
    """
    if PLACE not in columns or (columns.get("axis", np.array(axis)) >= Axis.A).any():
        return False
    latched = ~np.isnan(columns[COORDINATE])
    off_mm = np.abs(columns[COORDINATE] - columns[PLACE])[latched]
    if off_mm.size and float(np.median(off_mm)) <= SAME_SURFACE_MM:
        return True
    why = "not every touch has one"
    if not np.isnan(off_mm).any():
        why = f"half of the touches are more than {SAME_SURFACE_MM:g} mm off it"
    found.assumed.append(
        f"position_mm tells surfaces apart, not where they are, as {why}: each is held against "
        "its own middle"
    )
    return False


def put_deviations(found: Imported, columns: dict[str, NDArray[Any]]) -> None:
    """Put deviations in µm from the faces, along the approach, in place of coordinates in mm."""
    beyond = columns.pop(COORDINATE) - columns[PLACE]
    sense = columns.get("sign", np.ones(len(beyond)))
    columns["deviation_um"] = np.where(sense < 0.0, -beyond, beyond) * UM_PER_MM
    columns.setdefault("status", np.where(np.isnan(beyond), Status.MISSED, Status.OK))
    found.known.append(
        "where each face is: deviations are coordinate_mm - position_mm, along the approach"
    )
    if "sign" not in columns:
        found.assume("the positive sense, as no column says which it was", "--sign")
