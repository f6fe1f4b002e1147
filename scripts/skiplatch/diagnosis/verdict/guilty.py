"""Which of several effects keep a finding from being named.

What one effect leaves speaks against that one, and not against the others: these stand or fall by
themselves.
"""

from skiplatch.diagnosis.plays.leftover import streams_of
from skiplatch.diagnosis.search.decide import Finding, reduced
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.rules import mostly_left, told_of_chance


def without_guilty(judge: Judge, finding: Finding, evidence: Evidence) -> Finding | None:
    """Take out the effects whose chance can be told, or who leave much of what there was.

    They are those that scatter, or change anything at all, in the streams that tell so.

    Args:
        judge: Fits what is left of the finding anew.
        finding: Of one effect or more.
        evidence: For and against it.

    Returns:
        The others; None where it is no effect, or all of them.
    """
    model = finding.model
    if model is None:
        return None
    accused = (
        (told_of_chance(evidence), judge.scatters),
        (mostly_left(evidence), judge.reaches),
    )
    for looks, acts in accused:
        streams = frozenset(name for one in looks for name in streams_of(one))
        guilty = [i for i in range(len(model.ids)) if acts(model, i) & streams]
        if 0 < len(guilty) < len(model.ids):
            for i in reversed(guilty):
                model = judge.again_without(model, i)
            return reduced(judge, model)
    return None
