"""What one of several effects leaves speaks against that one alone."""

from dataclasses import replace

import numpy as np
import pytest

from played_campaigns import BENCH, MACHINE, played
from skiplatch.campaign import read_campaign
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.judge import Judge
from skiplatch.diagnosis.search.parts import split
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.verdict.evidence import Evidence
from skiplatch.diagnosis.verdict.guilty import SHOWN_IN, without_guilty
from skiplatch.diagnosis.verdict.named import _at_limit, _unrepeated, _unset
from skiplatch.diagnosis.verdict.shrink import PlayedRigs
from skiplatch.simulator.effects import Effect, effects
from standing_fits import standing
from verdict_evidence import GROWING, gap, left

LATE = Effect("isr_latency", {"latency_us": 6.0, "jitter_us": 5.0})
REPORT = Effect("report_delay", {"delay_us": 300.0})
OF_LATCH = replace(left(20.0, relative=3.0), observable="latch")
OF_REPORT = replace(left(20.0, relative=3.0), observable="report")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.of(played(BENCH, LATE, REPORT, seed=3))


@pytest.fixture
def judged(scene: Scene) -> tuple[Judge, Finding]:
    """Two effects that are found, where each acts in a stream of its own."""
    judge = Judge(scene, split(len(scene), 1))
    late, report = (CANDIDATES[effect.id] for effect in (LATE, REPORT))
    sizes = (_sizes(late.names, LATE), _sizes(report.names, REPORT))
    return judge, Finding(judge.score(Fit((late, report), sizes, frozenset({"latch_skip"}))))


def nowhere(_: Scored | None) -> frozenset[str]:
    """Notice nothing."""
    return frozenset()


def _sizes(names: tuple[str, ...], effect: Effect) -> np.ndarray:
    return np.array([effect.parameters.get(name, 0.0) for name in names])


@pytest.mark.parametrize(
    ("evidence", "kept"),
    [
        (Evidence(after=[OF_REPORT]), "isr_latency"),
        (Evidence(chance=[OF_LATCH]), "report_delay"),
        (Evidence(chance=[OF_LATCH], after=[OF_REPORT]), "report_delay"),
        (Evidence(at_limit=["report_delay.delay_us"]), "isr_latency"),
        (Evidence(vague=["isr_latency"]), "report_delay"),
        (
            Evidence(beyond_wandering={"isr_latency": 3.0, "report_delay": 90.0}, after=[OF_LATCH]),
            "report_delay",
        ),
        (Evidence(everywhere={"latch_after_edge_us": gap(0.9, tightness=0.1)}), "report_delay"),
        (Evidence(gaps={"deviation_um": gap(0.9, tightness=0.1)}), "report_delay"),
        (Evidence(everywhere={"report_after_latch_us": GROWING}), "isr_latency"),
        (Evidence(gaps={"latch_after_edge_us": GROWING}), "report_delay"),
    ],
)
def test_the_other_is_kept(judged: tuple[Judge, Finding], evidence: Evidence, kept: str) -> None:
    found = without_guilty(*judged, evidence, nowhere)

    assert found is not None
    assert found.model is not None
    assert found.model.ids == (kept,)


@pytest.mark.parametrize(
    "evidence",
    [
        Evidence(),
        Evidence(after=[OF_LATCH, OF_REPORT]),  # both are guilty
        Evidence(before=[OF_LATCH], after=[replace(OF_LATCH, size=1.0, relative=1.0)]),
        Evidence(gaps={"latch_after_edge_us": gap(0.9)}),
        Evidence(gaps={"report_after_latch_us": gap(0.9, tightness=0.1)}),
        Evidence(chance=[OF_REPORT]),  # a delay that is always the same leaves nothing to chance
    ],
)
def test_nothing_is_taken_out(judged: tuple[Judge, Finding], evidence: Evidence) -> None:
    assert without_guilty(*judged, evidence, nowhere) is None


def test_where_a_gap_grows_the_one_that_is_missed_least_is_taken_out(scene: Scene) -> None:
    """Both act on the latch: what is there does not answer for what came in beside it."""
    judge = Judge(scene, split(len(scene), 1))
    late, drift = CANDIDATES[LATE.id], CANDIDATES["timer_drift"]
    sizes = (_sizes(drift.names, Effect(drift.id, {"drift_ppm": 1.0})), _sizes(late.names, LATE))
    model = judge.score(Fit((drift, late), sizes, frozenset({"latch_skip"})))
    assert all(judge.reaches(model, i) & {"latch_skip"} for i in (0, 1))
    growing = Evidence(gaps={"latch_after_edge_us": GROWING})

    found = without_guilty(judge, Finding(model), growing, nowhere)

    assert found is not None
    assert found.model is not None
    assert found.model.ids == (LATE.id,)


@pytest.mark.long
def test_where_all_scatter_what_does_not_is_looked_for() -> None:
    """Masked interrupts take a delay for their own, and each that scatters would hide it again."""
    scene = Scene.of(played(BENCH, Effect("isr_latency", {"latency_us": 400.0}), seed=3))
    judge = Judge(scene, split(len(scene), 1))
    scattering = [one for one in judge.singles() if judge.scatters(one, 0)]
    assert {"isr_blocking", "contact_bounce"} <= {one.ids[0] for one in scattering}
    told = Evidence(chance=[replace(OF_LATCH, path="skip")])

    found = without_guilty(judge, Finding(scattering[0], ranking=tuple(scattering)), told, nowhere)

    assert found is not None
    assert found.model is not None
    assert found.model.ids == ("isr_latency",)
    assert found.model.fit.parameters[0][0] == pytest.approx(400.0, rel=0.01)
    tried = {one.ids[-1] for one in found.ranking}
    assert "contact_bounce" in tried  # in its place they may stand


@pytest.mark.long
def test_what_would_stand_for_the_same_does_not_hide_what_is_looked_for_either() -> None:
    """A delay was taken for masked interrupts; late contacts would stand for it next."""
    scene = Scene.of(played(BENCH, Effect("isr_latency", {"latency_us": 400.0}), REPORT, seed=3))
    judge = Judge(scene, split(len(scene), 1))
    alone = judge.score(standing(scene, REPORT))
    tried = [one for one in judge.pairs(alone) if judge.scatters(one, 1)]
    assert {"isr_blocking", "contact_bounce"} <= {one.ids[1] for one in tried}
    blocking = next(one for one in tried if one.ids[1] == "isr_blocking")
    told = Evidence(chance=[replace(OF_LATCH, path="skip")])

    def noticed(model: Scored | None) -> frozenset[str]:
        return frozenset({"latch_skip"}) if model and model.ids == alone.ids else frozenset()

    found = without_guilty(judge, Finding(blocking, ranking=tuple(tried)), told, noticed)

    assert found is not None
    assert found.model is not None
    assert found.model.ids == ("report_delay", "isr_latency")
    assert not {"isr_blocking", "contact_bounce"} & {one.ids[-1] for one in found.ranking}


def test_it_is_known_where_each_gap_shows(judged: tuple[Judge, Finding]) -> None:
    scene = judged[0].scene
    plays = PlayedRigs.of(
        scene, Rig(scene.nominal), Rig(scene.nominal, (LATE,)), seed=1, jobs=1
    ).gaps(np.ones(len(scene), dtype=np.bool_))

    assert plays.keys() <= SHOWN_IN.keys()
    assert frozenset().union(*SHOWN_IN.values()) >= scene.streams.keys() - {"motion"}


def test_nothing_found_has_no_guilty_part(judged: tuple[Judge, Finding]) -> None:
    found = without_guilty(judged[0], Finding(None), Evidence(after=[OF_LATCH]), nowhere)

    assert found is None


@pytest.mark.parametrize(
    ("late", "report", "kept"),
    [(0.5, 1.0, (REPORT.id,)), (0.5, 0.5, None), (1.0, 1.0, None)],
)
def test_the_one_that_gains_too_little_is_taken_out(
    judged: tuple[Judge, Finding], late: float, report: float, kept: tuple[str, ...] | None
) -> None:
    gains = {LATE.id: late, REPORT.id: report}

    found = without_guilty(*judged, Evidence(gains=gains), nowhere)

    assert (found and found.model and found.model.ids) == kept


def test_what_a_guilty_one_stood_for_is_searched_for_again(
    scene: Scene, judged: tuple[Judge, Finding]
) -> None:
    """A scan that is locked to touches is none of a bench's whose interrupt is late."""
    judge, _ = judged
    lock, report = CANDIDATES["scan_phase_lock"], CANDIDATES[REPORT.id]
    wrong = np.zeros(len(lock.names)), _sizes(report.names, REPORT)
    finding = Finding(judge.score(Fit((lock, report), wrong, frozenset(scene.streams))))

    evidence = Evidence(gains={lock.id: 0.0})

    seen = without_guilty(judge, finding, evidence, lambda _: frozenset({"latch_skip"}))
    unseen = without_guilty(judge, finding, evidence, nowhere)

    assert seen is not None
    assert seen.model is not None
    assert set(seen.model.ids) == {LATE.id, REPORT.id}
    assert unseen is not None
    assert unseen.model is not None
    assert unseen.model.ids == (REPORT.id,)


def test_what_acts_elsewhere_stands_in_for_none_that_is_kept(judged: tuple[Judge, Finding]) -> None:
    """However much it gains there: reports that are late do nothing for a latch."""
    found = without_guilty(*judged, Evidence(after=[OF_REPORT]), nowhere)

    assert found is not None
    assert REPORT.id not in {name for names in found.alternatives for name in names}
    assert REPORT.id not in {name for model in found.ranking for name in model.ids}


@pytest.mark.parametrize(("share", "is_end"), [(0.3, False), (0.6, True), (0.0, False)])
def test_a_share_stands_at_a_limit_where_its_search_ends(share: float, is_end: bool) -> None:
    """What happens to more than six touches in ten is another effect."""
    none = {parameter.name: 0.0 for parameter in effects()["contact_bounce"].parameters}
    effect = Effect("contact_bounce", {**none, "probability": share, "mean_us": 50.0})

    assert ("probability" in _at_limit(effect)) is is_end


@pytest.mark.parametrize(("turns", "is_told"), [(1.0, False), (1.4, False), (1.6, True)])
def test_a_period_that_the_positions_do_not_show_again_is_at_a_limit(
    turns: float, is_told: bool
) -> None:
    scene = Scene.of(read_campaign(MACHINE))
    period_mm = float(np.nanmax(scene.latched_mm) - np.nanmin(scene.latched_mm)) / turns
    none = {parameter.name: 0.0 for parameter in effects()["transmission_error"].parameters}
    wave = Effect("transmission_error", {**none, "amplitude_um": 5.0, "period_mm": period_mm})

    assert ("period_mm" not in _unrepeated(scene, wave)) is is_told
    assert not _unrepeated(scene, Effect("backlash", {"backlash_um": 5.0}))


@pytest.mark.parametrize(("phase_deg", "is_open"), [(0.0, True), (200.0, False)])
def test_a_phase_that_is_none_may_be_anywhere(phase_deg: float, is_open: bool) -> None:
    parameters = {"period_us": 40.0, "dead_us": 0.0, "phase_deg": phase_deg}

    assert _unset(Effect("servo_hold", parameters)) == ({"phase_deg"} if is_open else set())
