"""How far an effect moves what is recorded, in units of the spread that the engineer expects."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tests.withheld.chain import BoolArray, FloatArray, Hook, Outcomes, Setup, Step, play
from tests.withheld.forms import Form

PLAYS = 16
OBSERVABLES = ("latch_us", "report_us", "deviation_um")


@dataclass(frozen=True)
class Size:
    """The size of one effect alone, in one observable, on one input path.

    Attributes:
        shift: Root mean square over the touches of how far the mean moves.
        scatter: Root of how much the variance changes, mean over the touches.
    """

    observable: str
    path: str
    shift: float
    scatter: float

    @property
    def visible(self) -> float:
        """One number for both: a change of scatter is harder to see than a shift."""
        return max(self.shift, 0.4 * self.scatter)


@dataclass(frozen=True)
class Sizes:
    """All about the size of one effect.

    Attributes:
        sizes: By observable and path.
        missed: The share of touches that it loses.
        off_grid: Root mean square distance of the PLC's stamps from the grid of its scans, in
            ticks; 0 without stamps.
        visible: One number, over the recorded observables only; 1 is a spread.
    """

    sizes: Sequence[Size]
    missed: float
    off_grid: float
    visible: float


def spreads(setup: Setup) -> Mapping[str, FloatArray]:
    """Nominal standard deviations by observable, shape (n,), not knowing the scan's phase."""
    nominal, speed = setup.nominal, setup.feed_um_us
    waiting = setup.touches.on_plc * nominal.plc.scan_us + setup.touches.on_skip * (
        nominal.skip.jitter_us
    )
    mechanics = nominal.probe.repeatability_um**2
    tick = nominal.skip.tick_us**2 / 12
    latch = waiting**2 / 12 + tick + nominal.bench.reference_jitter_us**2 + mechanics / speed**2
    deviation = (speed * waiting) ** 2 / 12 + mechanics + nominal.axis.resolution_um**2 / 12
    report = np.full(len(speed), nominal.report.jitter_us**2 / 12 + tick)
    return {
        "latch_us": np.sqrt(latch),
        "report_us": np.sqrt(report),
        "deviation_um": np.sqrt(deviation),
    }


def replicates(
    setup: Setup,
    hooks: Sequence[Mapping[Step, Hook]],
    rng: np.random.Generator,
    plays: int,
    *,
    any_phase: bool = False,
) -> dict[str, FloatArray]:
    """Play again and again: each observable, shape (plays, n), NaN where missed.

    The scans have the setup's phase, or in every play another one, as for somebody who knows the
    rig and not when its PLC was switched on.
    """

    def once() -> Outcomes:
        phase = rng.uniform(0.0, setup.nominal.plc.scan_us)
        rig = replace(setup, scan_phase_us=phase) if any_phase else setup
        return play(rig, hooks, rng)[0]

    played = [once() for _ in range(plays)]
    return {name: np.stack([getattr(one, name) for one in played]) for name in OBSERVABLES}


def measure(
    form: Form,
    setup: Setup,
    recorded: Collection[str],
    on_paths: Collection[str],
    rng: np.random.Generator,
) -> Sizes:
    """Compare plays with one effect to plays without.

    Without stamps nobody can follow the PLC's waiting from touch to touch, so that what an effect
    on both paths does to it does not count as visible.
    """
    with_it = replicates(setup, [form.hooks], rng, PLAYS)
    without = replicates(setup, [], rng, PLAYS)
    for plays in (with_it, without):  # a report counts from its own stamp
        plays["report_us"] = plays["report_us"] - plays["latch_us"]
    spread = spreads(setup)
    paths = {"skip": setup.touches.on_skip, "plc": setup.touches.on_plc}
    sizes = [
        _size(with_it[name], without[name], spread[name], name, path, rows)
        for name in OBSERVABLES
        for path, rows in paths.items()
        if rows.any()
    ]
    missed = float(np.isnan(with_it["deviation_um"]).mean())
    off_grid = 0.0
    if "latch_us" in recorded:
        off_grid = _off_grid(with_it["latch_us"], setup) - _off_grid(without["latch_us"], setup)
    counted = on_paths if "latch_us" in recorded or "skip" not in on_paths else ("skip",)
    seen = [size.visible for size in sizes if size.observable in recorded and size.path in counted]
    visible = max([*seen, 5 * missed, 0.1 * off_grid, form.own_size])
    return Sizes(sizes, missed, off_grid, visible)


def _size(
    with_it: FloatArray,
    without: FloatArray,
    spread: FloatArray,
    observable: str,
    path: str,
    rows: BoolArray,
) -> Size:
    """Take the noise of the means out of the shift."""
    seen = rows & (np.count_nonzero(~np.isnan(with_it), axis=0) > 1)
    if not seen.any():
        return Size(observable, path, 0.0, 0.0)
    a, b, unit = with_it[:, seen], without[:, seen], spread[seen]
    counts = np.count_nonzero(~np.isnan(a), axis=0)
    variance_a, variance_b = np.nanvar(a, axis=0, ddof=1), np.nanvar(b, axis=0, ddof=1)
    shift = np.nanmean(a, axis=0) - np.nanmean(b, axis=0)
    squared = (shift**2 - variance_a / counts - variance_b / len(b)) / unit**2
    scatter = (variance_a - variance_b) / unit**2
    return Size(
        observable,
        path,
        shift=float(np.sqrt(max(np.mean(squared), 0.0))),
        scatter=float(np.sqrt(abs(np.mean(scatter)))),
    )


def _off_grid(latch_us: FloatArray, setup: Setup) -> float:
    period = setup.nominal.plc.scan_us
    stamps = latch_us[:, setup.touches.on_plc]
    off = (stamps - setup.scan_phase_us + period / 2) % period - period / 2
    return float(np.sqrt(np.nanmean(off**2))) / setup.nominal.skip.tick_us if off.size else 0.0
