"""The pictures of a transmission error: over the output turn, and its orders."""

from collections.abc import Sequence

import numpy as np

from skiplatch.figures import colours, theme
from skiplatch.figures.inline import Drawing, drawing, panel
from skiplatch.tables import compact, number
from skiplatch.transmission.spectrum import Order
from skiplatch.transmission.values import Values
from skiplatch.units import DEG_PER_TURN

HEIGHT_IN = 2.6
NAMED_ORDERS = 5
APART = 4.0
"""Smallest factor between two orders that both have their number beside them."""
ROOM = 3.0
"""Above the highest order, for its name; a factor on the logarithmic axis."""


def draw_turn(values: Values) -> Drawing:
    """Draw the error over the first output turn, and the range that all turns fill."""
    curve = values.curve
    degrees = DEG_PER_TURN * curve.turn
    middle = 0.5 * (curve.low_arcsec.min() + curve.high_arcsec.max())
    with panel(HEIGHT_IN) as figure:
        axes = figure.subplots()
        axes.fill_between(
            degrees,
            curve.low_arcsec - middle,
            curve.high_arcsec - middle,
            color=colours.SKIP_LIGHT,
            lw=0,
        )
        first = np.argsort(curve.first_turn)
        axes.plot(
            DEG_PER_TURN * curve.first_turn[first],
            curve.first_arcsec[first] - middle,
            color=colours.SKIP,
            lw=1.2,
        )
        axes.set_xlabel("angle of the output, deg")
        axes.set_ylabel("transmission error, arcsec")
        axes.set_xlim(0.0, DEG_PER_TURN)
        axes.set_xticks(np.arange(0.0, DEG_PER_TURN + 1.0, 90.0))
        return drawing(
            figure,
            "turn",
            f"Error over the output turn: the first, and the range of all {compact(values.turns)}.",
            f"Curve of the transmission error in arcsec over 360 degrees of the output, in a "
            f"band from least to greatest; in all {number(values.total_arcsec)} arcsec.",
        )


def draw_orders(values: Values) -> Drawing:
    """Draw the orders that were found as stems, over the noise."""
    orders = values.orders
    with panel(HEIGHT_IN) as figure:
        axes = figure.subplots()
        places = [order.order for order in orders]
        sizes = [order.amplitude_arcsec for order in orders]
        axes.vlines(places, 0.5 * min(sizes), sizes, color=colours.SKIP, lw=1.4)
        axes.plot(places, sizes, "o", ms=4.0, mew=0, color=colours.SKIP)
        for order in _far_apart(orders):
            at = (order.order, order.amplitude_arcsec)
            text = compact(order.order, 5)
            theme.label(axes, text, at, colours.INK, offset=(0.0, 7.0), ha="center", va="bottom")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_ylim(0.5 * min(sizes), ROOM * max(sizes))
        axes.margins(x=0.1)
        axes.set_xlabel("order, periods in a turn of the output")
        axes.set_ylabel("amplitude, arcsec")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_major_formatter("{x:g}")
        largest = ", ".join(
            f"{compact(order.order, 5)} with {number(order.amplitude_arcsec)} arcsec"
            for order in orders[:NAMED_ORDERS]
        )
        return drawing(
            figure,
            "orders",
            f"Orders that stand out of the noise of {number(values.noise_arcsec)}″ (rms).",
            f"Amplitudes in arcsec over the order. The largest: {largest}.",
        )


def _far_apart(orders: Sequence[Order]) -> list[Order]:
    """Give the largest orders whose numbers do not cover one another."""
    chosen: list[Order] = []
    for order in orders:
        if all(abs(np.log(order.order / other.order)) > np.log(APART) for other in chosen):
            chosen.append(order)
    return chosen[:NAMED_ORDERS]
