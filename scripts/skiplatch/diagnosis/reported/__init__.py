"""A diagnosis as it is told: what it says, in words and in JSON, and adopted as a belief.

Builds on ``verdict`` and all below it.
"""
