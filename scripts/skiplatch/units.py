"""How many of one unit there are in another."""

UM_PER_MM = 1e3
MM_PER_M = 1e3
MM_PER_INCH = 25.4
NS_PER_US = 1e3
NS_PER_S = 1e9
US_PER_MS = 1e3
US_PER_S = 1e6
US_PER_H = 3.6e9
S_PER_MIN = 60.0
S_PER_H = 3600.0
UM_US_PER_MM_S = 1e-3
"""µm/µs in a mm/s."""
DEG_PER_TURN = 360.0
PER_CENT = 100.0
"""In the whole of a share."""
ARCSEC_PER_DEG = 3600.0
ARCSEC_PER_MILLIDEGREE = 3.6
"""As many as count as a µm: a degree of a rotary axis counts as a millimetre."""

MM, INCH = "mm", "inch"
"""As options and messages name them."""
