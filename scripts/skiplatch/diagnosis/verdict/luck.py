"""Whether plays of effects score on each other as they do on the record: then that is luck."""

from collections.abc import Iterable, Sequence

from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.verdict.cell_scores import Cell

ADDED = 1.2
"""Times the noise floor of the believed rig, from which on effects add scatter."""
HIDES_A_GAP = 0.1
"""Share of what the believed rig scores, beyond which a noise floor hides a gap."""
AS_LOW = 0.1
"""Share of the noise floor that tells no score from another: what comes seldom may not have come,
and what is left is little beside that floor."""


def is_no_luck(cells: Sequence[Cell], least: float) -> bool:
    """Tell whether effects score worse than on all of their own plays, beside no effect.

    What comes now and then may not have come, and a rounded value fall as it likes.
    """
    lost = ([cell.lost_beside(k) for cell in cells] for k in _lots(cells))
    return all(by_luck < own for own, by_luck in (_both(cells, least, one) for one in lost))


def may_be_luck(cells: Sequence[Cell], least: float) -> bool:
    """Tell whether any play of the effects scores as badly beside the others as the record does.

    What all touches of a run share, as where in a tick its scans begin, is drawn once for each.
    """
    scored = ([cell.beside(k) for cell in cells] for k in _lots(cells))
    return any(by_luck >= own for own, by_luck in (_both(cells, least, one) for one in scored))


def tightness(cells: Sequence[Cell], least: float) -> float:
    """Give what the effects score over their noise floor; 1 if any of their plays scores as low.

    What comes now and then may not have come. A floor of no more than rounding is none to be below.
    Effects answer for the scatter that they add: a rig that is calmer than believed is no fault.
    Nor is scatter that is little beside a gap: what is gone of that is not gone for it.
    """
    seen, floor, believed, before = (
        _in_units(cells, least, scores)
        for scores in (
            [c.after.scores for c in cells],
            [c.after.floor for c in cells],
            [c.before.floor for c in cells],
            [c.before.scores for c in cells],
        )
    )
    if floor <= max(ADDED * believed, HIDES_A_GAP * before):
        return 1.0
    scored = ([cell.beside(k) for cell in cells] for k in _lots(cells))
    for own, by_luck in (_both(cells, least, one) for one in scored):
        if by_luck <= own + AS_LOW * floor:
            return 1.0
    return 1.0 + (seen - floor) / sum(len(cell.after.floor) for cell in cells)


def _both(
    cells: Sequence[Cell], least: float, scores: Sequence[tuple[FloatArray, FloatArray]]
) -> tuple[float, float]:
    """Sum up what the record and a play of each cell score."""
    recorded, played = (_in_units(cells, least, each) for each in zip(*scores, strict=True))
    return recorded, played


def _lots(cells: Sequence[Cell]) -> range:
    """Number the plays of the effects, each of which stands for what might have been recorded."""
    return range(len(cells[0].ensembles[1].plays) if len(cells[0].ensembles) > 1 else 0)


def _in_units(cells: Sequence[Cell], least: float, scores: Iterable[FloatArray]) -> float:
    """Sum up scores of each cell's touches in units of its noise floor."""
    return sum(float(s.sum()) / cell.unit(least) for s, cell in zip(scores, cells, strict=True))
