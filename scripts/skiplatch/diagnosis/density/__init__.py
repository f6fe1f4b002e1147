"""The residuals of touches, and their laws as densities.

``density.c`` computes them; ``Change`` is what an effect does to them. Builds on no other package.
"""
