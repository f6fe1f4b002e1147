"""All that a verdict rests on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.verdict.shrink import Gap


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """All that a verdict rests on.

    Attributes:
        gaps: Observables on touches held out, with the gap before and after; by name.
        everywhere: The same of all touches, to most of which the finding was fitted.
        is_held_out: The gaps are those of touches that served neither fitting nor naming; else of
            all touches, each with parameters that the others were fitted to.
        is_chancy: The effects leave to chance what happens to a touch.
        chance: What may tell how the finding's chance fell, if it is material.
        before: What the believed chain leaves that is material and hardly an accident.
        after: The same of the finding; of none, if nothing was found.
        hidden: By how many times its noise an observable may be off unseen, the best of them.
        unreached: Streams whose law the effects leave as it is.
        effects: Ids of the effects found.
        at_limit: Parameters at an end of their range, as "effect.parameter".
        undoing: Ids of effects that undo each other.
        open: Parameters whose interval tells nothing, likewise.
        vague: Ids of effects most of whose parameters are open.
        is_loose: The effects need all the slack there is.
        nats: By how much likelier it makes touches that served neither fitting nor naming.
        gains: What each effect found gains over what it gains on plays of the finding; by its id.
        beyond_wandering: Nats that effects gain beside something slow that nobody recorded, by id;
            of those that shift touches by more than a level, where the finding leaves something, or
            begins or ends and does not explain.
        is_confirmed: Plain simulation of them does better than the believed chain.
        outlying: Touches far off all that the finding plays, or the believed chain, and latches
            without a contact.
        outlying_in: Observables in which these are.
        outlying_with: What tells which touches these are; empty where chance may.
        touches: All of them.
    """

    gaps: Mapping[str, Gap] = field(default_factory=dict)
    everywhere: Mapping[str, Gap] = field(default_factory=dict)
    is_held_out: bool = True
    is_chancy: bool = False
    chance: Sequence[Left] = ()
    before: Sequence[Left] = ()
    after: Sequence[Left] = ()
    hidden: float = 0.0
    unreached: frozenset[str] = frozenset()
    effects: Sequence[str] = ()
    at_limit: Sequence[str] = ()
    undoing: Sequence[str] = ()
    open: Sequence[str] = ()
    vague: Sequence[str] = ()
    is_loose: bool = False
    nats: float = 0.0
    gains: Mapping[str, float] = field(default_factory=dict)
    beyond_wandering: Mapping[str, float] = field(default_factory=dict)
    is_confirmed: bool = True
    outlying: int = 0
    outlying_in: Sequence[str] = ()
    outlying_with: str = ""
    touches: int = 0

    @property
    def effects_at_limit(self) -> frozenset[str]:
        """Ids of the effects with a parameter at an end of its range."""
        return frozenset(name.split(".")[0] for name in self.at_limit)
