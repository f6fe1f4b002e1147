"""A fleet: campaigns of many rigs and months, kept in one store of Parquet files.

DuckDB reads and writes the files; it is an optional extra, and nothing outside of this package and
its commands needs it.
"""
