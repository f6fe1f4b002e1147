"""Latch errors and pulse responses in tables and JSON."""

from dataclasses import asdict
from typing import Any

from skiplatch.campaign import InputPath, Nominal
from skiplatch.latch.errors import LatchErrors
from skiplatch.latch.paths import PathResult, Results
from skiplatch.latch.pulses import Pulses
from skiplatch.statistics import Interval
from skiplatch.tables import compact, number, table, whole, with_interval
from skiplatch.units import PER_CENT

TITLES = {InputPath.SKIP: "skip input", InputPath.PLC: "PLC task"}
COLUMNS = ("", "latency, µs", "95 % interval", "position error, µm", "95 % interval")


def as_text(rig: Nominal, feed_mm_min: float, results: Results) -> str:
    """Everything, for the terminal."""
    tables = [_errors_text(path, result.errors) for path, result in results.items()]
    head = f"{_rig_line(rig)}; feed {feed_mm_min:g} mm/min"
    return "\n\n".join([head, *tables, _pulses_text(results)])


def _rig_line(rig: Nominal) -> str:
    """Give the figures of the rig that the inputs depend on."""
    return (
        f"filter {rig.input.filter_us:g} µs; skip latency {rig.skip.latency_us:g} µs + "
        f"U(0, {rig.skip.jitter_us:g} µs); PLC scan {rig.plc.scan_us:g} µs; "
        f"tick {rig.skip.tick_us:g} µs; resolution {rig.axis.resolution_um:g} µm"
    )


def _errors_text(path: InputPath, errors: LatchErrors) -> str:
    """Give the distribution of one path as a table: bias and spread apart."""
    return "\n".join(
        [
            f"{TITLES[path]}, {whole(errors.latency_us.count)} touches",
            table(COLUMNS, _rows(errors)),
            _footnote(errors),
        ]
    )


def _footnote(errors: LatchErrors) -> str:
    latency, position = errors.latency_us.resolution, errors.position_um.resolution
    return (
        "tick and resolution come on top of the formula; quantiles are good to "
        f"{compact(latency)} µs and {compact(position)} µm"
    )


def _rows(errors: LatchErrors) -> list[tuple[str, ...]]:
    both = (errors.latency_us, errors.position_um)
    formulas = [compact(errors.formula_us), "", compact(errors.formula_um), ""]
    return [
        _row("bias    mean", *(summary.mean for summary in both)),
        _row("spread  range", *(summary.range for summary in both)),
        _row("        standard deviation", *(summary.standard_deviation for summary in both)),
        ("        formula T/√12, v·T/√12", *formulas),
        _row("        minimum", *(summary.minimum for summary in both)),
        *(
            _row(f"        {_quantile_name(q)}", *(summary.quantiles[q] for summary in both))
            for q in errors.latency_us.quantiles
        ),
        _row("        maximum", *(summary.maximum for summary in both)),
    ]


def _row(name: str, latency_us: Interval, position_um: Interval) -> tuple[str, ...]:
    return (name, *with_interval(latency_us), *with_interval(position_um))


def _quantile_name(quantile: float) -> str:
    return "median" if quantile == 0.5 else f"{PER_CENT * quantile:g} %"


def _pulses_text(results: Results) -> str:
    """Give the shares of pulses that trigger, a column a path, and the shortest always seen."""
    pulses = next(iter(results.values())).pulses
    header = ["pulse, µs"]
    for path in results:
        header += [f"{TITLES[path]}, %", "95 % interval"]
    rows = [
        [f"{width:g}", *(cell for r in results.values() for cell in _share_cells(r, width))]
        for width in pulses.triggering
    ]
    return "\n".join(
        [
            f"pulses at random times, {whole(pulses.pulses)} of each width: share that triggers",
            table(header, rows),
            *(_shortest_line(path, result.pulses) for path, result in results.items()),
        ]
    )


def _share_cells(result: PathResult, width_us: float) -> tuple[str, str]:
    return with_interval(result.pulses.triggering[width_us].scaled(PER_CENT))


def _shortest_line(path: InputPath, pulses: Pulses) -> str:
    shortest = pulses.shortest
    seen = whole(shortest.pulses)
    return (
        f"{TITLES[path]}: the shortest pulse always seen takes {shortest.pulse_us:.3f} µs "
        f"({seen} of {seen} seen: with 95 % confidence it is missed less "
        f"often than in {number(PER_CENT * shortest.miss_bound, 2)} % of cases)"
    )


def as_json(results: Results) -> dict[str, Any]:
    """Everything, in plain types, by path."""
    return {
        path.name.lower(): asdict(result.errors) | {"pulses": asdict(result.pulses)}
        for path, result in results.items()
    }
