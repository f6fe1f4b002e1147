"""Simulate probing with a latched or a polled skip input, and explain the gap."""
