"""The documented interface for Python, docs/API.md: what `skiplatch` itself exports.

`work` has the functions, `diagnosed` and `predicted` what they give. The commands call the same.
"""
