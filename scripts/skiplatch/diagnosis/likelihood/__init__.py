"""How likely the recorded touches are under a change of the physics.

The law of every stream, with the wait for the scan and lines of a grid. Builds on ``density`` and
``scene``.
"""
