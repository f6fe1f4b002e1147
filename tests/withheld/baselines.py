"""What the diagnosis must beat: three plainer ways to name an effect, on the same campaigns."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from skiplatch.campaign import Campaign, read_campaign
from skiplatch.progress import shown
from skiplatch.tables import table
from skiplatch.workers import NOT_KEPT, Keeper, Workers, in_order, opened
from tests.withheld.baseline_crps import LowestCrps
from tests.withheld.baseline_regression import Regression
from tests.withheld.baseline_trees import Trees
from tests.withheld.nats import PLAIN
from tests.withheld.scoring import Scored

DIAGNOSIS = "skiplatch diagnose"


class Baseline(Protocol):
    """A way to name the one effect of a campaign."""

    @property
    def title(self) -> str:
        """What it is called."""

    def name(self, campaign: Campaign) -> str | None:
        """Name an effect, or None."""


def all_baselines() -> list[Baseline]:
    """Give them all; the classifier is trained now if it was not before."""
    return [Trees.trained(), Regression(), LowestCrps()]


def guess_all(
    campaigns: Sequence[Path],
    compared: Sequence[Baseline],
    workers: Workers,
    keeper: Keeper = NOT_KEPT,
) -> list[dict[str, str | None]]:
    """Let the baselines name an effect of each campaign; workers find folders by their names."""
    if not compared:
        return [{} for _ in campaigns]
    tasks = [(baseline, path.resolve()) for path in campaigns for baseline in compared]
    with opened(replace(workers, loads=__name__)) as executor:
        said = [f"{baseline.title} on {path}" for baseline, path in tasks]
        coming = in_order(executor, guess, tasks, said, keeper)
        named = list(shown(coming, len(tasks), "baselines"))
    titles = [baseline.title for baseline in compared]
    rows = [named[i : i + len(titles)] for i in range(0, len(named), len(titles))]
    return [dict(zip(titles, row, strict=True)) for row in rows]


def guess(baseline: Baseline, campaign: Path) -> str | None:
    """Let a baseline name an effect: what a worker does."""
    return baseline.name(read_campaign(campaign))


def as_text(results: Sequence[Scored]) -> str:
    """Show the diagnosis and the baselines side by side."""
    titles = [DIAGNOSIS, *(results[0].guesses if results else ())]
    columns = [
        ("right name, > 30 nats", _of(results, "single", plain=True), _is_right),
        ("right name, all single", _of(results, "single"), _is_right),
        ("one of two", _of(results, "two"), _is_right),
        ("named on none", _of(results, "none"), _names),
        ("named on dull", _of(results, "dull"), _names),
        ("named on strangers", _of(results, "stranger"), _names),
        ("of the grammar", _of(results, "strangers"), _names),
        ("named on datum", _of(results, "datum"), _names),
    ]
    lines = [(title, *(_count(here, title, hit) for _, here, hit in columns)) for title in titles]
    return table(("", *(column[0] for column in columns)), lines)


Hit = Callable[[Scored, str], bool]


def _of(results: Sequence[Scored], case: str, *, plain: bool = False) -> list[Scored]:
    return [r for r in results if r.label.case == case and (r.nats > PLAIN or not plain)]


def _count(results: Sequence[Scored], title: str, hit: Hit) -> str:
    return f"{sum(hit(r, title) for r in results)}/{len(results)}" if results else ""


def _named(scored: Scored, title: str) -> set[str]:
    if title == DIAGNOSIS:
        return {name.id for name in scored.found.names}
    guess = scored.guesses[title]
    return {guess} if guess else set()


def _is_right(scored: Scored, title: str) -> bool:
    """Whether all that was named is in the campaign: a baseline names one effect at most."""
    named = _named(scored, title)
    return bool(named) and named <= scored.truth


def _names(scored: Scored, title: str) -> bool:
    return bool(_named(scored, title))
