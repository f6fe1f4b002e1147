"""Which effects a campaign shows: hypotheses scored, extended, confirmed by plays, reduced.

Builds on ``candidates``, ``fit``, ``plays`` and on what these build on.
"""
