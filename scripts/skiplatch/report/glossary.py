"""Words of the pages that are no shop words, explained."""

from collections.abc import Mapping

MEANINGS = {
    "95 % interval": "Holds the true value in 95 of 100 such measurements.",
    "cell": "The touches of one path at one feed.",
    "chain": "What a touch passes from the contact to the record; each step is a stage.",
    "deviation": "The position that was latched less the one that was expected.",
    "distance": "How far a touch has to be moved, on average, to turn one distribution into the "
    "other (Wasserstein distance).",
    "drift": "A change from touch to touch that does not come back.",
    "effect": "One thing that the simulation of the believed rig leaves out.",
    "gap": "The difference between what was recorded and what the simulation of the believed rig "
    "gives.",
    "held out": "Touches that served neither to find nor to fit an effect, so that they can judge "
    "it.",
    "latch": "To keep time and position of the axis at the trigger.",
    "nats": "Natural logarithm of how many times likelier what was recorded is with the effect "
    "than without. 3 nats: 20 times.",
    "noise floor": "The distance that the simulation has from itself: one repetition in twenty "
    "lies beyond.",
    "nominal": "As believed: what nominal.toml says of the rig.",
    "outlier": "A touch so far off that it cannot belong to the scatter of the others.",
    "p": "How often chance alone would give as much.",
    "PLC task": "The input is polled in a cycle; the trigger is seen at the next scan.",
    "scan": "One turn of the PLC task, in which it looks at its inputs.",
    "skip input": "The trigger interrupts the controller, which latches at once.",
    "shrink": "The share of the gap that is gone once the effects are simulated.",
    "slope with the feed": "How much later, in length, touches come the faster they are: a delay.",
    "spread": "Standard deviation about the simulated mean of the same touch.",
    "σ": "Standard deviation of one touch about its surface's middle.",
}


def words(*names: str) -> Mapping[str, str]:
    """Give the meanings of some words, in the order of the alphabet."""
    return {name: MEANINGS[name] for name in sorted(names, key=str.lower)}
