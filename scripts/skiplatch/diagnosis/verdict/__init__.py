"""What a finding comes to: the gap reduction, the evidence, and the rules that decide.

Builds on ``search`` and all below it.
"""
