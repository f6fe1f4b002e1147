"""What comes of conditions that were played: columns, data frame, CSV."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign import Touches
from skiplatch.campaign.touches import SerialArray
from skiplatch.dataframes import DataFrame, Library, dataframe
from skiplatch.diagnosis.plays.edges import at_given_edges
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.simulator.playing import Outcomes

OUTCOMES = ("edge_us", "latch_us", "report_us", "deviation_um")


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """Outcomes of n touches, r times; what a missed touch does not have is NaN.

    Attributes:
        touch: Serial numbers; shape (n,).
        edge_us: When the reference instrument sees the edge; bench only; shape (r, n), as below.
        latch_us: The firmware's own time stamp of the latch.
        report_us: When the report arrives.
        deviation_um: Latched minus nominal position along the approach.
        ok: Latched.
    """

    touch: SerialArray
    edge_us: FloatArray
    latch_us: FloatArray
    report_us: FloatArray
    deviation_um: FloatArray
    ok: BoolArray

    @classmethod
    def of(cls, conditions: Touches, outcomes: Outcomes) -> Self:
        """Take an edge that was given for what it is."""
        given = np.where(np.isnan(conditions.edge_us), outcomes.edge_us, conditions.edge_us)
        return cls(
            touch=conditions.touch,
            edge_us=given,
            latch_us=outcomes.latch_us,
            report_us=outcomes.report_us,
            deviation_um=outcomes.deviation_um,
            ok=outcomes.ok,
        )

    def columns(self) -> dict[str, Any]:
        """Give columns of r times n values, the touches of the first replicate first."""
        replicates, touches = self.ok.shape
        return {
            "touch": np.tile(self.touch, replicates),
            "replicate": np.repeat(np.arange(replicates), touches),
            **{name: getattr(self, name).ravel() for name in OUTCOMES},
            "status": np.where(self.ok, "ok", "missed").ravel(),
        }

    def to_dataframe(self, library: Library | None = None) -> DataFrame:
        """Give a row a touch and replicate: the columns of ``skiplatch predict``.

        Raises:
            ImportError: Neither pandas nor polars is installed, or not the one wanted.
        """
        return dataframe(self.columns(), library)

    def csv_lines(self) -> Iterator[str]:
        """Give header and rows as ``skiplatch predict`` writes them."""
        columns = self.columns()
        yield ",".join(columns)
        cells = [
            _cells(values) if name in OUTCOMES else values.tolist()
            for name, values in columns.items()
        ]
        for row in zip(*cells, strict=True):
            yield ",".join(map(str, row))


def predicted(
    rig: Rig,
    recorded: Touches | None,
    conditions: Touches,
    *,
    replicates: int,
    seed: int,
    jobs: int,
) -> Prediction:
    """Play conditions on a rig; where it was recorded, its scans keep the phase of the record.

    Args:
        rig: With its effects.
        recorded: Touches of that rig, or None.
        conditions: Contacts close at `edge_us` where that is given.
        replicates: How often to play.
        seed: Picks the random numbers.
        jobs: Threads; the result does not depend on it.
    """
    given = at_given_edges(rig, conditions)
    if recorded is not None:
        rig = rig.whose_scans_are(recorded, seed=seed)
    outcomes = rig.play(given, seed=seed, replicates=replicates, jobs=jobs, in_phase=True)
    return Prediction.of(conditions, outcomes)


def _cells(values: FloatArray) -> list[str]:
    return ["" if np.isnan(value) else f"{value:.3f}" for value in values]
