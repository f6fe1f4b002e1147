"""Recorded conditions, played anew with effects that are known."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from skiplatch.arrays import FloatArray
from skiplatch.campaign import TOUCHES_FILE, Campaign, Kind, Status, read_campaign
from skiplatch.diagnosis.candidates.simulated import catalogue
from skiplatch.simulator.effects import Effect
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
MACHINE = SAMPLES / "machine_no_gap"
"""Positions alone."""
BENCH = Path(__file__).parent / "data" / "bench_no_gap"
"""Edges, stamps and reports."""
LATE_BENCH = SAMPLES / "bench_isr_latency"


def stamped_machine() -> Campaign:
    """The bench's touches as a machine that records no edges makes them."""
    bench = read_campaign(BENCH)
    touches = replace(bench.touches, edge_us=np.full(len(bench.touches), np.nan))
    return replace(bench, nominal=replace(bench.nominal, kind=Kind.MACHINE), touches=touches)


def values_of(effect: Effect) -> FloatArray:
    """Parameters of an effect as its candidate takes them, 0 where it has none; shape (p,)."""
    names = catalogue()[effect.id].names
    return np.array([effect.parameters.get(name, 0.0) for name in names])


def played(folder: Path, *switched_on: Effect, seed: int = 11) -> Campaign:
    """The simulation with effects in place of what was recorded, in the same columns."""
    return played_again(read_campaign(folder), *switched_on, seed=seed)


def played_again(campaign: Campaign, *switched_on: Effect, seed: int = 11) -> Campaign:
    """The same of a campaign at hand."""
    touches = campaign.touches
    controller = Controller.for_campaign(campaign.nominal, touches)
    outcomes = play(campaign.nominal, controller, touches, seed=seed, switched_on=switched_on)
    columns = {
        name: np.where(np.isnan(getattr(touches, name)), np.nan, getattr(outcomes, name)[0])
        for name in ("edge_us", "latch_us", "report_us", "deviation_um")
    }
    status = np.where(outcomes.ok[0], Status.OK, Status.MISSED).astype(np.int8)
    return replace(campaign, touches=replace(touches, status=status, **columns))


def few_of(folder: Path) -> None:
    """Keep every eighth touch of a campaign's folder: enough where any diagnosis will do."""
    path = folder / TOUCHES_FILE
    head, *rows = path.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join([head, *rows[::8]]), encoding="utf-8")


def thinned(campaign: Campaign, one_of: int = 2) -> Campaign:
    """Every second touch, or fewer: what is plain in these is found in a part of the time."""
    some = campaign.touches.select(np.arange(0, len(campaign.touches), one_of))
    return replace(campaign, touches=some)
