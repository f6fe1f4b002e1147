"""Words of the pages that are no shop words, explained; those of columns stand at the columns."""

from collections.abc import Mapping

from skiplatch.campaign import COLUMNS

MEANINGS = {
    "95 % interval": "Holds the true value in 95 of 100 such measurements.",
    "cell": "The touches of one path at one feed.",
    "chain": "What a touch passes from the contact to the record; each step is a stage.",
    "confidence": "How often a name that stood out as much was right where the truth was known.",
    "deviation": "The position that was latched less the one that was expected.",
    "distance": "How far a touch has to be moved, on average, to turn one distribution into the "
    "other (Wasserstein distance).",
    "direction α": "Azimuth of the touch in the plane normal to the probe.",
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
    "sense": "1 where the axis moves towards greater coordinates, -1 where towards lesser.",
    "shrink": "The share of the gap that is gone once the effects are simulated.",
    "slope with the feed": "How much later, in length, touches come the faster they are: a delay.",
    "stage": "A step of the chain.",
    "spread": "Standard deviation about the simulated mean of the same touch.",
    "stretch": "A part of the chain between two things that were recorded, such as edge and latch.",
    "rest_s": "How long the axis is free before a touch.",
    "σ": "Standard deviation of one touch about its surface's middle.",
}


def words(*names: str) -> Mapping[str, str]:
    """Give the meanings of words and columns, in the order of the alphabet."""
    return {name: _meaning(name) for name in sorted(names, key=str.lower)}


def _meaning(name: str) -> str:
    if name in MEANINGS:
        return MEANINGS[name]
    meaning = COLUMNS[name].meaning
    return f"{meaning[0].upper()}{meaning[1:]}."
