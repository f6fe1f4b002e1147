"""What the generator sealed, opened by the scorer alone, after all is diagnosed."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign import Nominal, Touches, read_nominal, read_touches
from tests.withheld.chain import FloatArray
from tests.withheld.effects import EFFECTS
from tests.withheld.streams import Expected, Played, begin_us, residuals

LABEL = "label.json"


@dataclass(frozen=True, eq=False)
class Label:
    """What a campaign really has; the fields are those of the generator's label."""

    case: str
    recording: str
    effects: tuple[str, ...]
    visible: Mapping[str, float]
    """By effect: its size in units of the spread that the engineer expects."""
    not_recorded: frozenset[str]
    touches: int
    scan_phase_us: float
    verdict: str = ""
    """What a diagnosis should say."""
    parts: tuple[str, ...] = ()
    """All that is the matter with it, in words."""
    outliers: frozenset[int] = frozenset()
    """Serial numbers of touches that are grossly off."""
    plain_outliers: frozenset[int] = frozenset()
    """Those of them that nobody can overlook."""

    @classmethod
    def read(cls, path: Path) -> "Label":
        """Read a sealed label."""
        label: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return cls(
            case=label["case"],
            recording=label["recording"],
            effects=tuple(label["effects"]),
            visible={part["id"]: float(part["visible"]) for part in label["parts"]},
            not_recorded=frozenset(label["not_recorded"]),
            touches=label["touches"],
            scan_phase_us=label["scan_phase_us"],
            verdict=label["verdict"],
            parts=_in_words(label),
            outliers=frozenset(one["touch"] for one in label["outliers"]),
            plain_outliers=frozenset(one["touch"] for one in label["outliers"] if one["plain"]),
        )

    @property
    def streams(self) -> tuple[str, ...]:
        """Residuals that what was recorded allows to look at."""
        if "latch_us" in self.not_recorded:
            return ("deviation",)
        stamped = ("deviation", "latch", "position")
        return stamped if "report_us" in self.not_recorded else (*stamped, "report")

    @property
    def stages(self) -> set[str]:
        """Where its effects lie."""
        return {EFFECTS[effect].stage for effect in self.effects}


def _in_words(label: Mapping[str, Any]) -> tuple[str, ...]:
    parts = [f"{p['id']}, {p['form']}: {p['parameters']}" for p in label["parts"]]
    beliefs = [f"{name} is {b['true']:.6g}" for name, b in label["beliefs_off"].items()]
    return (*parts, *beliefs)


@dataclass(frozen=True, eq=False)
class HeldBack:
    """The touches that were held back: what became of them, and plays of the truth and of nothing.

    Attributes:
        nominal: The rig as it is, but for its effects.
        touches: The touches with their true outcomes, all columns, shape (n,).
        oracle: Plays of the truth, shape (replicates, n).
        unchanged: Plays of the rig without its effects, likewise.
        oracle_any_phase: Plays of the truth by somebody who does not know the phase of the scans.
        unchanged_any_phase: Plays of the unchanged chain, likewise.
        recorded: Streams that the campaign allows to look at.
        scan_phase_us: When scan 0 starts.
    """

    nominal: Nominal
    touches: Touches
    oracle: Played
    unchanged: Played
    oracle_any_phase: Played
    unchanged_any_phase: Played
    recorded: tuple[str, ...]
    scan_phase_us: float

    @classmethod
    def read(cls, sealed: Path) -> "HeldBack":
        """Open the seals of one campaign."""
        label = Label.read(sealed / LABEL)
        return cls(
            nominal=read_nominal(sealed / "nominal.toml"),
            touches=read_touches(sealed / "truth.csv"),
            oracle=_plays(sealed / "oracle.npz"),
            unchanged=_plays(sealed / "nominal.npz"),
            oracle_any_phase=_plays(sealed / "oracle_any_phase.npz"),
            unchanged_any_phase=_plays(sealed / "nominal_any_phase.npz"),
            recorded=label.streams,
            scan_phase_us=label.scan_phase_us,
        )

    @cached_property
    def expected(self) -> Expected:
        """What the nominal chain expects."""
        return Expected.of(self.nominal, self.touches)

    @cached_property
    def truth(self) -> Mapping[str, FloatArray]:
        """Residuals of what came true, by stream, shape (n,)."""
        begin = begin_us(self.expected, self.touches)
        found = residuals(self.expected, self.touches, begin)
        return {**found, "grid": self._off_grid(self.touches.latch_us)}

    def of(self, played: Played, rng: np.random.Generator) -> Mapping[str, FloatArray]:
        """Residuals of plays, by stream, shape (replicates, n).

        A play on a bench is counted from an edge with the noise of the reference instrument, as
        the recorded one is.
        """
        noise = self.nominal.bench.reference_jitter_us
        begin = self.expected.contact_us + rng.normal(0.0, noise, played.latch_us.shape)
        found = residuals(self.expected, played, begin)
        return {**found, "grid": self._off_grid(played.latch_us)}

    def _off_grid(self, latch_us: FloatArray) -> FloatArray:
        """Distance of stamps from the nearest scan on the believed grid, shape (…, n)."""
        period = self.nominal.plc.scan_us
        middle = (latch_us + self.expected.tick_us / 2 - self.scan_phase_us + period / 2) % period
        return np.asarray(middle - period / 2)


def _plays(path: Path) -> Played:
    with np.load(path) as plays:
        return Played(plays["latch_us"], plays["report_us"], plays["deviation_um"])
