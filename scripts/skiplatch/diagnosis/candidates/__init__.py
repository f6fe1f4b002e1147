"""The effects that can be fitted: what each does, and where a search for it begins.

In closed form, or from plays of the simulator. Builds on ``density``, ``scene`` and
``likelihood``.
"""
