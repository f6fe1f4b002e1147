"""Strangers of the grammar: what they are drawn from; none is an effect of the catalogue."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.withheld.chain import Setup, play
from tests.withheld.conditions import Recording, draw_setup
from tests.withheld.effects import EFFECTS
from tests.withheld.forms import Draw
from tests.withheld.generate import main
from tests.withheld.geometry import SCALE_ERROR, THERMAL_DRIFT
from tests.withheld.grammar import Stranger, draw_stranger
from tests.withheld.grammar_apart import (
    LEAST_SHARE,
    scatter_apart,
    share_apart,
    shift_apart,
    size_of_shift,
)
from tests.withheld.grammar_causes import CAUSES, Family, Kind, rest_s, values_of
from tests.withheld.grammar_places import PLACES
from tests.withheld.grammar_rules import RULES, excluded
from tests.withheld.grammar_shapes import COURSES, Carrier, interaction

DRAWN = 240


def rig(recording: Recording = Recording.POSITION, seed: int = 1, touches: int = 400) -> Setup:
    return draw_setup(np.random.default_rng(seed), recording, (touches, touches))


def drawn(seed: int, recording: Recording) -> Stranger:
    rng = np.random.default_rng(seed)
    setup = draw_setup(rng, recording, (200, 400))
    stranger = draw_stranger(rng, setup, recording)
    assert stranger is not None
    return stranger


@pytest.fixture(scope="module")
def strangers() -> list[Stranger]:
    return [drawn(seed, list(Recording)[seed % 3]) for seed in range(DRAWN)]


def test_hardly_any_form_comes_twice(strangers: list[Stranger]) -> None:
    assert len({one.name for one in strangers}) > 0.8 * DRAWN


def test_every_place_family_and_carrier_comes(strangers: list[Stranger]) -> None:
    families = Counter(CAUSES[c].family for one in strangers for c in one.course.causes)
    places = {one.place for one in strangers}

    assert len(places) >= len(PLACES) - 2  # of two that rarely differ from an effect
    assert {one.carrier for one in strangers} == set(Carrier)
    assert all(families[family] > 0.1 * DRAWN for family in Family)


def test_most_are_well_above_the_noise_and_some_are_faint(strangers: list[Stranger]) -> None:
    sizes = np.array([one.size for one in strangers])

    assert np.mean(sizes >= 1.5) > 0.75
    assert np.mean(sizes < 1.5) > 0.03


def test_every_one_is_far_from_the_catalogue(strangers: list[Stranger]) -> None:
    for one in strangers:
        assert one.apart.is_far
        for cause in one.course.causes:
            assert excluded(one.place, cause, one.carrier, one.course.name) is None


def test_other_seeds_have_others() -> None:
    assert drawn(1001, Recording.BENCH).name != drawn(1004, Recording.BENCH).name


@pytest.mark.parametrize("name", CAUSES)
def test_cause_is_on_its_scale(name: str) -> None:
    setup = rig(Recording.STAMPED)
    values = values_of(CAUSES[name], Draw(np.random.default_rng(2), setup, 1.0))

    assert values.shape == (len(setup.touches),)
    assert values.min() >= 0.0
    if CAUSES[name].kind is Kind.LEVEL:
        assert set(np.unique(values)) <= {0.0, 1.0}
    elif CAUSES[name].kind is Kind.ANGLE:
        assert values.max() < 1.0
    else:
        assert np.quantile(values, 0.98) == pytest.approx(1.0)


def test_hidden_causes_are_new_at_every_draw_and_recorded_ones_are_not() -> None:
    setup = rig()

    def twice(name: str) -> bool:
        draws = (Draw(np.random.default_rng(seed), setup, 1.0) for seed in (1, 2))
        one, other = (values_of(CAUSES[name], draw) for draw in draws)
        return bool(np.array_equal(one, other))

    assert twice("temperature")
    assert twice("rest")
    assert not any(twice(name) for name, c in CAUSES.items() if c.family is Family.HIDDEN)


def test_rest_is_the_time_since_the_touch_before() -> None:
    setup = rig()

    rest = rest_s(setup.touches)

    assert rest[1:] == pytest.approx(np.diff(setup.touches.time_s))


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, courses in COURSES.items() for name in courses]
)
def test_course_runs_from_nothing_to_one(kind: Kind, name: str) -> None:
    rng = np.random.default_rng(3)
    values = rng.integers(2, size=500).astype(float) if kind is Kind.LEVEL else rng.random(500)

    course = COURSES[kind][name](Draw(rng, rig(), 1.0), values)

    assert course.min() >= 0.0
    assert course.max() <= 1.0
    assert np.ptp(course) > 0.5


def test_interaction_shows_in_neither_cause_alone() -> None:
    rng = np.random.default_rng(4)
    one, other = rng.random(2000), rng.integers(2, size=2000).astype(float)

    both = interaction(one, other)

    assert abs(np.corrcoef(both, one)[0, 1]) < 0.1
    assert abs(np.corrcoef(both, other)[0, 1]) < 0.1


# ---- what is no stranger -------------------------------------------------------------------------

EFFECT_SHIFTS = {
    "delay": lambda setup: setup.feed_um_us,
    "scale": lambda setup: setup.touches.sign * setup.touches.position_mm / 100.0,
    "warmth": lambda setup: setup.touches.sign * (setup.touches.temp_c - 20.0),
    "play": lambda setup: (setup.touches.sign > 0).astype(float),
    "lobes": lambda setup: (
        np.cos(np.radians(setup.touches.beta_deg))
        * np.cos(3 * np.radians(setup.touches.alpha_deg) + 1.0)
    ),
    "pivot": lambda setup: (
        np.cos(np.radians(setup.touches.beta_deg))
        * np.cos(np.radians(setup.touches.alpha_deg - setup.touches.rotary_deg) + 1.0)
    ),
}


@pytest.mark.parametrize("name", EFFECT_SHIFTS)
@pytest.mark.parametrize("seed", range(3))
def test_an_effect_of_the_catalogue_is_not_apart(name: str, seed: int) -> None:
    setup = rig(seed=seed)
    seen = PLACES["position"].see(setup, Recording.POSITION)

    apart = shift_apart(setup, seen, 100.0 * EFFECT_SHIFTS[name](setup))

    assert apart.share < 1e-6
    assert not apart.is_far


@pytest.mark.parametrize("forms", [SCALE_ERROR, THERMAL_DRIFT])
def test_forms_of_an_effect_are_near_to_it(forms: dict[str, object]) -> None:
    setup = rig()
    quiet = replace(setup.nominal, probe=replace(setup.nominal.probe, repeatability_um=0.0))
    setup = replace(setup, nominal=quiet)
    seen = PLACES["position"].see(setup, Recording.POSITION)
    effect = "scale_error" if forms is SCALE_ERROR else "thermal_drift"
    for make in EFFECTS[effect].forms.values():
        form = make(Draw(np.random.default_rng(5), setup, 30.0))
        both = [play(setup, hooks, np.random.default_rng(6))[0] for hooks in ([form.hooks], [])]

        shift = both[0].deviation_um - both[1].deviation_um

        assert shift_apart(setup, seen, shift).share < LEAST_SHARE


def test_the_datum_of_an_axis_is_no_size() -> None:
    setup = rig()
    seen = PLACES["position"].see(setup, Recording.POSITION)

    per_axis = np.asarray(50.0 + 20.0 * setup.touches.axis, np.float64)

    assert size_of_shift(setup, seen, per_axis) == pytest.approx(0.0, abs=1e-6)


def test_what_goes_with_the_rest_is_apart() -> None:
    setup = rig()
    seen = PLACES["position"].see(setup, Recording.POSITION)

    assert shift_apart(setup, seen, rest_s(setup.touches)).is_far


def test_scatter_is_apart_if_it_goes_with_something() -> None:
    setup = rig()
    seen = PLACES["position"].see(setup, Recording.POSITION)
    even, with_speed = np.ones(len(setup.touches)), 100.0 * setup.feed_um_us
    with_rest = np.asarray(rest_s(setup.touches) > 6.0, np.float64)

    assert not scatter_apart(setup, seen, even).is_far
    assert not scatter_apart(setup, seen, with_speed).is_far
    assert scatter_apart(setup, seen, 5.0 * with_rest).is_far


def test_what_befalls_touches_is_apart_if_it_goes_with_something() -> None:
    setup = rig()
    seen = PLACES["position"].see(setup, Recording.POSITION)
    every_fifth = (np.arange(400) % 5 == 0).astype(float)

    assert not share_apart(seen, np.full(400, 0.2)).is_far
    assert share_apart(seen, 0.6 * every_fifth).is_far


@pytest.mark.parametrize(
    ("place", "cause", "course"),
    [
        ("position", "sign", "level"),
        ("position", "axis", "level"),
        ("coordinate", "position", "straight"),
        ("coordinate", "position", "wave"),
        ("position", "temperature", "straight"),
        ("pretravel", "feed", "straight"),
        ("delay", "time", "straight"),
        ("clock", "time", "straight"),
        ("feed", "approach", "power"),
    ],
)
def test_forms_that_an_effect_has_are_none(place: str, cause: str, course: str) -> None:
    assert excluded(place, cause, Carrier.SHIFT, course)
    assert excluded("position", "rest", Carrier.SHIFT, course) is None


def test_rules_speak_of_what_there_is() -> None:
    for rule in RULES:
        assert rule.places <= set(PLACES)
        assert rule.causes <= set(CAUSES)
        assert rule.reason


# ---- campaigns -----------------------------------------------------------------------------------


def test_stranger_is_written_with_its_label(tmp_path: Path) -> None:
    asked = ["--cases", "strangers", "--touches", "60", "90", "--count", "3", "--seed", "4"]
    main([str(tmp_path), *asked])
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.csv")}
    main([str(tmp_path), *asked])

    for path in (tmp_path / "sealed").glob("*/label.json"):
        label = json.loads(path.read_text())
        part = label["parts"][0]
        assert (label["case"], label["verdict"], label["effects"]) == ("strangers", "unknown", [])
        assert part["place"] in PLACES
        assert set(part["causes"]) <= set(CAUSES)
        assert part["size"] > 0.0
        assert part["nats_left"] >= 30.0
    assert before == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.csv")}


def test_campaign_that_was_left_half_written_is_written_anew(tmp_path: Path) -> None:
    asked = ["--cases", "strangers", "--touches", "60", "90", "--count", "1", "--seed", "4"]
    main([str(tmp_path), *asked])
    last = tmp_path / "sealed" / "g0000" / "nominal_any_phase.npz"
    whole = last.read_bytes()
    last.unlink()
    main([str(tmp_path), *asked])

    assert last.read_bytes() == whole
