"""A measured transmission error as text and as a JSON document."""

from collections.abc import Mapping

from skiplatch.tables import NOTHING, compact, number, table, whole
from skiplatch.transmission.firmware import INPUT, OUTPUT
from skiplatch.transmission.limits import ARCSEC_PER_TURN
from skiplatch.transmission.measure import NAMES, Chain, Measurement, NotMeasurableError
from skiplatch.transmission.train import GearTrain

SHOWN_ORDERS = 12


def as_text(name: str, method: str, found: Measurement, train: GearTrain | None) -> str:
    """Tell a measurement."""
    values = found.values
    turns = f"{whole(values.points)} points over {compact(values.turns)} turns of the output"
    parts = [
        f"{name}: {turns}, {method}",
        table(("", "arcsec"), size_rows(found)),
        _orders_text(found, train),
        f"missing pulses {_missing(found)}, extra pulses {_extra(found)}, slips {_slips(found)}",
        "\n".join(f"Warning: {each}." for each in found.limits.warnings),
    ]
    return "\n\n".join(part for part in parts if part)


def size_rows(found: Measurement) -> list[tuple[str, str]]:
    """Give the rows of the table of values."""
    values = found.values
    rows = [
        ("total F'i", number(values.total_arcsec)),
        ("tooth to tooth f'i", number(values.tooth_to_tooth_arcsec)),
        ("long wave f'l", number(values.long_wave_arcsec)),
        ("short wave f'k", number(values.short_wave_arcsec)),
        ("noise (rms)", number(values.noise_arcsec)),
        ("drift a turn", number(values.drift_arcsec_per_turn, 2)),
    ]
    if values.trend_arcsec > 0.0:
        rows.append(("trend (peak to peak)", number(values.trend_arcsec)))
    if found.backlash is not None:
        rows.append(("backlash", number(found.backlash.mean_arcsec)))
    return rows


def orders_table(
    found: Measurement, train: GearTrain | None
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Give header and rows of the largest orders, with their parts if the train is described."""
    header = ("order per turn", "arcsec", "phase, deg") + (("part",) if train else ())
    rows = [
        (
            compact(order.order, 7),
            number(order.amplitude_arcsec),
            f"{order.phase_deg:.1f}",
            *((train.named(order.order) or NOTHING,) if train else ()),
        )
        for order in found.values.orders[:SHOWN_ORDERS]
    ]
    return header, rows


def _orders_text(found: Measurement, train: GearTrain | None) -> str:
    header, rows = orders_table(found, train)
    if not rows:
        return "No order stands out of the noise."
    more = len(found.values.orders) - len(rows)
    return table(header, rows) + (f"\n… and {more} smaller ones" if more else "")


def as_json(method: str, found: Measurement, train: GearTrain | None) -> dict[str, object]:
    """Give the document of ``--json``."""
    values = found.values
    orders = [
        {
            "order": order.order,
            "amplitude_arcsec": order.amplitude_arcsec,
            "phase_deg": order.phase_deg,
            **({"part": train.named(order.order)} if train is not None else {}),
        }
        for order in values.orders
    ]
    return {
        "format": "skiplatch-transmission/1",
        "method": method,
        "points": values.points,
        "turns": values.turns,
        "total_arcsec": values.total_arcsec,
        "tooth_to_tooth_arcsec": values.tooth_to_tooth_arcsec,
        "tooth_pitch_deg": 360.0 * values.tooth_pitch_turns,
        "long_wave_arcsec": values.long_wave_arcsec,
        "short_wave_arcsec": values.short_wave_arcsec,
        "drift_arcsec_per_turn": values.drift_arcsec_per_turn,
        "orders": orders,
        "noise_arcsec": values.noise_arcsec,
        "trend_arcsec": values.trend_arcsec,
        "limits": found.limits.numbers,
        "warnings": list(found.limits.warnings),
        "backlash_arcsec": found.backlash.mean_arcsec if found.backlash is not None else None,
        "mark_widths": {name: found.mark_widths[channel] for channel, name in NAMES.items()},
        "missing_pulses": _missing(found),
        "extra_pulses": _extra(found),
        "slips": _slips(found),
    }


def methods_text(
    name: str, chain: Chain, results: Mapping[str, Measurement | NotMeasurableError]
) -> str:
    """Put the methods side by side."""
    header = ("method", "points", "total ″", "noise ″", "largest order", "limit")
    rows = [_method_row(method, chain, found) for method, found in results.items()]
    return f"{name}\n\n{table(header, rows)}"


def _method_row(
    method: str, chain: Chain, found: Measurement | NotMeasurableError
) -> tuple[str, ...]:
    if isinstance(found, NotMeasurableError):
        return (method, *([NOTHING] * 4), found.message)
    values = found.values
    largest = values.orders[0] if values.orders else None
    return (
        method,
        whole(values.points),
        number(values.total_arcsec),
        number(values.noise_arcsec),
        f"{compact(largest.order, 6)}: {number(largest.amplitude_arcsec)}″" if largest else "—",
        _limit(method, chain),
    )


def methods_json(
    chain: Chain, results: Mapping[str, Measurement | NotMeasurableError]
) -> dict[str, object]:
    """Give the same as a JSON document."""
    methods = [
        {
            **_method_json(method, found),
            "quantum_arcsec": chain.line_arcsec if method == "direct" else None,
            "limit": _limit(method, chain),
        }
        for method, found in results.items()
    ]
    return {"format": "skiplatch-transmission-methods/1", "methods": methods}


def _method_json(method: str, found: Measurement | NotMeasurableError) -> dict[str, object]:
    if isinstance(found, NotMeasurableError):
        return {"method": method, "fault": found.message}
    return as_json(method, found, None)


def _limit(method: str, chain: Chain) -> str:
    """Say the limit that the document states of a method, for this chain."""
    quantum = number(chain.line_arcsec)
    divided = chain.lines1 * chain.ratio / chain.lines2
    period = ARCSEC_PER_TURN * divided.denominator / chain.lines2
    by = f"one frequency only: divided by {divided.numerator} and {divided.denominator}"
    return {
        "subdivided": "any ratio, any phase; the clock is the quantum",
        "direct": f"quantum of a line, {quantum}″",
        "phase-subdivided": f"any ratio; may change by less than {quantum}″/2 a point",
        "phase-digital": f"{by}; range below 2π, {number(period)}″ a period; speed ripple shows",
        "phase-analog": f"{by}, far faster than its meter of {compact(1e3 * chain.meter_s)} ms",
    }[method]


def _missing(found: Measurement) -> int:
    return sum(found.counters[channel].missing for channel in (INPUT, OUTPUT))


def _extra(found: Measurement) -> int:
    return sum(found.counters[channel].extra for channel in (INPUT, OUTPUT))


def _slips(found: Measurement) -> int:
    return sum(found.counters[channel].slips for channel in (INPUT, OUTPUT))
