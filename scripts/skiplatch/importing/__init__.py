"""Logs that machines and instruments write, read into campaigns.

Each reader is liberal in what it takes and says in plain words what is known, what was assumed,
and what it could not read.
"""
