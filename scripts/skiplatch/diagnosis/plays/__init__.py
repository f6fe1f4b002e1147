"""Plays of the rig of a hypothesis, and what they leave of the record.

Builds on ``fit`` and on the packages below it, but for ``candidates``.
"""
