"""``skiplatch check``: what cannot be as it stands, what is missing, what was not varied."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch.api.work import simulate
from skiplatch.arrays import FloatArray
from skiplatch.campaign import Axis, Campaign, InputPath, Touches, read_campaign, write_campaign
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.campaign.plausibility import oddities
from skiplatch.campaign.steps import common_step
from skiplatch.campaign.telling import cannot_be_told, missing_columns, missing_keys
from skiplatch.cli import group
from skiplatch.stand_ins import playable

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"

Change = Callable[[Touches], Touches]


def lines(campaign: Campaign, change: Change) -> list[str]:
    changed = replace(campaign, touches=change(campaign.touches))
    return [oddity.line for oddity in oddities(changed)]


@pytest.mark.parametrize(
    "sample",
    ["bench_isr_latency", "machine_no_gap", "rig_nominal", "rig_debounce", "rig_bus_load"],
)
def test_recorded_samples_are_not_odd(sample: str) -> None:
    assert oddities(read_campaign(SAMPLES / sample)) == []


def test_a_move_before_the_end_of_the_one_before_is_told(machine_sample: Path) -> None:
    def early(touches: Touches) -> Touches:
        time_s = touches.time_s.copy()
        time_s[28] = time_s[27] + 5.0
        return replace(touches, time_s=time_s)

    (line,) = lines(read_campaign(machine_sample), early)

    assert line.startswith("time_s lies before the end of the move before, by feed_mm_min and ")
    assert line.endswith(": touch 43")


@pytest.mark.parametrize("sample", ["bench_isr_latency", "machine_no_gap"])
def test_what_is_played_of_a_sample_is_not_odd(sample: str) -> None:
    played = simulate(read_campaign(SAMPLES / sample), seed=1)

    assert oddities(played) == []


@pytest.mark.parametrize("scale", ["1000", "1/1000", "1/1,000,000"])
@pytest.mark.parametrize("name", ["edge_us", "latch_us", "report_us"])
def test_clock_in_another_unit_is_told(bench_sample: Path, name: str, scale: str) -> None:
    factor = {"1000": 1e3, "1/1000": 1e-3, "1/1,000,000": 1e-6}[scale]
    found = lines(
        read_campaign(bench_sample), lambda t: replace(t, **{name: getattr(t, name) * factor})
    )

    assert f"{name} runs {scale} times as fast as time_s: another unit?" in found


@pytest.mark.parametrize(
    ("name", "factor", "words"),
    [
        ("feed_mm_min", 1 / 60.0, "the time of the approach is 1/60 times"),
        ("feed_mm_min", 1 / 25.4, "the time of the approach is 1/25.4 times"),
        ("approach_mm", 1e3, "the time of the approach is 1/1000 times"),
        ("deviation_um", 1e-3, "deviation_um is 1/1000 times what latch_us and feed_mm_min let"),
        ("deviation_um", 1 / 25.4, "deviation_um is 1/25.4 times"),
    ],
)
def test_length_in_another_unit_is_told(
    bench_sample: Path, name: str, factor: float, words: str
) -> None:
    found = lines(
        read_campaign(bench_sample), lambda t: replace(t, **{name: getattr(t, name) * factor})
    )

    assert any(line.startswith(words) for line in found), found


def test_deviations_in_millimetres_are_told_by_their_step(machine_sample: Path) -> None:
    found = lines(
        read_campaign(machine_sample), lambda t: replace(t, deviation_um=t.deviation_um / 1e3)
    )

    assert found == [
        "deviation_um goes in steps of 0.0005, 1/1000 times axis.resolution_um = 0.5: another unit?"
    ]


def test_clock_that_runs_backwards_is_told_with_its_touches(bench_sample: Path) -> None:
    campaign = read_campaign(bench_sample)
    order = np.argsort(campaign.touches.time_s)
    latch_us = campaign.touches.latch_us.copy()
    latch_us[order[10]] = latch_us[order[9]] - 1000.0

    found = lines(campaign, lambda t: replace(t, latch_us=latch_us))

    touch = campaign.touches.touch[order[10]]
    assert f"latch_us runs backwards: touch {touch}" in found
    assert any(line.startswith("latch_us lies before edge_us: touch") for line in found)


def test_times_that_run_backwards_are_told_once(bench_sample: Path) -> None:
    campaign = read_campaign(bench_sample)

    def turned(touches: Touches) -> Touches:
        skip = touches.select(touches.on_skip).in_order_of_time()
        rows = np.arange(len(skip))
        rows[5], rows[6] = 6, 5
        return skip.select(rows)

    touch = turned(campaign.touches).touch[6]
    said = "time_s runs backwards from row to row; touches are taken in order of time"
    assert f"{said}: touch {touch}" in lines(campaign, turned)
    assert not any(said in line for line in lines(campaign, Touches.in_order_of_time))


def test_paths_that_latch_the_same_edges_have_an_order_each(bench_sample: Path) -> None:
    touches = read_campaign(bench_sample).touches.in_order_of_time()
    n = len(touches) // 2 * 2
    edge_us = np.repeat(touches.time_s[: n // 2] * 1e6 + 1e5, 2)
    path = np.tile([InputPath.PLC, InputPath.SKIP], n // 2)
    late_us = np.where(path == InputPath.PLC, 3000.0, 40.0)
    both = replace(
        touches.select(np.arange(n)),
        time_s=np.full(n, np.nan),
        path=path,
        edge_us=edge_us,
        latch_us=edge_us + late_us,
        report_us=edge_us + late_us + 500.0,
    )
    campaign = replace(read_campaign(bench_sample), touches=both)

    assert not any("backwards" in o.what for o in oddities(campaign))
    one = replace(both, path=np.full(n, InputPath.SKIP))
    assert any("backwards" in o.what for o in oddities(replace(campaign, touches=one)))


def test_new_session_may_set_its_clock_anew(bench_sample: Path) -> None:
    touches = read_campaign(bench_sample).touches.in_order_of_time()
    late = np.arange(len(touches)) >= 200
    again = replace(
        touches,
        latch_us=np.where(late, touches.latch_us - 1e9, touches.latch_us),
        report_us=np.full(len(touches), np.nan),
        edge_us=np.full(len(touches), np.nan),
        session=late.astype(np.int64),
        session_names=("a", "b"),
    )
    campaign = replace(read_campaign(bench_sample), touches=again)

    assert not any("backwards" in o.what for o in oddities(campaign))
    one = replace(again, session=again.session * 0)
    assert any("backwards" in o.what for o in oddities(replace(campaign, touches=one)))


def test_equal_stamps_are_told(bench_sample: Path) -> None:
    campaign = read_campaign(bench_sample)
    edge_us = campaign.touches.edge_us.copy()
    edge_us[:10] = edge_us[0]

    found = lines(campaign, lambda t: replace(t, edge_us=edge_us))

    shown = ", ".join(str(touch) for touch in campaign.touches.touch[1:7])
    assert f"edge_us stands there more than once: touches {shown} and 3 more" in found


def test_scatter_hidden_by_a_step_is_told(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    touches = Touches.from_columns(
        touch=np.arange(40),
        feed_mm_min=np.full(40, 60.0),
        deviation_um=np.where(np.arange(40) % 3, 12.5, np.where(np.arange(40) % 2, 0.0, 25.0)),
    )

    found = lines(campaign, lambda _: touches)

    assert any("40 touches in the same conditions have 3 values, steps of 12.5" in f for f in found)


def test_no_scatter_at_all_is_told(machine_sample: Path) -> None:
    touches = Touches.from_columns(touch=np.arange(9), deviation_um=np.full(9, 4.0))

    (found,) = lines(read_campaign(machine_sample), lambda _: touches)

    assert "9 touches in the same conditions have 1 values, one value, 4 µm" in found


@pytest.mark.parametrize(
    ("values", "step"),
    [
        ([0.0, 0.5, 1.5, 0.5, 0.0, 1.5], 0.5),
        ([1.0, 1.1, 1.3, 1.1, 1.0, 1.3, np.nan], 0.1),
        ([0.013, 0.5, 1.47, 2.1, 0.9], None),
        ([3.0, 3.0, 3.0], None),
    ],
)
def test_step_shows_where_values_repeat(values: list[float], step: float | None) -> None:
    found = common_step(np.array(values))

    assert found == (step if step is None else pytest.approx(step))


def test_bare_machine_says_all_that_is_missing(tmp_path: Path) -> None:
    (tmp_path / "nominal.toml").write_text('format = "skiplatch-campaign/2"\n')
    (tmp_path / "touches.csv").write_text("touch,feed_mm_min,deviation_um\n1,60,3.1\n2,60,4.7\n")
    campaign = read_campaign(tmp_path)

    assert list(missing_columns(campaign)) == [
        *("time_s", "axis", "sign", "alpha_deg", "beta_deg", "approach_mm"),
        *("position_mm", "temp_c", "latch_us", "report_us"),
    ]
    assert "plc.scan_us" not in missing_keys(campaign)
    assert missing_keys(campaign)["axis.resolution_um"].startswith("rounding of the positions")
    assert cannot_be_told(campaign) == [
        "one feed: a delay and a length look alike; touch at a second feed",
        "2 touches: only what stands far out of the scatter shows",
        "no times: the order of the rows counts as that of the touches",
    ]


def test_times_that_are_missing_here_and_there_are_said(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    time_s = np.where(np.arange(len(campaign.touches)) < 3, np.nan, campaign.touches.time_s)

    some = replace(campaign, touches=replace(campaign.touches, time_s=time_s))

    said = "no time of 3 touches: each counts as made after the row before it"
    assert said in cannot_be_told(some)
    assert not any("time" in line for line in cannot_be_told(campaign))


def test_command_says_and_writes_it(bench_sample: Path, tmp_path: Path) -> None:
    campaign = read_campaign(bench_sample)
    wrong = replace(campaign.touches, feed_mm_min=campaign.touches.feed_mm_min / 60.0)
    write_campaign(tmp_path / "wrong", campaign.nominal, wrong)
    out = tmp_path / "check.json"

    result = CliRunner().invoke(group, ["check", str(tmp_path / "wrong"), "--json", str(out)])

    assert result.exit_code == 0
    assert "\nOdd\n  the time of the approach is 1/60 times" in result.output
    document = json.loads(out.read_text())
    assert document["touches"] == 400
    assert document["odd"][0]["touches"] == []
    assert document["missing_columns"] == {}


def test_figure_that_cannot_be_simulated_is_odd(tmp_path: Path) -> None:
    for name in ("nominal.toml", "touches.csv"):
        text = (SAMPLES / "bench_isr_latency" / name).read_text()
        (tmp_path / name).write_text(re.sub(r"scan_us = .*", "scan_us = 2.0", text))

    said = CliRunner().invoke(group, ["check", str(tmp_path)]).output

    assert "nominal.toml: plc.scan_us: expected 100 to 20000" in said
    assert "got 2" in said


def test_a_rotary_axis_misses_no_column_of_a_linear_one(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    turned = Touches.from_columns(
        touch=np.arange(30),
        axis=np.full(30, Axis.C),
        position_deg=np.linspace(0.0, 90.0, 30),
        deviation_arcsec=np.zeros(30),
    )

    missing = missing_columns(replace(campaign, touches=turned))

    assert not {"position_mm", "deviation_um"} & set(missing)
    assert "feed_mm_min" in missing


@pytest.mark.parametrize("factor", [1e-3, 1 / 60.0, 1 / 25.4])
def test_a_feed_that_leaves_the_moves_no_time_is_told(machine_sample: Path, factor: float) -> None:
    found = lines(
        read_campaign(machine_sample), lambda t: replace(t, feed_mm_min=t.feed_mm_min * factor)
    )

    assert any(
        re.match(r"the moves take \S+ s by feed_mm_min and approach_mm, and", f) for f in found
    )


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda c: c + 273.15, "temp_c is not from -20 to 60 °C, as in a shop: kelvin?: touches"),
        (lambda c: c * 1.8 + 32.0, "temp_c is not from -20 to 60 °C, as in a shop: touches"),
    ],
    ids=["kelvin", "fahrenheit"],
)
def test_a_temperature_of_no_shop_is_told(
    machine_sample: Path, change: Callable[[FloatArray], FloatArray], told: str
) -> None:
    found = lines(
        read_campaign(machine_sample), lambda t: replace(t, temp_c=change(np.full(len(t), 20.5)))
    )

    assert any(line.startswith(told) for line in found), found


def test_a_thermometer_on_a_heated_bed_is_not_odd(machine_sample: Path) -> None:
    bed = {"bed": np.full(len(read_campaign(machine_sample).touches), 110.0)}

    assert lines(read_campaign(machine_sample), lambda t: replace(t, thermometers=bed)) == []


@pytest.mark.parametrize(
    ("place", "is_odd"),
    [("heater_bed", False), ("extruder", False), ("nozzle_2", False), ("frame", True)],
)
def test_a_part_that_is_heated_may_stand_for_the_machine(
    machine_sample: Path, place: str, *, is_odd: bool
) -> None:
    hot = np.full(len(read_campaign(machine_sample).touches), 80.0)

    found = lines(
        read_campaign(machine_sample), lambda t: replace(t, temp_c=hot, thermometers={place: hot})
    )

    assert any("as in a shop" in line for line in found) == is_odd


def surfaces(places_mm: FloatArray, deviations_um: FloatArray) -> Touches:
    return Touches.from_columns(
        touch=np.arange(len(places_mm)),
        position_mm=places_mm,
        deviation_um=deviations_um,
    )


def test_swapped_columns_are_told(machine_sample: Path) -> None:
    places_mm = np.tile([-171.757, 40.0, 95.5], 6)
    scatter_um = np.random.default_rng(3).normal(12.0, 1.5, 18)
    campaign = read_campaign(machine_sample)

    told = "deviation_um comes back to the digit, and position_mm scatters: swapped columns?"
    assert told in lines(campaign, lambda _: surfaces(scatter_um, places_mm))
    assert told not in lines(campaign, lambda _: surfaces(places_mm, scatter_um))


@pytest.mark.parametrize("believed_um", [8.8, 0.5])
def test_a_coarse_encoder_is_no_swap(machine_sample: Path, believed_um: float) -> None:
    campaign = read_campaign(machine_sample)
    axis = replace(campaign.nominal.axis, resolution_um=believed_um)
    counts_um = np.tile([0.0, 8.8, 17.6], 6)
    touches = surfaces(np.linspace(0.0, 100.0, 18), counts_um)

    found = oddities(
        replace(campaign, nominal=replace(campaign.nominal, axis=axis), touches=touches)
    )

    assert not any("swapped" in oddity.what for oddity in found)


@pytest.mark.filterwarnings("ignore:.*time_s")
def test_times_that_stand_in_are_held_against_no_move(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    touches = Touches.from_columns(
        touch=np.arange(8),
        sign=np.full(8, -1, dtype=np.int8),
        feed_mm_min=np.full(8, 420.0),
        approach_mm=np.array([150.0, *[10.0] * 7]),
        deviation_um=np.array([1.0, 2.0, 0.0, 3.0, 1.5, 2.5, 0.5, 4.0]),
    )

    found = oddities(playable(replace(campaign, touches=touches)))

    assert not any("the moves take" in oddity.what for oddity in found)


def test_what_an_axis_cannot_do_is_told(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    axis = replace(campaign.nominal.axis, min_mm=-300.0, max_mm=300.0)
    touches = Touches.from_columns(
        touch=np.arange(5),
        axis=np.array([Axis.X, Axis.X, Axis.A, Axis.A, Axis.X], dtype=np.int8),
        position_mm=np.array([0.0, 301.0, np.nan, np.nan, 0.0]),
        position_deg=np.array([np.nan, np.nan, 10.0, 10.0, np.nan]),
        approach_mm=np.full(5, 2.0),
        deviation_um=np.array([1.0, 1.0, 1.0, 10.0, -2001.0]),
        deviation_arcsec=np.array([5.0, np.nan, 3.6, 5.0, np.nan]),
    )
    bounded = replace(campaign.nominal, version=2, axis=axis)

    found = [odd.line for odd in oddities(replace(campaign, nominal=bounded, touches=touches))]

    assert found == [
        "deviation_arcsec of an axis that does not turn: touch 0",
        "deviation_arcsec is not deviation_um at 0.001° for 1 µm: of which is it?: touch 3",
        "position_mm is not from axis.min_mm to axis.max_mm: touch 1",
        "deviation_um lies before the start of the move, approach_mm from the surface: touch 4",
    ]


@pytest.mark.parametrize("path", ["skip", "plc"])
@pytest.mark.parametrize(("touched", "told"), [(3, "touch 0"), (2, "touches 0, 1")])
def test_a_touch_far_from_the_others_is_told_but_for_a_late_scan(
    machine_sample: Path, path: str, touched: int, told: str
) -> None:
    """Of two touches nobody knows which is the one."""
    campaign = read_campaign(machine_sample)
    slow = replace(campaign.nominal, plc=replace(campaign.nominal.plc, scan_us=20_000.0))
    touches = Touches.from_columns(
        touch=np.arange(touched),
        path=np.full(touched, InputPath[path.upper()], dtype=np.int8),
        feed_mm_min=np.full(touched, 3000.0),
        approach_mm=np.full(touched, 5.0),
        deviation_um=np.array([900.0, 0.0, 0.0])[:touched],  # a scan takes 1 mm
    )

    found = oddities(replace(campaign, nominal=slow, touches=touches))

    said = [odd.line.partition("probe?: ")[2] for odd in found if "0.5 mm" in odd.what]
    assert said == ([told] if path == "skip" else [])


def test_touches_without_an_outcome_vary_nothing(machine_sample: Path) -> None:
    """A mesh probed at a speed of its own, each place once, tells no delay from a length."""
    campaign = read_campaign(machine_sample)
    touches = Touches.from_columns(
        touch=np.arange(4),
        feed_mm_min=np.array([300.0, 300.0, 120.0, 120.0]),
        deviation_um=np.array([np.nan, np.nan, 1.0, 2.0]),
    )

    said = cannot_be_told(replace(campaign, touches=touches))

    assert any(line.startswith("one feed: a delay and a length look alike") for line in said)


@pytest.mark.parametrize(
    ("free", "u_um", "walls", "is_said"),
    [
        ("session", None, ["left", "right"], True),
        ("axis", None, ["left", "right"], True),
        ("axis_sense", None, ["bore", "bore"], True),
        ("axis", None, ["bore", "bore"], False),
        ("session", 2.0, ["left", "right"], False),
        ("none", None, ["left", "right"], False),
    ],
)
def test_walls_that_may_lie_anywhere_hide_a_backlash(
    machine_sample: Path, free: str, u_um: float | None, walls: list[str], is_said: bool
) -> None:
    campaign = read_campaign(machine_sample)
    nominal = replace(campaign.nominal, datum=Datum(DatumFreedom(free), u_um))
    touches = Touches.from_columns(
        touch=np.arange(8),
        axis=np.full(8, Axis.X),
        sign=np.tile([1.0, -1.0], 4),
        deviation_um=np.arange(8.0),
        session=np.tile(walls, 4),
    )

    said = cannot_be_told(replace(campaign, nominal=nominal, touches=touches))

    assert any(line.startswith("each surface is met in one sense") for line in said) == is_said
