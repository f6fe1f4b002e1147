"""Probe errors: pretravel, trigger delay, and speeds that make them equal in all directions."""
