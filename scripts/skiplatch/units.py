"""How many of one unit there are in another."""

UM_PER_MM = 1e3
MM_PER_M = 1e3
S_PER_MIN = 60.0
US_PER_S = 1e6
US_PER_H = 3.6e9
NS_PER_S = 1e9
DEG_PER_TURN = 360.0
