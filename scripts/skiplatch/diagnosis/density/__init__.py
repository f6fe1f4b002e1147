"""The residuals of touches, and their laws as densities.

``law.c`` computes them; ``Change`` says what an effect does to them. Builds on no other package.
"""
