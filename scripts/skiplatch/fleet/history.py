"""What a store knows of each rig over time: one entry a campaign, in the order of time."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from skiplatch.fleet.reading import Reader
from skiplatch.fleet.turned import turned_unit
from skiplatch.former_names import present_name
from skiplatch.ways import ARCSEC, LENGTH, Ways

ENTRIES = """
SELECT rig, campaign, recorded_at AS time, folder, kind, touches, verdict, stage, gap_um,
    gap_arcsec, coalesce(axes, 'linear') AS axes, gaps, effects
FROM campaigns ORDER BY rig, recorded_at, campaign
"""


@dataclass(frozen=True, slots=True)
class Gap:
    """The gap of an observable in a campaign, and what remains of it if nothing is wrong.

    Both in the unit.
    """

    observable: str
    unit: str
    before: float
    noise_floor: float


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of an effect that a diagnosis named, with its 95 % interval.

    Its name ends in its unit; `turned` is that of the same numbers where axes turn, else empty.
    """

    effect: str
    stage: str
    name: str
    value: float
    low: float
    high: float
    turned: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """Effect and parameter."""
        return self.effect, self.name


@dataclass(frozen=True, slots=True)
class Entry:
    """A campaign of a rig.

    Attributes:
        campaign: Its key.
        time: When it was recorded, UTC.
        folder: Its name.
        kind: Of its rig.
        touches: Their number.
        verdict: Of its diagnosis; None without one.
        stage: Where the first effect acts, or where the first difference shows.
        gap_um: The largest gap of an observable in µm; None where all axes turn.
        gaps: By observable.
        parameters: Of the effects that were named.
        gap_arcsec: The largest gap where all axes turn.
        axes: What they do; a value of `Ways`.
    """

    campaign: str
    time: datetime
    folder: str
    kind: str
    touches: int
    verdict: str | None
    stage: str | None
    gap_um: float | None
    gaps: dict[str, Gap]
    parameters: list[Parameter]
    gap_arcsec: float | None = None
    axes: str = Ways.LINEAR.value

    @property
    def gap(self) -> tuple[float, str] | None:
        """The largest gap of a length or an angle, with its unit."""
        if self.gap_arcsec is not None:
            return self.gap_arcsec, ARCSEC
        return None if self.gap_um is None else Ways(self.axes).told(self.gap_um, LENGTH)


History = dict[str, list[Entry]]
"""Entries of each rig."""


def read_history(reader: Reader) -> History:
    """Give all campaigns of a store by rig.

    Raises:
        InputError: The index is damaged.
    """
    found: History = {}
    for row in reader.query(ENTRIES).mappings():
        rig, gaps, effects = row.pop("rig"), row.pop("gaps"), row.pop("effects")
        known = {
            gap["observable"]: Gap(
                gap["observable"], gap["unit"], gap["before"], gap["noise_floor"]
            )
            for gap in gaps or ()
        }
        parameters = [_parameter(effect, row["axes"]) for effect in effects or ()]
        found.setdefault(rig, []).append(Entry(**row, gaps=known, parameters=parameters))
    return found


def _parameter(row: dict[str, Any], axes: str) -> Parameter:
    """Read a row that an older version may have stored."""
    name = present_name(row["parameter"])
    return Parameter(
        effect=row["effect"],
        stage=row["stage"],
        name=name,
        value=row["value"],
        low=row["low"],
        high=row["high"],
        turned=turned_unit(row["effect"], name, axes),
    )
