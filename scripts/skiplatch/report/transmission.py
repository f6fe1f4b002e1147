"""A transmission error as one page of HTML: no script, nothing from elsewhere, light and dark."""

from skiplatch.figures.transmission import draw_orders, draw_turn
from skiplatch.report.layout import Table, render
from skiplatch.tables import compact, number
from skiplatch.transmission.measure import Chain, Measurement
from skiplatch.transmission.text import orders_table, size_rows
from skiplatch.transmission.train import GearTrain

TEMPLATE = "transmission.html"


def as_html(
    name: str, method: str, chain: Chain, found: Measurement, train: GearTrain | None
) -> str:
    """Lay out a measurement.

    Args:
        name: What the file of pulses is called.
        method: How the trains were compared.
        chain: The encoders and the ratio.
        found: What came of it.
        train: The gears, if they are described.
    """
    values = found.values
    header, rows = orders_table(found, train)
    drawings = [draw_turn(values)]
    if values.orders:
        drawings.append(draw_orders(values))
    return render(
        TEMPLATE,
        name=name,
        method=method,
        chain=chain,
        turns=compact(values.turns),
        headline=f"Transmission error {number(values.total_arcsec)}″ peak to peak",
        lead=_lead(found, train),
        warnings=found.limits.warnings,
        drawings=drawings,
        sizes=Table(("value", "arcsec"), size_rows(found)),
        orders=Table(header, rows),
        pulses=_pulses(found),
    )


def _lead(found: Measurement, train: GearTrain | None) -> str:
    orders = found.values.orders
    if not orders:
        return "No order stands out of the noise."
    part = train.named(orders[0].order) if train is not None else None
    whose = f" ({part})" if part else ""
    return (
        f"The largest order is {compact(orders[0].order, 6)} a turn of the output{whose}, "
        f"{number(orders[0].amplitude_arcsec)}″."
    )


def _pulses(found: Measurement) -> Table:
    rows = [
        (
            name,
            str(counters.pulses),
            str(counters.missing),
            str(counters.extra),
            str(counters.slips),
        )
        for name, counters in zip(("input", "output"), found.counters.values(), strict=True)
    ]
    return Table(("train", "pulses", "missing", "extra", "slips"), rows)
