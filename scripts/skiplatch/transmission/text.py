"""A measured transmission error as text and as a JSON document."""

from collections.abc import Mapping

from skiplatch.tables import compact, number, table, whole
from skiplatch.transmission.firmware import INPUT, OUTPUT
from skiplatch.transmission.measure import Chain, Measurement
from skiplatch.transmission.train import GearTrain

SHOWN_ORDERS = 12
ARCSEC_PER_TURN = 1_296_000.0
LIMITS = {
    "subdivided": "any ratio and phase; the clock is the quantum",
    "direct": "quantum of a whole line of the denser train",
    "phase-subdivided": "any ratio and phase; may change by less than half a line a point",
    "phase-digital": "one frequency after dividers; range one period; speed ripple shows",
    "phase-analog": "the same, behind a meter that averages over its time constant",
}
"""What the document says of each method; see docs/TRANSMISSION.md."""


def as_text(name: str, method: str, found: Measurement, train: GearTrain | None) -> str:
    """Tell a measurement."""
    values = found.values
    rows = [
        ("total F'i", number(values.total_arcsec)),
        ("tooth to tooth f'i", number(values.tooth_to_tooth_arcsec)),
        ("long wave f'l", number(values.long_wave_arcsec)),
        ("short wave f'k", number(values.short_wave_arcsec)),
        ("noise (rms)", number(values.noise_arcsec)),
        ("drift a turn", number(values.drift_arcsec_per_turn)),
    ]
    if found.backlash is not None:
        rows.append(("backlash", number(found.backlash.mean_arcsec)))
    parts = [
        f"{name}: {whole(values.points)} points over {compact(values.turns)} turns of the output, "
        f"{method}",
        table(("", "arcsec"), rows),
        _orders_text(found, train),
        f"missing pulses {_missing(found)}, extra pulses {_extra(found)}",
    ]
    return "\n\n".join(part for part in parts if part)


def _orders_text(found: Measurement, train: GearTrain | None) -> str:
    shown = found.values.orders[:SHOWN_ORDERS]
    if not shown:
        return "No order stands out of the noise."
    header = ("order per turn", "arcsec", "phase, deg") + (("part",) if train else ())
    rows = [
        (
            compact(order.order, 7),
            number(order.amplitude_arcsec),
            f"{order.phase_deg:.1f}",
            *((train.named(order) or "—",) if train else ()),
        )
        for order in shown
    ]
    more = len(found.values.orders) - len(shown)
    return table(header, rows) + (f"\n… and {more} smaller ones" if more else "")


def as_json(method: str, found: Measurement, train: GearTrain | None) -> dict[str, object]:
    """Give the document of ``--json``."""
    values = found.values
    orders = [
        {
            "order": order.order,
            "amplitude_arcsec": order.amplitude_arcsec,
            "phase_deg": order.phase_deg,
            **({"part": train.named(order)} if train is not None else {}),
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
        "backlash_arcsec": found.backlash.mean_arcsec if found.backlash is not None else None,
        "missing_pulses": _missing(found),
        "extra_pulses": _extra(found),
        "slips": sum(counters.slips for counters in found.counters.values()),
    }


def methods_text(name: str, chain: Chain, results: Mapping[str, Measurement]) -> str:
    """Put the methods side by side."""
    header = ("method", "points", "quantum ″", "total ″", "noise ″", "largest order", "limit")
    rows = []
    for method, found in results.items():
        largest = found.values.orders[0] if found.values.orders else None
        rows.append(
            (
                method,
                whole(found.values.points),
                number(_quantum(method, chain)) if _quantum(method, chain) else "—",
                number(found.values.total_arcsec),
                number(found.values.noise_arcsec),
                f"{compact(largest.order, 6)}: {number(largest.amplitude_arcsec)}″"
                if largest
                else "—",
                LIMITS[method],
            )
        )
    return f"{name}\n\n{table(header, rows)}"


def methods_json(chain: Chain, results: Mapping[str, Measurement]) -> dict[str, object]:
    """Give the same as a JSON document."""
    methods = [
        {
            **as_json(method, found, None),
            "quantum_arcsec": _quantum(method, chain),
            "limit": LIMITS[method],
        }
        for method, found in results.items()
    ]
    return {"format": "skiplatch-transmission-methods/1", "methods": methods}


def _quantum(method: str, chain: Chain) -> float | None:
    """A line of the denser train at the output, where whole lines are counted."""
    if method != "direct":
        return None
    return ARCSEC_PER_TURN / max(float(chain.lines1 * chain.ratio), float(chain.lines2))


def _missing(found: Measurement) -> int:
    return sum(found.counters[channel].missing for channel in (INPUT, OUTPUT))


def _extra(found: Measurement) -> int:
    return sum(found.counters[channel].extra for channel in (INPUT, OUTPUT))
