"""Campaigns of the withheld check that have more than an effect, or something that is none."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from skiplatch.campaign import (
    DatumFreedom,
    Nominal,
    format_nominal,
    read_campaign,
    read_nominal,
    read_touches,
)
from tests.withheld.beliefs import OFF_BY, SAME, uncertain, wrong_noise
from tests.withheld.cases import Drawn, draw_campaign
from tests.withheld.chain import Setup, play
from tests.withheld.conditions import Recording, draw_setup
from tests.withheld.datum import Datum, draw_datum
from tests.withheld.effects import EFFECTS
from tests.withheld.forms import Draw, Form
from tests.withheld.generate import main
from tests.withheld.orders import MENUS, Case, Order, orders
from tests.withheld.sizes import spreads
from tests.withheld.variants import AT_ONE_PLACE, NO_ONSET, draw_onset, draw_outliers

MACHINES = [Recording.STAMPED, Recording.POSITION]


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def rig(recording: Recording = Recording.STAMPED, seed: int = 0, touches: int = 300) -> Setup:
    return draw_setup(rng(seed), recording, (touches, touches))


def draw(case: Case, recording: Recording, *ids: str, seed: int = 5) -> Drawn:
    return draw_campaign(rng(seed), Order(case, recording, ids), (200, 300))


def form_of(effect: str, name: str, setup: Setup, size: float = 20.0) -> Form:
    return EFFECTS[effect].forms[name](Draw(rng(3), setup, size))


# ---- a datum that is off -------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_a_datum_that_is_off_shifts_all_deviations_of_its_kind_alike(seed: int) -> None:
    setup = rig(seed=seed)
    datum = draw_datum(rng(seed), setup)

    off, on = (play(setup, hooks, rng(9))[0] for hooks in ([datum.form.hooks], []))

    axis, touches = setup.nominal.axis, setup.touches
    # Below the feed another surface is met with another speed.
    at_feed = touches.approach_mm - 0.2 > touches.feed_mm_min**2 / (7200.0 * axis.accel_mm_s2)
    rows = touches.on_skip & at_feed
    shift = off.deviation_um - on.deviation_um
    assert shift[rows] == pytest.approx(datum.offset_um[rows], abs=1.01 * axis.resolution_um)
    assert np.abs(datum.offset_um).min() >= 1.0
    assert np.abs(datum.offset_um).max() <= 150.0
    later = (off.latch_us - on.latch_us)[rows]
    wanted = datum.offset_um / setup.feed_um_us if datum.moves_contact else 0.0 * on.latch_us
    assert later == pytest.approx(wanted[rows], rel=0.1, abs=1.01 * setup.nominal.skip.tick_us)


def test_a_surface_that_is_nearer_is_met_with_less_speed_while_the_axis_accelerates() -> None:
    setup = rig(seed=4)
    start_um = setup.touches.approach_mm * 1e3
    nearer = Datum(DatumFreedom.CAMPAIGN, True, np.full(len(start_um), -100.0))

    _, state = play(setup, [nearer.form.hooks], rng(9))

    reached = np.sqrt(2e-9 * setup.nominal.axis.accel_mm_s2 * (start_um - 100.0))
    assert (reached < setup.feed_um_us).any()
    assert state.speed_um_us == pytest.approx(np.minimum(setup.feed_um_us, reached))


def test_offsets_of_axis_and_sense_are_declared_and_others_are_not() -> None:
    for seed in range(12):
        drawn = draw(Case.DATUM, Recording.STAMPED, seed=seed)
        document = tomllib.loads(format_nominal(drawn.beliefs.nominal))
        free = drawn.parts[0].facts["free"]

        if free == DatumFreedom.AXIS_SENSE:
            assert document["format"] == "skiplatch-campaign/2"
            assert document["datum"] == {"free": "axis_sense"}
        else:
            assert document["format"] == "skiplatch-campaign/1"
            assert len(drawn.parts[0].facts["offsets_um"]) <= (
                3 if free == DatumFreedom.AXIS else 1
            )


# ---- beliefs -------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("recording", list(Recording))
def test_wrong_noise_is_off_by_a_factor_about_the_same_middle(
    seed: int, recording: Recording
) -> None:
    nominal = rig(recording, seed).nominal
    believed = wrong_noise(rng(seed), nominal, recording).nominal

    def jitters(one: Nominal) -> list[float]:
        return [one.probe.repeatability_um, one.skip.jitter_us, one.report.jitter_us]

    def middles(one: Nominal) -> list[float]:
        return [
            one.skip.latency_us + one.skip.jitter_us / 2,
            one.report.latency_us + one.report.jitter_us / 2,
        ]

    factors = [b / t for b, t in zip(jitters(believed), jitters(nominal), strict=True) if b != t]
    assert len(factors) == 1
    assert 0.6 <= factors[0] <= 1.6
    assert abs(np.log(factors[0])) > np.log(1.1)
    assert middles(believed) == pytest.approx(middles(nominal))


@pytest.mark.parametrize("effect", ["trigger_delay", "scan_period", "backlash", "report_delay"])
def test_uncertain_beliefs_are_off_by_about_what_stands_beside_them(effect: str) -> None:
    nominal = rig().nominal
    for seed in range(6):
        beliefs = uncertain(rng(seed), nominal, Recording.STAMPED, [effect])

        assert 2 <= len(beliefs.off) <= 3
        assert not set(beliefs.off) & SAME.get(effect, frozenset())
        for (section, key), true in beliefs.off.items():
            believed = getattr(getattr(beliefs.nominal, section), key)
            off = abs(believed - true) / beliefs.nominal.uncertainty[section, key]
            assert OFF_BY[0] - 0.01 <= off <= OFF_BY[1] + 0.01
            assert getattr(getattr(nominal, section), key) == true


# ---- an effect that begins or ends ---------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_onset_lies_well_within_the_campaign(seed: int) -> None:
    onset = draw_onset(rng(seed), 400)

    assert 0.15 * 400 - 1 <= onset.number <= 0.85 * 400
    assert onset.active[onset.number] == onset.begins
    assert onset.active[onset.number - 1] != onset.begins
    assert np.count_nonzero(np.diff(onset.active)) == 1


def without_noise(setup: Setup) -> Setup:
    """Leave nothing to chance but what the effect does, so that plays can be compared."""
    nominal = setup.nominal
    silent = replace(
        nominal,
        probe=replace(nominal.probe, repeatability_um=0.0),
        skip=replace(nominal.skip, jitter_us=0.0),
        report=replace(nominal.report, jitter_us=0.0),
    )
    return replace(setup, nominal=silent)


GATED = [
    (effect, next(iter(entry.forms))) for effect, entry in EFFECTS.items() if effect not in NO_ONSET
]


@pytest.mark.parametrize(("effect", "form"), [*GATED, ("scan_period", "limping")])
def test_effect_is_there_only_while_it_lasts(effect: str, form: str) -> None:
    setup = without_noise(rig(Recording.BENCH if EFFECTS[effect].on_bench else Recording.STAMPED))
    whole = form_of(effect, form, setup, size=100.0)
    onset = draw_onset(rng(1), len(setup.touches))

    none, always, gated = (
        play(setup, [one], rng(7))[1] for one in ({}, whole.hooks, onset.of(whole).hooks)
    )

    for name in ("contact_us", "latch_us", "read_us", "deviation_um", "stamp_us", "report_us"):
        wanted = np.where(onset.active, getattr(always, name), getattr(none, name))
        assert getattr(gated, name) == pytest.approx(wanted, nan_ok=True), name
    assert (gated.missed == np.where(onset.active, always.missed, none.missed)).all()


def test_onset_shows_and_is_told_in_the_label() -> None:
    drawn = draw(Case.ONSET, Recording.STAMPED, "backlash")

    (part,) = drawn.parts
    assert part.sizes.visible > 0.2
    assert 0.14 < part.facts["onset"]["touch"] / len(drawn.held_back) < 0.86


# ---- outliers, few touches, three effects --------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_outliers_are_few_gross_and_among_what_is_recorded(seed: int) -> None:
    setup = rig(seed=seed)
    among = rng(seed).random(300) < 0.66

    outliers = draw_outliers(rng(seed), setup, among)

    off = outliers.off_um[outliers.off_um != 0.0]
    step = setup.nominal.axis.resolution_um
    assert 1 <= len(off) <= 0.05 * np.count_nonzero(among)
    assert (np.abs(off) >= 10.0 - step).all()
    assert (np.abs(off) <= 300.0 + step).all()
    assert not outliers.off_um[~among].any()
    far = np.abs(outliers.off_um) > 10.0 * spreads(setup)["deviation_um"]
    assert (outliers.plain == far).all()


@pytest.mark.parametrize("ids", [(), ("scale_error",)])
def test_outliers_stand_in_the_record_and_in_no_play(ids: tuple[str, ...]) -> None:
    drawn = draw(Case.OUTLIERS, Recording.POSITION, *ids, seed=6)
    assert drawn.outliers is not None
    hit = drawn.outliers.plain

    middle = np.nanmedian(drawn.oracle["deviation_um"], axis=0)
    spread = np.nanstd(drawn.oracle_any_phase["deviation_um"], axis=0) + 0.1

    far = np.abs(drawn.outcomes.deviation_um - middle) / spread
    assert hit.any()
    assert far[hit].min() > 3.0
    assert not (drawn.outliers.off_um != 0.0)[drawn.held_back].any()
    assert drawn.order.verdict == ("explained" if ids else "no_gap")


@pytest.mark.parametrize("effect", ["trigger_delay", "scan_jitter"])
def test_few_touches_are_made_at_one_place(effect: str) -> None:
    drawn = draw(Case.SMALL, Recording.STAMPED, effect)
    touches = drawn.setup.touches

    for name in ("axis", "sign", "alpha_deg", "beta_deg", "position_mm", "rotary_deg"):
        assert len(np.unique(getattr(touches, name))) == 1, name
    assert 38 <= np.count_nonzero(~drawn.held_back) <= 92
    assert len(np.unique(touches.feed_mm_min)) > 1


def test_effects_of_a_place_are_not_looked_for_at_one() -> None:
    of_places = {"backlash", "scale_error", "transmission_error", "thermal_drift", "rotary_pivot"}

    assert not of_places & set(AT_ONE_PLACE)
    assert {"trigger_delay", "isr_latency", "scan_period"} <= set(AT_ONE_PLACE)


def test_three_effects_lie_in_three_stages() -> None:
    for order in orders(rng(), 30, list(Recording), [Case.THREE]):
        assert len(order.ids) == 3
        assert len({EFFECTS[effect].stage for effect in order.ids}) == 3
        assert order.ids == sorted(order.ids, key=list(EFFECTS).index)


def test_every_case_is_planned_with_what_it_is_made_of() -> None:
    planned = orders(rng(), 4 * len(Case), list(Recording), list(Case))

    assert {order.case for order in planned} == set(Case)
    for order in planned:
        menu = MENUS[order.case]
        assert order.recording in menu.kinds
        assert set(order.ids) <= set(menu.parts)
    with_outliers = [order for order in planned if order.case is Case.OUTLIERS]
    assert {len(order.ids) for order in with_outliers} <= {0, 1}


# ---- what is written -----------------------------------------------------------------------------

NEW = ("strangers", "datum", "wrong_noise", "outliers", "uncertain", "onset", "three", "small")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("cases")
    cases = ["--cases", ",".join(NEW), "--count", "8"]
    main([str(out), "--seed", "3", "--touches", "60", "90", *cases])
    return out


def labels(out: Path) -> dict[str, dict[str, Any]]:
    return {p.parent.name: json.loads(p.read_text()) for p in out.glob("sealed/*/label.json")}


def test_labels_say_what_should_be_said(written: Path) -> None:
    wanted = {
        "strangers": {"unknown"},
        "datum": {"no_gap"},
        "wrong_noise": {"no_gap"},
        "outliers": {"no_gap", "explained"},
    }
    for label in labels(written).values():
        assert label["verdict"] in wanted.get(label["case"], {"explained"})
        assert bool(label["effects"]) == (label["verdict"] == "explained")
        assert bool(label["beliefs_off"]) == (label["case"] in {"wrong_noise", "uncertain"})
        assert bool(label["outliers"]) == (label["case"] == "outliers")


def test_outliers_of_the_label_are_recorded_touches(written: Path) -> None:
    for name, label in labels(written).items():
        kept = read_touches(written / "campaigns" / name / "touches.csv")
        assert {one["touch"] for one in label["outliers"]} <= set(kept.touch)


def test_every_campaign_passes_the_reader(written: Path) -> None:
    versions = {
        label["case"]: read_campaign(written / "campaigns" / name).nominal.version
        for name, label in labels(written).items()
    }

    assert versions.pop("uncertain") == 2
    versions.pop("datum")  # of each axis and sense, or not
    assert set(versions.values()) == {1}


def test_the_sealed_rig_is_the_true_one(written: Path) -> None:
    for name, label in labels(written).items():
        true = read_nominal(written / "sealed" / name / "nominal.toml")
        believed = tomllib.loads((written / "campaigns" / name / "nominal.toml").read_text())
        for key, off in label["beliefs_off"].items():
            section, _, name_of = key.partition(".")
            value = believed[section][name_of]
            assert getattr(getattr(true, section), name_of) == off["true"]
            assert (value["value"] if isinstance(value, dict) else value) == off["believed"]


def test_a_coarse_clock_stamps_both_paths_and_skip_positions_alone() -> None:
    setup = rig(Recording.BENCH, seed=2)
    quiet = replace(setup.nominal, axis=replace(setup.nominal.axis, resolution_um=0.001))
    setup = replace(setup, nominal=quiet)
    form = form_of("timer_quantisation", "floor", setup, size=40.0)

    coarse, fine = (play(setup, hooks, rng(4)) for hooks in ([form.hooks], []))

    on_skip = setup.touches.on_skip
    early = fine[1].stamp_us - coarse[1].stamp_us
    moved = coarse[0].deviation_um - fine[0].deviation_um
    assert early[on_skip].max() > 5.0
    assert early[~on_skip].max() > 5.0
    assert moved[on_skip] == pytest.approx((-early * setup.feed_um_us)[on_skip], abs=0.01)
    assert moved[~on_skip] == pytest.approx(0.0 * moved[~on_skip], abs=0.01)
