"""Where the surface is: unknown by a length for each datum group, and fitted with every hypothesis.

A touch tells where the surface is only beside the others that share its datum, for a coordinate is
counted from a zero that somebody has set. What such a length takes up is therefore no effect. It
shows in two ways, each of which is free: stamps tell when the surface is met, coordinates where.
"""

BY_STAMPS = ("latch_skip", "latch_plc")
ARRIVAL = "arrival"
BY_COORDINATES = ("position", ARRIVAL)
WITHOUT_STAMPS = ("deviation_skip", "deviation_plc")
FAMILIES = (BY_STAMPS, BY_COORDINATES, WITHOUT_STAMPS)
"""Observables that one length shifts together."""
SHIFTED = frozenset(name for family in FAMILIES for name in family)
