"""One hypothesis fitted: its parameters, their intervals, when it acts, what is material.

The beliefs are fitted along. Builds on ``candidates`` and all below it.
"""
