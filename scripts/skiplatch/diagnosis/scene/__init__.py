"""A recorded campaign as residuals of the nominal chain, stage by stage.

The streams, what a touch could depend on, and the grids that values lie on. Builds on ``density``.
"""
