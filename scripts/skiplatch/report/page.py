"""A diagnosis as one page of HTML: no script, nothing from elsewhere, light and dark."""

from collections.abc import Mapping

import numpy as np

from skiplatch.arrays import spaced
from skiplatch.campaign import Campaign, InputPath
from skiplatch.diagnosis import Diagnosis
from skiplatch.diagnosis.experiment import Experiment
from skiplatch.diagnosis.experiment.text import REST, VARIED
from skiplatch.diagnosis.reported.text import EFFECTS_SHOW, floor_told
from skiplatch.diagnosis.reported.units_told import for_people
from skiplatch.figures.diagnosis import draw_distribution, draw_residuals, draw_shrink
from skiplatch.figures.inline import Drawing
from skiplatch.report import chain, glossary, ranking, words
from skiplatch.report.conditions import most_telling
from skiplatch.report.evidence import POSITION, Evidence, Seen, gather
from skiplatch.report.layout import render

TEMPLATE = "diagnosis.html"
FLOOR = "What plays of the same simulation score against each other: no effect takes that away."
MOST_FEEDS = 3
MOST_CONDITIONS = 4


def as_html(
    campaign: Campaign,
    diagnosis: Diagnosis,
    *,
    name: str,
    seed: int,
    jobs: int = 1,
    next_experiment: Experiment | None = None,
) -> str:
    """Lay out a diagnosis.

    Args:
        campaign: What was diagnosed.
        diagnosis: What was found.
        name: What the campaign is called.
        seed: Picks the random numbers of the simulations shown.
        jobs: Threads to simulate on.
        next_experiment: What to record or to touch next; None for nothing.
    """
    evidence = gather(campaign, diagnosis, seed=seed, jobs=jobs)
    diagnosis, ways = for_people(diagnosis), diagnosis.ways
    ranks = ranking.ranking(diagnosis)
    steps = chain.steps(diagnosis, campaign.nominal.kind)
    return render(
        TEMPLATE,
        name=name,
        kind=campaign.nominal.kind.value,
        touches=diagnosis.touches,
        verdict=diagnosis.verdict.value,
        headline=words.headline(diagnosis),
        lead=words.lead(diagnosis, ways.observable_name(evidence.stretch)),
        found=[words.found(named, diagnosis) for named in diagnosis.effects],
        chain=steps,
        chain_described=chain.described(steps),
        distributions=_distributions(evidence),
        residuals=_residuals(evidence),
        shrink=_shrink(diagnosis),
        gaps=words.gap_table(diagnosis.gap.values(), after=bool(diagnosis.effects)),
        floor=floor_told(diagnosis),
        effects_show=EFFECTS_SHOW,
        missed=words.missed_table(evidence.missed),
        ranking=ranks,
        cut_bars=ranking.cut_bars(ranks),
        no_gain=ranking.no_gain(diagnosis),
        where=words.where_table(diagnosis),
        left=words.left_table(diagnosis),
        next_experiment=next_experiment and words.next_touches(next_experiment),
        notes=diagnosis.notes,
        glossary={**_words(has_next=next_experiment is not None), "noise floor": FLOOR},
    )


def _words(*, has_next: bool) -> Mapping[str, str]:
    """Give the words that the page uses, explained, in the order of the alphabet."""
    return glossary.words(
        *("95 % interval", "chain", "confidence", "deviation", "direction α", "effect", "gap"),
        *("held out", "latch", "nats", "noise floor", "nominal", "p", "PLC task", "scan"),
        *("sense", "shrink", "skip input", "stage", "stretch"),
        *((*VARIED, REST) if has_next else ()),
    )


def _distributions(evidence: Evidence) -> list[Drawing]:
    """Draw the deviation and what tells most, of each path, at some feeds."""
    wanted = (POSITION, evidence.stretch)
    shown = [seen for seen in evidence.seen.values() if seen.stretch in wanted]
    drawn = [
        draw_distribution(f"d{i}-{path.value}-{k}", seen, evidence, path, feed)
        for i, seen in enumerate(sorted(shown, key=lambda seen: seen.stretch != evidence.stretch))
        for path in evidence.paths
        for k, feed in enumerate(_shown_feeds(evidence, seen, path))
    ]
    return [drawing for drawing in drawn if drawing is not None]


def _shown_feeds(evidence: Evidence, seen: Seen, path: InputPath) -> list[float]:
    """The slowest, the fastest, and some between, of the touches by axes of a kind."""
    touches = evidence.touches
    rows = (touches.path == path) & (touches.turns == seen.observable.is_rotary)
    feeds = np.unique(touches.feed_mm_min[rows])
    return [float(feed) for feed in feeds[spaced(len(feeds), MOST_FEEDS)]]


def _residuals(evidence: Evidence) -> list[Drawing]:
    """Draw the observable that tells most against the conditions that matter most."""
    drawn: list[Drawing] = []
    for seen in evidence.seen.values():
        if seen.stretch == evidence.stretch:
            here = np.where(evidence.touches.path == evidence.path, seen.left_before, np.nan)
            kind = [one.of(is_rotary=seen.observable.is_rotary) for one in evidence.conditions]
            chosen = most_telling(kind, here, MOST_CONDITIONS)
            first = len(drawn)
            drawn += [
                draw_residuals(f"r{i}", seen, evidence, condition)
                for i, condition in enumerate(chosen, first)
            ]
    return drawn


def _shrink(diagnosis: Diagnosis) -> Drawing | None:
    gaps = [gap for gap in diagnosis.gap.values() if gap.is_clear]
    return draw_shrink("shrink", gaps) if diagnosis.effects and gaps else None
