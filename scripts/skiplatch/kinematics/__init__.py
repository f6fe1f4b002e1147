"""Location errors of rotary axes, from the centres of a sphere at several positions of the axes."""
