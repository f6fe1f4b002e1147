"""Simulate probing with a latched or a polled skip input, and explain the gap."""

from importlib.metadata import version


def __getattr__(name: str) -> str:
    if name == "__version__":  # as installed; looked up when asked for, as that takes a while
        return version("skiplatch")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
