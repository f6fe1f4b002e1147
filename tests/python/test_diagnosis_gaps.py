"""Gaps between scans that are late for two reasons, and waits for scans that were played again."""

import numpy as np
import pytest

from played_campaigns import BENCH, played, played_again, stamped_machine, values_of
from skiplatch.arrays import FloatArray
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.density import change
from skiplatch.diagnosis.density.change import MOST_GAPS, Change, Gaps, gaps_of_both
from skiplatch.diagnosis.likelihood.likelihood import likelihood
from skiplatch.diagnosis.likelihood.scan_wait import other_waits
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.replay import replayed
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.simulator.effects import Effect

SPREAD: Gaps = tuple((0.2, 0.96 + 0.02 * i) for i in range(5))
RARE: Gaps = ((0.12, 1.4), (0.06, 0.6))


def mean_length(gaps: Gaps) -> float:
    """Of the gaps that edges meet, those of one period among them; in periods."""
    return 1.0 + sum(share * (length - 1.0) for share, length in gaps)


def test_what_makes_gaps_longer_adds_up() -> None:
    """Drawn scan by scan: every gap weighs as much as it is long, for that many edges it meets."""
    rng, n = np.random.default_rng(5), 400_000
    one, other = (drawn(gaps, rng, n) for gaps in (SPREAD, RARE))
    lengths = one + other - 1.0

    found = gaps_of_both(SPREAD, RARE)

    mean = float(np.average(lengths, weights=lengths))
    assert mean_length(found) == pytest.approx(mean, abs=0.002)
    long = float(sum(share for share, length in found if length > 1.2))
    assert long == pytest.approx(float(lengths[lengths > 1.2].sum() / lengths.sum()), abs=0.002)


def drawn(gaps: Gaps, rng: np.random.Generator, n: int) -> FloatArray:
    """Draw the lengths of gaps, each as often as there are some of it."""
    rest = 1.0 - sum(share for share, _ in gaps)
    shares, lengths = np.array([*gaps, (rest, 1.0)]).T
    often = shares / lengths
    return rng.choice(lengths, n, p=often / often.sum())


def test_gaps_of_one_reason_stay_as_they_are() -> None:
    assert gaps_of_both(RARE, ()) == gaps_of_both((), RARE) == RARE


def test_of_many_lengths_the_rarest_are_taken_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """The gaps that edges meet stay as long in the mean."""
    many = tuple((0.01 * (i + 1), 1.1 + 0.1 * i) for i in range(8))

    found = gaps_of_both(many, SPREAD)
    monkeypatch.setattr(change, "MOST_GAPS", 1000)
    each = gaps_of_both(many, SPREAD)

    assert len(found) <= MOST_GAPS < len(each)
    assert [length for _, length in found] == sorted(length for _, length in found)
    assert mean_length(found) == pytest.approx(mean_length(each))


@pytest.mark.parametrize("jitter_us", [20.0, 300.0])
def test_edges_wait_as_late_scans_let_them(jitter_us: float) -> None:
    """Both reasons together tell the waits about as well as the larger one, or better."""
    jitter = Effect("scan_jitter", {"jitter_us": jitter_us})
    overrun = Effect("scan_overrun", {"probability": 0.08, "overrun_us": 800.0})
    scene = Scene.of(played(BENCH, jitter, overrun))
    one, other = (changed(scene, effect) for effect in (jitter, overrun))

    alone, together = (nats_of_waits(scene, there) for there in (other, other.joined(one)))

    assert together > alone - 3.0


@pytest.mark.parametrize(
    "late",
    [
        Effect("scan_jitter", {"jitter_us": 300.0}),
        Effect("scan_overrun", {"probability": 0.08, "overrun_us": 800.0}),
    ],
    ids=["jitter", "overrun"],
)
def test_edges_locked_to_the_grid_wait_for_scans_that_are_late_on_it(late: Effect) -> None:
    """The lock and the lateness tell the waits together far better than either does."""
    lock = Effect("scan_phase_lock", {"phase": 0.3, "spread": 0.03, "unlocked": 0.6})
    scene = Scene.of(played(BENCH, lock, late))
    one, other = (changed(scene, effect) for effect in (lock, late))

    first, second, together = (
        nats_of_waits(scene, there) for there in (one, other, one.joined(other))
    )

    assert together > max(first, second) + 30.0


def test_edges_that_are_not_locked_fall_into_gaps_evenly() -> None:
    """Touches of which half wait at a point of the scan meet the gaps of the other half."""
    scene = Scene.of(played(BENCH))
    lock = changed(scene, Effect("scan_phase_lock", {"phase": 0.3, "unlocked": 0.5}))

    extras = other_waits(scene, lock.joined(Change(gaps=RARE)))

    period = scene.nominal.plc.scan_us
    assert [(e.share, e.width) for e in extras[1:]] == [(0.06, 1.4 * period), (0.03, 0.6 * period)]
    assert sum(extra.share for extra in extras) == pytest.approx(0.5 + 0.5 * 0.18)


def nats_of_waits(scene: Scene, there: Change) -> float:
    return float(likelihood(scene, there, names=["latch_plc"]).streams["latch_plc"].sum())


def test_a_campaign_played_again_draws_the_age_of_images_once() -> None:
    """Half of the images are one scan old, half two: edges wait for one to three scans."""
    old = Effect("input_image_delay", {"scans": 1.5})
    campaign = played_again(stamped_machine(), old)
    scene = Scene.of(campaign)
    rig = Rig(campaign.nominal, (old,)).whose_scans_are(campaign.touches, seed=1)

    (again,) = replayed(scene, np.arange(len(scene)), rig, seed=3, campaigns=1)

    waits = again.streams["latch_plc"]
    scans = (waits.known - waits.law.offset[waits.rows]) / campaign.nominal.plc.scan_us
    assert scans.mean() == pytest.approx(2.0, abs=0.1)
    assert scans.min() > 0.99
    assert scans.max() < 3.01


def changed(scene: Scene, effect: Effect) -> Change:
    return CANDIDATES[effect.id].change(scene, values_of(effect))
