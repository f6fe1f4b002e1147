"""What a diagnosis tells beside its verdict: which effects show where, and what is missing."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from made_diagnoses import made
from played_campaigns import BENCH, played
from skiplatch.campaign import Campaign, read_campaign
from skiplatch.diagnosis import Diagnosis, Named, Place, Verdict
from skiplatch.diagnosis.candidates.table import CANDIDATES
from skiplatch.diagnosis.fit.fit import Fit
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.reported.adoption import adopted
from skiplatch.diagnosis.reported.document import as_json, effects_from_json
from skiplatch.diagnosis.reported.notes import notes
from skiplatch.diagnosis.reported.schema import need_intervals, whole
from skiplatch.diagnosis.reported.text import as_text
from skiplatch.diagnosis.reported.where import places
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.search.decide import Finding
from skiplatch.diagnosis.search.scored import Scored
from skiplatch.diagnosis.verdict.shrink import Gap
from skiplatch.diagnosis.verdict.verdict import Failure
from skiplatch.report.page import as_html
from skiplatch.report.words import headline, where_table
from skiplatch.simulator.effects import Effect, effects
from skiplatch.statistics import Interval

LATE = Effect("isr_latency", {"latency_us": 60.0, "jitter_us": 0.0, "tail_us": 0.0})
WHERE_SHOWN = "Where the effects show, and how far off the simulation is without them\n"


@cache
def campaign() -> Campaign:
    return read_campaign(BENCH)


def gap(low: float, value: float, high: float, before: float = 40.0) -> Gap:
    return Gap("latch − edge", "µs", before, 1.0, 0.5, Interval(value, low, high))


def told(verdict: Verdict, *found: Effect, **others: Any) -> Diagnosis:  # noqa: ANN401
    """Put a diagnosis together by hand."""
    rig = Rig(campaign().nominal)
    ends = {
        name: (value - 1.0, value + 1.0) for one in found for name, value in one.parameters.items()
    }
    named = [Named(one, effects()[one.id].stage, ends, (), 0.9) for one in found]
    return made(verdict, rig, replace(rig, effects=found), named, **others)


def test_each_place_names_the_effects_that_it_needs() -> None:
    late_report = Effect(
        "report_delay",
        dict.fromkeys(CANDIDATES["report_delay"].names, 0.0) | {"delay_us": 400.0},
    )
    scene = Scene.of(played(BENCH, LATE, late_report))
    both = tuple(CANDIDATES[one.id] for one in (LATE, late_report))
    sizes = tuple(
        np.array([one.parameters[name] for name in candidate.names])
        for one, candidate in zip((LATE, late_report), both, strict=True)
    )
    model = Scored(Fit(both, sizes, frozenset(scene.streams)), 900.0, 900.0)

    found = places(scene, Finding(model), [], [])

    assert {place.stretch: place.effects for place in found} == {
        "latch": ("isr_latency",),
        "report": ("report_delay",),
    }


def test_what_effects_explain_stands_apart_from_what_is_left() -> None:
    shown = Place("latch", "skip", "latch_skip", "everywhere", 60.0, "µs", ("isr_latency",))
    rest = Place("position", "plc", "position", "goes with feed", 3.0, "µm")
    left = [Left("position", "plc", "shift", ("feed",), 3.0, "µm", 1.2, 0.33, 0.25, 9.5)]
    explained = told(Verdict.EXPLAINED, LATE, where=[shown])
    partly = told(Verdict.PARTLY_EXPLAINED, LATE, where=[shown, rest], left=left)
    unknown = told(Verdict.UNKNOWN, where=[rest], left=left)

    assert WHERE_SHOWN in as_text(explained)
    assert "latch    latch  skip   60.0 µs  everywhere  isr_latency" in as_text(explained)
    assert "is left" not in as_text(explained)
    assert "\n\nWhere something is left\nstretch " in as_text(partly)
    assert "\n\nWhere\nstretch " in as_text(unknown)
    assert where_table(partly).rows == [
        ("latch", "latch", "the skip path", "60.0 µs", "everywhere", "isr_latency")
    ]
    assert len(where_table(unknown).rows) == 1
    assert [place["effects"] for place in as_json(partly)["where"]] == [["isr_latency"], []]


def test_an_unknown_gap_names_what_came_closest_and_what_refused_it() -> None:
    scene = Scene.of(campaign())
    refused = [
        Failure("grows_nowhere", 0.0, "", "the gap grows: a"),
        Failure("takes_most", 0.5, "", "b"),
    ]

    said = notes(scene, Verdict.UNKNOWN, refused, [], closest=("isr_latency", "backlash"))
    without = notes(scene, Verdict.UNKNOWN, refused[:1], [])

    assert said[0] == (
        "Closest, but no finding: isr_latency + backlash, refused because the gap grows: a "
        "(rule grows_nowhere); b (rule takes_most)."
    )
    assert without[0] == "Not explained: the gap grows: a."
    assert as_json(told(Verdict.UNKNOWN, closest=("backlash",)))["closest"] == ["backlash"]


@pytest.mark.parametrize(
    ("gaps", "words"),
    [
        (
            [gap(0.7, 1.0, 1.0)],
            "400 touches are too few to be sure of all of it; about 1 800 of their kind would do",
        ),
        ([gap(0.7, 1.0, 1.0), gap(0.76, 0.9, 1.0)], "about 1 800 of their kind"),
        ([gap(0.1, 0.9, 1.0)], "as many as are looked at, 4000, may not do"),
        ([gap(0.2, 0.4, 1.0)], "but these touches show 40% of it go, and 80% would have to"),
        ([gap(-0.1, 0.2, 0.3)], "but no more than 30% of it goes"),
        ([], "but no gap stands out enough to see all of it go"),
    ],
)
def test_what_is_missing_is_told_of_a_gap_explained_in_part(gaps: list[Gap], words: str) -> None:
    failed = [Failure("shrinks", 0.8, "", "words")]
    named = {str(number): one for number, one in enumerate(gaps)}

    diagnosis = told(Verdict.PARTLY_EXPLAINED, LATE, gap=named, failures=failed)

    assert "The gap is explained in part: nothing is seen to be left, " in as_text(diagnosis)
    assert words in as_text(diagnosis)
    is_likely = all(one.shrink.value >= 0.8 for one in gaps)
    assert ("as far as these touches tell" in headline(diagnosis)) == is_likely


@pytest.mark.parametrize(
    ("far", "words"), [([], ""), ([7], "1 touch far off"), ([7, 9, 12], "3 touches far off")]
)
def test_no_gap_is_said_to_be_none_but_for_touches_far_off(far: list[int], words: str) -> None:
    diagnosis = told(Verdict.NO_GAP, outliers=far)

    for said in (as_text(diagnosis).splitlines()[0], headline(diagnosis)):
        assert said.startswith("No gap")
        assert (words in said) == bool(words or "far off" not in said)


def test_parameters_of_axes_that_are_not_there_are_not_in_the_document() -> None:
    sizes = {"backlash_um": 3.0, "positive_um": 0.0, "y_excess_ratio": 0.0, "z_excess_ratio": 0.5}
    play = Effect("backlash", sizes)
    ends = {**dict.fromkeys(sizes, (0.0, 4.0)), "y_excess_ratio": (-1000.0, 1000.0)}
    idle = frozenset({"y_excess_ratio", "z_excess_ratio"})
    diagnosis = told(Verdict.EXPLAINED, play)
    named = replace(diagnosis.effects[0], intervals=ends, idle=idle)

    document = as_json(replace(diagnosis, effects=[named]))

    (entry,) = document["effects"]
    assert set(entry["params"]) == set(entry["intervals"]) == set(sizes) - {"y_excess_ratio"}
    need_intervals(whole(document))
    (read,) = effects_from_json(document)
    assert read.parameters == {name: sizes[name] for name in entry["params"]}
    assert [one.id for one in adopted(document)] == ["backlash"]
    Rig(campaign().nominal, [read]).play(campaign().touches.select(slice(5)), seed=1, replicates=1)


def test_a_noise_floor_above_the_gap_is_explained() -> None:
    calm = {"a": gap(0.0, 0.0, 0.0, before=0.4)}
    unclear = {"a": replace(calm["a"], is_clear=False)}
    usual, low = (
        told(Verdict.EXPLAINED, LATE, gap=one) for one in ({"a": gap(1.0, 1.0, 1.0)}, calm)
    )

    assert "A score below it is luck, or the effects scatter more than" in as_text(low)
    assert "A score below it" not in as_text(usual)
    said = as_text(told(Verdict.EXPLAINED, LATE, gap=unclear))
    assert "0.400   1.00        0.500  below the noise floor" in said
    assert "A score below it" not in said
    page = as_html(campaign(), told(Verdict.NO_GAP, gap=calm), name="a", seed=1)
    assert "A score below it shows no gap in the mean" in page
