"""Transmission error of a drive chain from the pulses of an input and an output encoder."""
