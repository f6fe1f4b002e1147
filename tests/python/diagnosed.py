"""What the diagnosis finds in a campaign, before plain simulation judges it."""

from skiplatch.campaign import Campaign
from skiplatch.diagnosis.decide import Finding, find
from skiplatch.diagnosis.judge import Judge
from skiplatch.diagnosis.left import Left
from skiplatch.diagnosis.material import DEFAULT
from skiplatch.diagnosis.playing import Rig
from skiplatch.diagnosis.scene import Scene
from skiplatch.diagnosis.scored import Scored
from skiplatch.diagnosis.search import Fit
from skiplatch.diagnosis.work import Work, mattering


class Search:
    """The search in one campaign, with the callbacks that the diagnosis gives it."""

    def __init__(self, campaign: Campaign) -> None:
        self._work = Work(Scene.of(campaign), None, 1, 1, DEFAULT)
        self.judge = Judge(self._work.scene, self._work.parts)

    def rig(self, fit: Fit | None) -> Rig:
        return self._work.rig(fit)

    def found(self) -> Finding:
        """The effects by their surrogates."""
        work = self._work
        return find(self.judge, work.noticed, work.may_begin, work.passes)

    def left(self, model: Scored) -> list[Left]:
        """What a model leaves that is significant and matters."""
        looks = self._work.left(self._work.scene, self.rig(model.fit))
        return [one for one in mattering(looks, DEFAULT) if one.is_significant]


def found(campaign: Campaign) -> Finding:
    """The same of a campaign alone."""
    return Search(campaign).found()
