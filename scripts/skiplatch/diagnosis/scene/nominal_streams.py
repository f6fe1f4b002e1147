"""The observables of a campaign as streams: residuals of the nominal chain, stage by stage."""

from collections.abc import Iterator

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.diagnosis.density.law import Law
from skiplatch.diagnosis.density.stream import Stream
from skiplatch.diagnosis.scene.nominal_chain import NominalChain

ROUNDED_US = 1e-3
"""By which a time in s is off that was made from an edge in µs."""


def nominal_streams(chain: NominalChain) -> Iterator[Stream]:
    """Give the streams in which something was recorded, under the law of the nominal chain."""
    streams = (
        _motion(chain),
        _latch(chain, "skip"),
        _latch(chain, "plc"),
        _lattice(chain),
        _position(chain),
        _arrival(chain),
        _deviation(chain, "skip"),
        _deviation(chain, "plc"),
        _report(chain),
    )
    return (stream for stream in streams if stream.rows.any())


def _motion(chain: NominalChain) -> Stream:
    """Edge after the contact that is expected; moves that were timed by their edges tell none."""
    residuals = chain.touches.edge_us - chain.contact.time_us
    law = (0.0, chain.nominal.bench.reference_jitter_us, 0.0, 0.0)
    known = residuals[~np.isnan(residuals)]
    is_told = not chain.is_machine and bool(np.any(np.abs(known) > ROUNDED_US))
    here = np.full(len(chain), is_told)
    return _stream(chain, "motion", "µs", ("motion",), residuals, law, here)


def _latch(chain: NominalChain, path: str) -> Stream:
    """Latch stamp after begin, less what the nominal chain needs at least."""
    expected = chain.pretravel_um / chain.speed + chain.wait_us
    residuals = chain.touches.latch_us - chain.begin_us - expected
    tick = chain.nominal.skip.tick_us
    law = (-tick, chain.mechanics_us, chain.scatter_us, tick)
    rows = (chain.plc == (path == "plc")) & chain.has_stamps
    return _stream(chain, f"latch_{path}", "µs", _until_latch(path), residuals, law, rows)


def _until_latch(path: str) -> tuple[str, ...]:
    """Name the stages of a path up to its latch."""
    return ("motion", "probe", "link", "input", "latch" if path == "skip" else "scan")


def _lattice(chain: NominalChain) -> Stream:
    """PLC stamps off the grid of scans."""
    tick = chain.nominal.skip.tick_us
    law = (-tick / 2.0, tick / 4.0, tick, 0.0)
    rows = chain.plc & chain.has_stamps
    return _stream(chain, "lattice", "µs", ("scan",), chain.off_grid_us, law, rows)


def _position(chain: NominalChain) -> Stream:
    """Latched position less the way since the begin, by the latch's own stamp."""
    tick = chain.nominal.skip.tick_us
    return _beyond_stamp(chain, ("position", "position"), chain.has_stamps, 0.0, tick)


def _arrival(chain: NominalChain) -> Stream:
    """The same by an arrival: how late it is for the latch that the position tells."""
    report = chain.nominal.report
    latest_us = report.latency_us + report.jitter_us - (chain.nominal.arrival_us or 0.0)
    named = "arrival", "report"
    return _beyond_stamp(chain, named, chain.has_arrivals, latest_us, report.jitter_us)


def _beyond_stamp(
    chain: NominalChain, named: tuple[str, str], rows: BoolArray, latest_us: float, width_us: float
) -> Stream:
    """Give a stream by its name and stage, of stamps that are so late at most, and so wide."""
    way = chain.speed * (chain.touches.latch_us - chain.begin_us)
    residuals = chain.touches.deviation_um - way
    resolution = chain.nominal.axis.resolution_um
    sigma = 0.0 if chain.is_machine else chain.speed * chain.nominal.bench.reference_jitter_us
    least = -resolution / 2.0 - chain.speed * latest_us
    law = (least, sigma, chain.speed * width_us, resolution)
    name, stage = named
    return _stream(chain, name, "µm", (stage,), residuals, law, rows)


def _deviation(chain: NominalChain, path: str) -> Stream:
    """Where nothing but the position was recorded: the whole chain in one number."""
    expected = chain.pretravel_um + chain.speed * chain.wait_us
    residuals = chain.touches.deviation_um - expected
    resolution = chain.nominal.axis.resolution_um
    law = (
        -resolution / 2.0,
        chain.speed * chain.mechanics_us,
        chain.speed * chain.scatter_us,
        resolution,
    )
    stages = (*_until_latch(path), "position")
    rows = (chain.plc == (path == "plc")) & ~chain.has_stamps
    return _stream(chain, f"deviation_{path}", "µm", stages, residuals, law, rows)


def _report(chain: NominalChain) -> Stream:
    residuals = chain.touches.report_us - chain.touches.latch_us - chain.nominal.report.latency_us
    law = (0.0, 0.0, chain.nominal.report.jitter_us, chain.nominal.skip.tick_us)
    everywhere = np.full(len(chain), fill_value=True)
    return _stream(chain, "report", "µs", ("report",), residuals, law, everywhere)


def _stream(
    chain: NominalChain,
    name: str,
    unit: str,
    stages: tuple[str, ...],
    residuals: FloatArray,
    law: tuple[float | FloatArray, ...],
    rows: BoolArray,
) -> Stream:
    known = rows & ~np.isnan(residuals) & ~chain.false
    offset, sigma, box_a, box_b = (np.full(len(chain), value, dtype=float) for value in law)
    full_law = Law(offset, sigma, box_a, box_b)
    values = np.where(np.isnan(residuals), 0.0, residuals)
    return Stream(name, unit, stages, values, full_law, known, full_law)
