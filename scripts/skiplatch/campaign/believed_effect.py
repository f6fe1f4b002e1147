"""An effect that nominal.toml holds: ``[[effect]]``."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class BelievedEffect:
    """An effect that the rig is believed to have; the nominal chain plays it.

    Attributes:
        id: Its name in the table of effects.
        values: Its parameters by name, in their units.
        uncertainty: Standard uncertainties of those of them that have one.
    """

    id: str
    values: Mapping[str, float] = field(hash=False)
    uncertainty: Mapping[str, float] = field(default_factory=dict, hash=False)
