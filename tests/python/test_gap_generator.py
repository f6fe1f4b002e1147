"""The withheld check's generator: its nominal chain, its effects, and what it writes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from skiplatch.campaign import (
    COLUMNS,
    CONDITIONS,
    AxisNominal,
    BenchNominal,
    ProbeNominal,
    ReportNominal,
    SkipNominal,
    Touches,
    read_campaign,
    read_conditions,
    read_touches,
)
from tests.withheld import conditions
from tests.withheld.cases import Drawn, draw_campaign
from tests.withheld.chain import Outcomes, Setup, State, play, travel_us
from tests.withheld.conditions import Recording
from tests.withheld.effects import EFFECTS
from tests.withheld.forms import Draw, Form
from tests.withheld.generate import main
from tests.withheld.orders import Case, Order, orders
from tests.withheld.parts import FAINTEST, recordings_for
from tests.withheld.strangers import DULL, STRANGERS

FORMS = [(effect, form) for effect, entry in EFFECTS.items() for form in entry.forms]
MEASURED_OUTCOMES = ("latch_us", "report_us", "deviation_um")
TIMED = ("scan_phase_lock", "timed moves")  # the only form that lies in the conditions
STAGES = ("motion", "probe", "link", "input", "latch", "scan", "position", "report")


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def draw_setup(recording: Recording, seed: int = 0, touches: int = 600) -> Setup:
    """Draw a setup with a tolerably fine resolution and the catalogue's usual touches."""
    return conditions.draw_setup(rng(seed), recording, (touches, touches))


def quiet(setup: Setup) -> Setup:
    """Take all noise out, and the rounding nearly, so that two plays can be compared."""
    nominal = setup.nominal
    probe = replace(nominal.probe, repeatability_um=0.0)
    skip = SkipNominal(nominal.skip.latency_us, 0.0, 0.25)
    silent = replace(
        nominal,
        probe=probe,
        skip=skip,
        report=ReportNominal(nominal.report.latency_us, 0.0),
        axis=AxisNominal(0.001, nominal.axis.accel_mm_s2),
        bench=BenchNominal(0.0),
    )
    return replace(setup, nominal=silent)


def make(effect: str, form: str, setup: Setup, size: float = 20.0, seed: int = 3) -> Form:
    return EFFECTS[effect].forms[form](Draw(rng(seed), setup, size))


def changed(a: Outcomes, b: Outcomes, column: str) -> np.typing.NDArray[np.bool_]:
    mask: np.typing.NDArray[np.bool_] = ~np.isclose(
        getattr(a, column), getattr(b, column), rtol=0.0, atol=2e-3, equal_nan=True
    )
    return mask


# ---- the nominal chain ---------------------------------------------------------------------------


def test_travel_of_a_long_and_of_a_short_move() -> None:
    accel = np.full(2, 1000e-9)  # 1000 mm/s²
    feed = np.full(2, 0.1)  # 100 mm/s, so that the ramp is 5 mm and 0.1 s long

    took = travel_us(np.array([10e3, 1.25e3]), feed, accel)

    assert took == pytest.approx([150e3, 50e3])


def test_short_move_touches_below_the_feed() -> None:
    setup = draw_setup(Recording.STAMPED)
    axis = AxisNominal(0.05, 100.0)
    setup = replace(setup, nominal=replace(setup.nominal, axis=axis))

    _, state = play(setup, [], rng())

    reachable_um_us = np.sqrt(2 * 100.0 * setup.touches.approach_mm) * 1e-3
    short = reachable_um_us < setup.feed_um_us
    assert short.any()
    assert not short.all()
    assert state.speed_um_us[short] == pytest.approx(reachable_um_us[short])
    assert state.speed_um_us[~short] == pytest.approx(setup.feed_um_us[~short])


@pytest.mark.parametrize("seed", range(4))
def test_bench_latches_skip_edges_within_the_believed_window(seed: int) -> None:
    setup = draw_setup(Recording.BENCH, seed)
    nominal = setup.nominal
    outcomes, _ = play(setup, [], rng(seed))
    noise = 6 * nominal.bench.reference_jitter_us  # beyond it once in 1e9

    after = (outcomes.latch_us - outcomes.edge_us)[setup.touches.on_skip]

    least = nominal.input.filter_us + nominal.skip.latency_us
    assert after.min() > least - nominal.skip.tick_us - noise
    assert after.max() < least + nominal.skip.jitter_us + noise
    assert np.ptp(after) > 0.6 * max(nominal.skip.jitter_us, nominal.skip.tick_us)


@pytest.mark.parametrize("recording", [Recording.BENCH, Recording.STAMPED])
def test_plc_latches_on_the_grid_of_its_scans_at_the_first_after_the_edge(
    recording: Recording,
) -> None:
    setup = draw_setup(recording)
    outcomes, state = play(setup, [], rng())
    on_plc = setup.touches.on_plc
    scan_us, tick_us = setup.nominal.plc.scan_us, setup.nominal.skip.tick_us

    below_grid = (setup.scan_phase_us - outcomes.latch_us[on_plc]) % scan_us
    wait = (state.latch_us - state.pin_us)[on_plc]

    assert ((below_grid < tick_us) | (below_grid > scan_us - 1e-2)).all()
    assert wait.min() >= 0.0
    assert wait.max() <= scan_us
    assert wait.mean() == pytest.approx(scan_us / 2, rel=0.15)  # beyond it once in 1e5


@pytest.mark.parametrize("recording", [Recording.BENCH, Recording.STAMPED])
def test_reports_arrive_within_the_believed_window(recording: Recording) -> None:
    setup = draw_setup(recording)
    report, tick_us = setup.nominal.report, setup.nominal.skip.tick_us

    outcomes, _ = play(setup, [], rng())

    after = outcomes.report_us - outcomes.latch_us
    assert after.min() >= report.latency_us - 1e-2
    assert after.max() <= report.latency_us + report.jitter_us + tick_us + 1e-2
    assert np.ptp(after) > 0.9 * report.jitter_us


def test_bench_edge_is_the_contact_and_the_reference_noise() -> None:
    setup = draw_setup(Recording.BENCH)

    outcomes, state = play(setup, [], rng())

    noise = outcomes.edge_us - state.contact_us
    sigma = setup.nominal.bench.reference_jitter_us
    assert noise.std() == pytest.approx(sigma, rel=0.15)  # beyond it once in 1e7
    assert abs(noise.mean()) < 5 * sigma / np.sqrt(len(noise))


@pytest.mark.parametrize("recording", list(Recording))
def test_deviation_is_the_travel_from_contact_to_latch_rounded(recording: Recording) -> None:
    setup = draw_setup(recording)
    resolution = setup.nominal.axis.resolution_um

    outcomes, state = play(setup, [], rng())

    travel = state.speed_um_us * (state.latch_us - state.contact_us)
    steps = outcomes.deviation_um / resolution
    assert np.abs(outcomes.deviation_um - travel).max() <= resolution / 2 + 1e-3
    assert steps == pytest.approx(np.round(steps), abs=1e-2)


def test_machine_deviation_is_the_pretravel_the_delays_and_the_repeatability() -> None:
    setup = draw_setup(Recording.STAMPED, touches=2000)
    probe = ProbeNominal(10.0, 3.0, 15.0, 0.3, 500.0)
    axis = AxisNominal(0.01, 5000.0)
    setup = replace(setup, nominal=replace(setup.nominal, probe=probe, axis=axis))
    t, skip = setup.touches, setup.nominal.skip

    outcomes, _ = play(setup, [], rng())

    azimuth = np.radians(3 * (t.alpha_deg - 15.0))
    pretravel = 10.0 + 3.0 * np.cos(np.radians(t.beta_deg)) * np.cos(azimuth)
    late_us = 500.0 + setup.nominal.input.filter_us + skip.latency_us + skip.jitter_us / 2
    rest = (outcomes.deviation_um - pretravel - t.feed_mm_min / 60e3 * late_us)[t.on_skip]
    assert abs(rest.mean()) < 5 * 0.3 / np.sqrt(len(rest))
    assert rest.std() == pytest.approx(0.3, rel=0.15)  # beyond it once in 1e5


def test_pretravel_is_never_negative() -> None:
    setup = draw_setup(Recording.STAMPED)
    probe = ProbeNominal(0.1, 3.0, 0.0, 0.0, 0.0)

    _, state = play(replace(setup, nominal=replace(setup.nominal, probe=probe)), [], rng())

    assert (state.pretravel_um < 0).any()
    assert (state.edge_us >= state.contact_us).all()


def test_pretravel_may_be_negative_in_version_2_of_the_format() -> None:
    setup = draw_setup(Recording.STAMPED)
    probe = ProbeNominal(0.1, 3.0, 0.0, 0.0, 0.0)
    nominal = replace(setup.nominal, probe=probe, version=2)

    _, state = play(replace(setup, nominal=nominal), [], rng())

    early = state.edge_us < state.contact_us
    assert (early == (state.pretravel_um < 0.0)).all()
    assert early.any()


# ---- the effects ---------------------------------------------------------------------------------


def test_all_of_the_catalogue_in_the_order_of_the_chain_in_several_forms() -> None:
    order = [STAGES.index(entry.stage) for entry in EFFECTS.values()]

    assert len(EFFECTS) == 27
    assert order == sorted(order)
    assert all(len(entry.forms) >= 3 for entry in EFFECTS.values())


def test_eight_strangers_or_more_and_none_of_them_in_the_catalogue() -> None:
    assert len(STRANGERS) >= 8
    assert not set(STRANGERS) & set(EFFECTS)
    assert not set(DULL) & {*EFFECTS, *STRANGERS}


def play_with_and_without(effect: str, form: str) -> tuple[Setup, Outcomes, Outcomes]:
    recording = Recording.BENCH if EFFECTS[effect].on_bench else Recording.STAMPED
    setup = draw_setup(recording)
    drawn = make(effect, form, setup, size=200.0)  # so that the PLC's scans see it too
    setup = quiet(setup)
    return setup, play(setup, [drawn.hooks], rng())[0], play(setup, [], rng(1))[0]


@pytest.mark.parametrize(("effect", "form"), [pair for pair in FORMS if pair != TIMED])
def test_effect_changes_its_paths_and_no_other(effect: str, form: str) -> None:
    setup, with_it, without = play_with_and_without(effect, form)

    any_changed = np.logical_or.reduce(
        [changed(with_it, without, column) for column in MEASURED_OUTCOMES]
    )

    paths = EFFECTS[effect].paths
    rows = {"skip": setup.touches.on_skip, "plc": setup.touches.on_plc}
    for path, on_path in rows.items():
        if path in paths:
            assert any_changed[on_path].mean() > 0.02, path
        else:
            assert not any_changed[on_path].any(), path


UNTOUCHED = {
    "timer_quantisation": ("report_us",),
    "timer_drift": ("report_us", "deviation_um"),
    "report_delay": ("latch_us", "deviation_um"),
    **{
        effect: ("latch_us", "report_us")
        for effect, entry in EFFECTS.items()
        if entry.stage == "position"
    },
}


@pytest.mark.parametrize(("effect", "form"), [pair for pair in FORMS if pair[0] in UNTOUCHED])
def test_effect_leaves_alone_what_lies_beside_it(effect: str, form: str) -> None:
    _, with_it, without = play_with_and_without(effect, form)

    for column in UNTOUCHED[effect]:
        assert not changed(with_it, without, column).any(), column


@pytest.mark.parametrize(
    ("effect", "form"),
    [
        pair
        for pair in FORMS
        if pair[0]
        in {
            "link_slotting",
            "link_retry",
            "contact_bounce",
            "isr_blocking",
            "input_image_delay",
            "report_delay",
        }
    ],
)
def test_waiting_makes_nothing_earlier(effect: str, form: str) -> None:
    _, with_it, without = play_with_and_without(effect, form)

    later = with_it.report_us - without.report_us
    assert later.min() > -1e-2
    assert later.max() > 1.0


@pytest.mark.parametrize("form", EFFECTS["scan_overrun"].forms)
def test_overruns_hit_now_and_then(form: str) -> None:
    setup, with_it, without = play_with_and_without("scan_overrun", form)

    later_us = (with_it.report_us - without.report_us)[setup.touches.on_plc]

    assert 0.02 < (np.abs(later_us) > 1.0).mean() < 0.8
    assert later_us.max() > 0.5 * setup.nominal.plc.scan_us
    assert later_us.mean() > 0.0  # an edge that a late scan just catches is latched earlier


@pytest.mark.parametrize("form", EFFECTS["lost_trigger"].forms)
def test_lost_triggers_are_missed_without_an_outcome(form: str) -> None:
    _, with_it, without = play_with_and_without("lost_trigger", form)

    missed = with_it.status == 1
    assert 0.0 < missed.mean() < 0.5
    assert np.isnan(with_it.deviation_um[missed]).all()
    assert not np.isnan(with_it.deviation_um[~missed]).any()
    assert (without.status == 0).all()


@pytest.mark.parametrize("form", EFFECTS["timer_drift"].forms)
def test_drifting_clock_agrees_at_the_start_and_departs(form: str) -> None:
    setup, with_it, without = play_with_and_without("timer_drift", form)

    off = np.abs(with_it.latch_us - without.latch_us)
    elapsed = setup.touches.time_s
    assert off[-1] > 5 * off[0]
    assert off / elapsed == pytest.approx(
        np.full(len(off), off[-1] / elapsed[-1]), rel=1.0, abs=1.0
    )


@pytest.mark.parametrize("form", EFFECTS["following_error"].forms)
def test_following_error_is_overtravel_that_grows_with_the_feed(form: str) -> None:
    setup, with_it, without = play_with_and_without("following_error", form)

    error = with_it.deviation_um - without.deviation_um
    slow, fast = np.quantile(setup.feed_um_us, [0.2, 0.8])
    assert error.min() >= -1e-2
    assert error[setup.feed_um_us >= fast].mean() > 3 * error[setup.feed_um_us <= slow].mean()


def mirrored(setup: Setup) -> Setup:
    """Make the same touches in the opposite sense."""
    touches = setup.touches
    turned = replace(touches, sign=-touches.sign, alpha_deg=touches.alpha_deg + 180.0)
    return replace(setup, touches=turned)


def errors(setup: Setup, form: Form) -> np.typing.NDArray[np.float64]:
    """Play the step of the position alone."""
    state = State(setup, rng())
    for hook in form.hooks.values():
        hook(state)
    return state.deviation_um


OF_THE_COORDINATE = {"transmission_error", "scale_error", "thermal_drift"}


@pytest.mark.parametrize(("effect", "form"), [p for p in FORMS if p[0] in OF_THE_COORDINATE])
def test_error_of_the_coordinate_takes_the_sign_of_the_motion(effect: str, form: str) -> None:
    setup = draw_setup(Recording.STAMPED)
    drawn = make(effect, form, setup)

    there, back = errors(setup, drawn), errors(mirrored(setup), drawn)

    assert np.abs(there).max() > 0.1
    assert there == pytest.approx(-back)


@pytest.mark.parametrize("form", EFFECTS["backlash"].forms)
def test_backlash_tells_the_senses_apart(form: str) -> None:
    setup = draw_setup(Recording.STAMPED)
    drawn = make("backlash", form, setup)

    there, back = errors(setup, drawn), errors(mirrored(setup), drawn)

    level = setup.touches.axis != 2
    assert (np.abs(there - back)[level] > 0.1).all()


def turned_table(setup: Setup, degrees: float) -> Setup:
    touches = setup.touches
    turned = replace(
        touches,
        alpha_deg=touches.alpha_deg + degrees,
        rotary_deg=touches.rotary_deg + degrees,
    )
    return replace(setup, touches=turned)


def test_pivot_turns_with_the_table() -> None:
    setup = draw_setup(Recording.STAMPED)
    plain = make("rotary_pivot", "plain", setup)
    other = make("rotary_pivot", "mirrored", setup)

    still, turned = errors(setup, plain), errors(turned_table(setup, 30.0), plain)

    assert np.abs(still).max() > 0.1
    assert turned == pytest.approx(still)
    assert errors(turned_table(setup, 30.0), other) != pytest.approx(errors(setup, other))


@pytest.mark.parametrize("form", EFFECTS["rotary_pivot"].forms)
def test_pivot_lies_in_the_plane_of_the_table(form: str) -> None:
    setup = draw_setup(Recording.STAMPED)
    drawn = make("rotary_pivot", form, setup)
    level, steep = (
        replace(setup, touches=replace(setup.touches, beta_deg=np.full(600, beta)))
        for beta in (0.0, 60.0)
    )

    assert errors(steep, drawn) == pytest.approx(0.5 * errors(level, drawn))


def test_pivot_zeroed_at_the_table_s_zero_errs_elsewhere_only() -> None:
    setup = draw_setup(Recording.STAMPED)

    error = errors(setup, make("rotary_pivot", "none at 0°", setup))

    at_zero = setup.touches.rotary_deg == 0.0
    assert np.abs(error[at_zero]).max() < 1e-9
    assert np.abs(error[~at_zero]).max() > 0.1


@pytest.mark.parametrize("form", EFFECTS["scan_phase_lock"].forms)
def test_locked_edges_do_not_wait_evenly(form: str) -> None:
    setup = draw_setup(Recording.BENCH, touches=1500)
    drawn = make("scan_phase_lock", form, setup)
    if drawn.delay_s is not None:
        setup = setup.retimed(drawn.delay_s)

    _, state = play(setup, [drawn.hooks], rng())

    share = ((state.latch_us - state.pin_us) / setup.nominal.plc.scan_us)[setup.touches.on_plc]
    counts, _ = np.histogram(share, bins=10, range=(0.0, 1.0))
    expected = len(share) / 10
    assert share.min() >= 0.0
    assert ((counts - expected) ** 2 / expected).sum() > 50  # evenly: once in 1e7


def test_timed_moves_keep_the_grid_of_the_scans() -> None:
    setup = quiet(draw_setup(Recording.BENCH))
    drawn = make(*TIMED, setup)
    assert drawn.delay_s is not None
    setup = setup.retimed(drawn.delay_s)

    outcomes, _ = play(setup, [drawn.hooks], rng())

    off = (
        outcomes.latch_us[setup.touches.on_plc] - setup.scan_phase_us
    ) % setup.nominal.plc.scan_us
    assert np.minimum(off, setup.nominal.plc.scan_us - off).max() < 0.3


# ---- campaigns -----------------------------------------------------------------------------------


def draw(case: Case, recording: Recording, *ids: str, seed: int = 5) -> Drawn:
    return draw_campaign(rng(seed), Order(case, recording, ids), (200, 300))


@pytest.mark.parametrize("stranger", STRANGERS)
def test_stranger_shows(stranger: str) -> None:
    for recording in recordings_for(stranger):
        drawn = draw(Case.STRANGER, recording, stranger)

        assert drawn.parts[0].sizes.visible >= FAINTEST


@pytest.mark.parametrize("dull", DULL)
def test_dull_variant_stays_below_a_spread(dull: str) -> None:
    for recording in recordings_for(dull):
        drawn = draw(Case.DULL, recording, dull)

        assert max(size.shift for size in drawn.parts[0].sizes.sizes) < 0.7


@pytest.mark.parametrize("recording", list(Recording))
def test_unchanged_chain_measures_no_size(recording: Recording) -> None:
    drawn = draw(Case.NONE, recording)
    oracle, nominal = drawn.oracle["deviation_um"], drawn.nominal["deviation_um"]

    assert drawn.parts == []
    assert oracle.mean() == pytest.approx(nominal.mean(), rel=0.02)
    assert (oracle != nominal).any()  # replicates of their own


def test_plays_at_any_phase_do_not_repeat_the_waits_of_the_record() -> None:
    drawn = draw(Case.NONE, Recording.BENCH)
    plc = drawn.setup.touches.on_plc
    recorded = drawn.outcomes.deviation_um[plc]

    def missed_by(plays: np.typing.NDArray[np.float64]) -> float:
        return float(np.median(np.abs(plays[:, plc] - recorded) / drawn.setup.feed_um_us[plc]))

    scan_us = drawn.setup.nominal.plc.scan_us
    assert missed_by(drawn.nominal["deviation_um"]) < 0.01 * scan_us
    assert missed_by(drawn.nominal_any_phase["deviation_um"]) > 0.1 * scan_us


def test_oracle_covers_the_truth_where_nominal_does_not() -> None:
    drawn = draw(Case.SINGLE, Recording.STAMPED, "scale_error", seed=8)
    truth = drawn.outcomes.deviation_um

    def covered(plays: np.typing.NDArray[np.float64]) -> float:
        return float(((plays.min(axis=0) <= truth) & (truth <= plays.max(axis=0))).mean())

    assert drawn.parts[0].sizes.visible > 2.0
    assert covered(drawn.oracle["deviation_um"]) > 0.9  # 48/51 are expected
    assert covered(drawn.nominal["deviation_um"]) < 0.7


def test_plan_takes_cases_and_effects_in_turns() -> None:
    planned = orders(rng(), 81, list(Recording), [Case.SINGLE, Case.TWO, Case.NONE])
    singles = [order.ids[0] for order in planned if order.case is Case.SINGLE]
    twos = [order for order in planned if order.case is Case.TWO]
    ranks = list(EFFECTS)

    assert sorted(singles) == sorted(EFFECTS)
    assert len(twos) == 27
    for order in planned:
        assert all(order.recording in recordings_for(part) for part in order.ids)
    for order in twos:
        assert ranks.index(order.ids[0]) < ranks.index(order.ids[1])


CERTAIN = ["--cases", "single,two,none,stranger,dull"]
"""Cases of the rig as it is believed to be."""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("gap")
    main([str(out), "--seed", "11", "--count", "10", "--touches", "60", "90", *CERTAIN])
    return out


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_sealed_files_stand_apart(written: Path) -> None:
    assert names(written) == {"campaigns", "sealed"}
    assert names(written / "campaigns") == names(written / "sealed")
    for folder in (written / "campaigns").iterdir():
        assert names(folder) == {"nominal.toml", "touches.csv", "conditions.csv"}
        plays = ("oracle", "nominal", "oracle_any_phase", "nominal_any_phase")
        sealed = {"label.json", "nominal.toml", "truth.csv", *(f"{name}.npz" for name in plays)}
        assert names(written / "sealed" / folder.name) == sealed


@pytest.mark.filterwarnings("error")
def test_campaigns_pass_the_reader_and_the_touches_are_parted(written: Path) -> None:
    for folder in (written / "campaigns").iterdir():
        label = json.loads((written / "sealed" / folder.name / "label.json").read_text())
        kept = read_campaign(folder)
        held_back = read_conditions(folder / "conditions.csv")
        truth = read_touches(written / "sealed" / folder.name / "truth.csv")
        header = (folder / "conditions.csv").read_text().splitlines()[0].split(",")

        assert header == [name for name in CONDITIONS if COLUMNS[name].since == 1]
        assert set(truth.touch) == set(held_back.touch)
        assert not set(held_back.touch) & set(kept.touches.touch)
        assert len(held_back) + len(kept.touches) == label["touches"]
        assert kept.nominal.kind == ("bench" if label["recording"] == "bench" else "machine")
        assert empty(kept.touches) >= set(label["not_recorded"])


def empty(touches: Touches) -> set[str]:
    columns = touches.columns()
    return {name for name in COLUMNS if (columns[name] == COLUMNS[name].empty).all()} | {
        name
        for name in COLUMNS
        if columns[name].dtype.kind == "f" and np.isnan(columns[name]).all()
    }


def test_bench_conditions_know_their_edges(tmp_path: Path) -> None:
    main(
        [str(tmp_path), "--seed", "3", "--count", "2", "--kinds", "bench", "--touches", "60", "90"]
    )

    for folder in (tmp_path / "campaigns").iterdir():
        held_back = read_conditions(folder / "conditions.csv")
        truth = read_touches(tmp_path / "sealed" / folder.name / "truth.csv")
        assert held_back.edge_us == pytest.approx(truth.edge_us)
        assert not np.isnan(held_back.edge_us).any()


def test_replicates_belong_to_the_held_back_touches(written: Path) -> None:
    for folder in (written / "sealed").iterdir():
        truth = read_touches(folder / "truth.csv")
        for file in ("oracle.npz", "nominal.npz"):
            with np.load(folder / file) as plays:
                assert (plays["touch"] == truth.touch).all()
                for column in MEASURED_OUTCOMES:
                    assert plays[column].shape == (50, len(truth))


def contents(out: Path) -> dict[str, bytes]:
    return {str(p.relative_to(out)): p.read_bytes() for p in out.rglob("*") if p.is_file()}


def test_same_seed_gives_the_same_bytes_and_another_one_others(
    written: Path, tmp_path: Path
) -> None:
    common = ["--count", "10", "--touches", "60", "90", *CERTAIN]
    main([str(tmp_path / "same"), "--seed", "11", *common])
    main([str(tmp_path / "other"), "--seed", "12", *common])

    same, other = contents(tmp_path / "same"), contents(tmp_path / "other")
    assert same == contents(written)
    assert same.keys() == other.keys()
    assert all(same[name] != other[name] for name in same if name.endswith("touches.csv"))


def test_another_seed_draws_other_campaigns_to_the_same_plan(tmp_path: Path) -> None:
    common = ["--count", "1", "--touches", "60", "90", "--cases", "none", "--kinds", "bench"]
    for seed in ("1", "2"):
        main([str(tmp_path / seed), "--seed", seed, *common])

    one, two = (read_campaign(tmp_path / seed / "campaigns" / "g0000") for seed in ("1", "2"))
    assert set(one.touches.time_s).isdisjoint(two.touches.time_s)


def test_only_the_asked_kinds_and_cases_are_made(tmp_path: Path) -> None:
    asked = ["--kinds", "position", "--cases", "stranger", "--touches", "60", "90"]
    main([str(tmp_path), "--seed", "1", "--count", "4", *asked])

    labels = [json.loads(p.read_text()) for p in (tmp_path / "sealed").glob("*/label.json")]
    assert len(labels) == 4
    assert {(label["recording"], label["case"], label["verdict"]) for label in labels} == {
        ("position", "stranger", "unknown")
    }
    assert all(label["note"] and not label["effects"] for label in labels)
