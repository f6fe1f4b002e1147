"""All that is said of a campaign."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from skiplatch.diagnosis.fit.beliefs import Belief
from skiplatch.diagnosis.fit.material import DEFAULT, Materiality
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.reported.wanting import FAILED_FOR_WANT, Wanting, wanting
from skiplatch.diagnosis.reported.where import Place
from skiplatch.diagnosis.verdict.named import Named
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.diagnosis.verdict.verdict import Failure, Verdict
from skiplatch.simulator.effects import Effect
from skiplatch.ways import Ways


@dataclass(frozen=True, slots=True)
class Ranked:
    """A model that was tried: its effects, and how much better than no effect it does."""

    effects: tuple[Effect, ...]
    score_nats: float
    """Gain in log-likelihood, less what so many parameters gain by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """All that is said of a campaign."""

    verdict: Verdict
    where: Sequence[Place]
    effects: Sequence[Named]
    gap: Mapping[str, Gap]
    ranking: Sequence[Ranked]
    """The models tried last, by falling score."""
    rivals: Sequence[Ranked]
    """What the recorded columns do not tell from the finding, which is the first; may be empty."""
    left: Sequence[Left]
    """What no effect of the catalogue accounts for, if it is significant and matters."""
    touches: int
    used: int
    """Touches that the search looked at."""
    notes: Sequence[str]
    """What the campaign does not allow to say."""
    believed: Rig
    """The rig as it was believed to be, but for its datum and the uncertainty of the beliefs."""
    rig: Rig
    """The rig with the effects named."""
    materiality: Materiality = DEFAULT
    """From which size on a gap was one."""
    beliefs: Sequence[tuple[Belief, float]] = ()
    """Beliefs that were fitted, and their values now."""
    outliers: Sequence[int] = ()
    """Serial numbers of touches that are far off what the finding plays."""
    failures: Sequence[Failure] = ()
    """The rules that the finding failed, or what came closest, and by how much."""
    closest: tuple[str, ...] = ()
    """Ids of the effects that came closest, where they were refused; they are no finding."""
    ways: Ways = Ways.LINEAR
    """What the axes do; of rotary ones a µm stands for 0.001°."""
    ways_of_paths: Mapping[str, Ways] = field(default_factory=dict)
    """The same of the touches of "skip" and of "plc"."""
    fingerprint: str = ""
    """Of all touches of the campaign: `campaign.fingerprint`."""

    def ways_of(self, paths: str) -> Ways:
        """Give what the axes do that touch on "skip", on "plc" or on "both"."""
        return self.ways_of_paths.get(paths, self.ways)

    @property
    def leaves_nothing_seen(self) -> bool:
        """Of a gap that is explained in part nothing is seen to be left."""
        is_part = self.verdict is Verdict.PARTLY_EXPLAINED
        is_wanting = {failure.rule for failure in self.failures} <= FAILED_FOR_WANT
        return is_part and is_wanting and not self.left and not self.outliers

    @property
    def seems_whole(self) -> bool:
        """It is explained as far as can be seen: touches are too few."""
        return self.leaves_nothing_seen and (self.wanting is None or self.wanting.is_likely)

    @property
    def wanting(self) -> Wanting | None:
        """What more of the gap would have to go, if nothing but that is missing."""
        return wanting(self.failures, self.gap.values(), self.used)

    @property
    def moved_far(self) -> Sequence[tuple[Belief, float]]:
        """The beliefs that are off by more than they are uncertain, with what they are now."""
        return [(b, now) for b, now in self.beliefs if abs(b.uncertainties(now)) > 1.0]
