"""What the diagnosis finds in a campaign, before plain simulation judges it."""

from skiplatch.campaign import Campaign
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.fit.material import DEFAULT
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding, find
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.verdict.work import Work, mattering


class Search:
    """The search in one campaign, with the callbacks that the diagnosis gives it."""

    def __init__(self, campaign: Campaign) -> None:
        self._work = Work(Scene.of(campaign), None, 1, 1, DEFAULT)
        self.judge = self._work.judge

    def rig(self, fit: Fit | None) -> Rig:
        return self._work.rig(fit)

    def found(self) -> Finding:
        """The effects by their surrogates."""
        work = self._work
        return find(self.judge, work.noticed)

    def left(self, model: Scored) -> list[Left]:
        """What a model leaves that is significant and matters."""
        looks = self._work.left(self._work.scene, self.rig(model.fit))
        return [one for one in mattering(looks, DEFAULT) if one.is_significant]


def found(campaign: Campaign) -> Finding:
    """The same of a campaign alone."""
    return Search(campaign).found()


def groups(finding: Finding) -> list[set[str]]:
    """Give each effect of a finding with what would do as well."""
    if finding.model is None:
        return []
    pairs = zip(finding.model.ids, finding.alternatives, strict=True)
    return [{name, *others} for name, others in pairs]
