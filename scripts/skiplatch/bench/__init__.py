"""The Linux bench: edges injected over CAN, latches recorded as a campaign.

`docs/INJECTION.md` and `docs/injection.dbc` describe what goes over the bus.
"""
