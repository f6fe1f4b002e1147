"""The C simulation with the real firmware in it, as Python sees it."""
