"""``skiplatch repeat``: what repeated touches show with nothing believed of the rig."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.campaign import (
    Axis,
    Campaign,
    InputPath,
    Touches,
    read_campaign,
    write_nominal,
    write_touches,
)
from skiplatch.campaign.datum import Datum, DatumFreedom
from skiplatch.cli import group
from skiplatch.commands.repeat import OPTIONS_OF_IMPORT, as_json
from skiplatch.errors import InputError
from skiplatch.importing.detect import read_any
from skiplatch.repeatability import Repeatability, repeatability
from skiplatch.repeatability_words import sentence
from skiplatch.statistics import Interval

LOGS = Path(__file__).parent / "data" / "logs"
SIGMA_UM = 2.0


def of(machine_sample: Path, deviation_um: np.ndarray, **columns: np.ndarray) -> Repeatability:
    touches = Touches.from_columns(
        touch=np.arange(len(deviation_um)), deviation_um=deviation_um, **columns
    )
    return repeatability(replace(read_campaign(machine_sample), touches=touches))


def noise(n: int, seed: int = 5) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, SIGMA_UM, n)


def holds(figure: Interval | None, truth: float) -> bool:
    return figure is not None and figure.low <= truth <= figure.high


def test_plain_scatter_is_found_and_nothing_else(machine_sample: Path) -> None:
    found = of(machine_sample, 40.0 + noise(60))

    assert holds(found.sigma, SIGMA_UM)
    assert holds(found.mean, 40.0)
    assert holds(found.drift, 0.0)
    assert holds(found.first, 0.0)
    assert found.slope is None
    assert found.outliers == ()
    assert sentence(found).count(";") == 0


def test_runs_of_an_iso_table_repeat_and_keep_their_reversal_error(tmp_path: Path) -> None:
    noise_um = np.random.default_rng(1).normal(0.0, 0.2, (4, 10))
    heads = ";".join(f"{run} {sense}" for run in range(1, 6) for sense in "↑↓")
    rows = [
        ";".join([str(100 * place), *(f"{off + 4.0 * (i % 2):.2f}" for i, off in enumerate(row))])
        for place, row in enumerate(noise_um)
    ]
    (tmp_path / "x.csv").write_text("\n".join([f"mm;{heads}", *rows]) + "\n")
    made = tmp_path / "made"

    words = ["import", "iso230", str(tmp_path / "x.csv"), "--feed", "600", "-o", str(made)]
    result = CliRunner().invoke(group, words, catch_exceptions=False)
    campaign = read_campaign(made)
    found = repeatability(campaign)

    assert result.exit_code == 0
    assert found.surfaces == 8
    assert holds(found.sigma, 0.2)
    up = campaign.touches.sign > 0.0
    reversal_um = (
        -campaign.touches.deviation_um[~up].mean() - campaign.touches.deviation_um[up].mean()
    )
    assert reversal_um == pytest.approx(4.0, abs=0.2)
    assert len(campaign.touches.session_names) == 1


def test_rounding_of_stamps_is_no_step(bench_sample: Path) -> None:
    edge_us = np.arange(20) * 1_000_000.1
    waits_us = np.where(np.arange(20) % 2, 62.952, 63.052)
    touches = Touches.from_columns(
        touch=np.arange(20), edge_us=edge_us, latch_us=edge_us + waits_us
    )

    found = repeatability(replace(read_campaign(bench_sample), touches=touches))

    assert len(set(touches.latch_us - edge_us)) > 2  # by what a number of 64 bits cannot hold
    assert found.step is None


def test_a_rotary_axis_repeats_in_arcsec(machine_sample: Path) -> None:
    n = 60
    feed_deg_min = np.where(np.arange(n) % 2, 600.0, 120.0)
    late_arcsec = 3.0 * feed_deg_min * 3600.0 / 60_000.0  # by 3 ms
    touches = Touches.from_columns(
        touch=np.arange(n),
        axis=np.full(n, Axis.B),
        position_deg=np.full(n, 45.0),
        feed_mm_min=feed_deg_min,
        deviation_arcsec=late_arcsec + noise(n),
    )

    found = repeatability(replace(read_campaign(machine_sample), touches=touches))
    document = as_json(found)

    assert found.unit == "arcsec"
    assert holds(found.sigma, SIGMA_UM)
    assert holds(found.slope, 3.0)
    assert "σ = " in sentence(found)
    assert "arcsec" in sentence(found)
    assert document["sigma_arcsec"] == found.sigma.value


def test_delay_drift_and_first_touch_are_told_apart(machine_sample: Path) -> None:
    n = 80
    feed = np.where(np.arange(n) // 20 % 2, 600.0, 120.0)
    y = noise(n) + 3.0 * feed / 60.0 + 0.1 * np.arange(n)
    y[::20] += 25.0

    found = of(machine_sample, y, feed_mm_min=feed)

    assert holds(found.slope, 3.0)
    assert holds(found.drift, 0.1)
    assert holds(found.first, 25.0)
    assert holds(found.sigma, SIGMA_UM)


def test_outliers_are_named_and_left_out(machine_sample: Path) -> None:
    y = noise(50)
    y[[17, 31]] += (900.0, -120.0)

    found = of(machine_sample, y)

    assert found.outliers == (17, 31)
    assert found.mean.value == pytest.approx(np.delete(y, [17, 31]).mean())
    assert holds(found.sigma, SIGMA_UM)
    assert "2 lie far outside" in sentence(found)


def test_what_was_assumed_of_a_log_is_said() -> None:
    result = CliRunner().invoke(group, ["repeat", str(LOGS / "linuxcnc_probe.txt")])

    assert "Assumed\n" in result.output
    assert "  coordinates in mm: no G20, G21 or .ini tells another unit; else" in result.output


@pytest.mark.parametrize("path", sorted(LOGS.glob("*.[ltv][oxc][gtd]")), ids=lambda path: path.name)
def test_importers_name_their_options_apart_from_their_sentences(path: Path) -> None:
    imported = read_any(path)[1]

    named = re.findall(r"(?<!init )--[a-z-]+", "\n".join(imported.assumed))
    assert set(named) == set(imported.options)


def test_options_that_are_named_are_said_to_be_those_of_import() -> None:
    result = CliRunner().invoke(group, ["repeat", str(LOGS / "linuxcnc_probe.txt")])

    (said,) = (line for line in result.output.splitlines() if OPTIONS_OF_IMPORT in line)
    assert said == f"  --axis, --program, --feed, --ini: {OPTIONS_OF_IMPORT}"


def test_hyphens_of_a_sentence_are_no_option(monkeypatch: pytest.MonkeyPatch) -> None:
    kind, imported = read_any(LOGS / "klippy.log")
    imported.assumed.append("the section [probe -- old] of the configuration is the one in use")
    monkeypatch.setattr("skiplatch.commands.repeat.read_any", lambda *_, **__: (kind, imported))

    result = CliRunner().invoke(group, ["repeat", str(LOGS / "klippy.log")])

    assert "probe -- old" in result.output
    assert "of skiplatch import" not in result.output


def test_two_conditions_in_one_are_no_outliers(machine_sample: Path) -> None:
    y = noise(40)
    y[::2] += 300.0

    assert "20 lie apart from the others: what is taken for one condition are two" in sentence(
        of(machine_sample, y)
    )


def test_surfaces_have_middles_of_their_own(machine_sample: Path) -> None:
    place = np.repeat([0.0, 100.0], 40)

    found = of(machine_sample, noise(80) + place, position_mm=place)

    assert found.surfaces == 2
    assert holds(found.sigma, SIGMA_UM)
    assert found.range < 20.0


def test_scatter_below_the_step_is_limited_by_the_resolution(machine_sample: Path) -> None:
    found = of(machine_sample, np.round(noise(50, seed=2) / 5.0) * 5.0)

    assert found.step == pytest.approx(5.0)
    assert found.is_limited_by_resolution
    assert "limited by the resolution of 5 µm" in sentence(found)


def test_the_same_again_and_again_has_no_drift(machine_sample: Path) -> None:
    found = of(machine_sample, np.full(10, 36.084))

    assert found.sigma.value == 0.0
    assert found.drift is not None
    assert found.drift.value == 0.0
    assert found.drift.low < 0.0 < found.drift.high  # as closely as rounding lets it be known
    assert found.is_limited_by_resolution


def test_one_step_in_each_of_three_pairs_is_no_drift(machine_sample: Path) -> None:
    place = np.repeat([0.0, 50.0, 100.0], 2)

    found = of(machine_sample, np.tile([0.9375, 0.0], 3), position_mm=place)

    assert "order" not in found.told
    assert found.drift is not None
    assert found.drift.low < 0.0 < found.drift.high


def meshes(shifts_um: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Two touches each of ten surfaces, again and again, all of them moved together between."""
    place = np.tile(np.repeat(np.arange(10) * 10.0, 2), len(shifts_um))
    return noise(len(place)) + np.repeat(shifts_um, 20), place


def test_surfaces_that_move_together_now_and_then_do_not_drift(machine_sample: Path) -> None:
    y, place = meshes([0.0, -40.0, -70.0, 30.0, 20.0, 90.0])

    found = of(machine_sample, y, position_mm=place)

    assert "order" not in found.told
    assert found.in_a_row is not None
    assert found.in_a_row.is_less
    assert holds(found.in_a_row.sigma, SIGMA_UM)
    assert "to the next they scatter by no more than" in sentence(found)
    assert as_json(found)["sigma_in_a_row_um"] == found.in_a_row.sigma.value


def test_touches_that_keep_nothing_scatter_in_a_row_as_all_do(machine_sample: Path) -> None:
    y, place = meshes([0.0] * 6)

    found = of(machine_sample, y, position_mm=place)

    assert found.in_a_row is not None
    assert not found.in_a_row.is_less
    assert holds(found.in_a_row.sigma, SIGMA_UM)
    assert "to the next" not in sentence(found)


def test_positions_that_an_axis_met_at_rest_have_a_reversal_error(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)
    sign = np.tile(np.repeat([1.0, -1.0], 5), 4)
    place = np.repeat([0.0, 10.0, 20.0, 30.0], 10)
    y = noise(40, seed=6) / 4.0 + sign * place + 4.0 + np.where(place == 30.0, 6.0, 0.0)
    datum = Datum(DatumFreedom.ZERO)
    at_rest = replace(
        campaign,
        nominal=replace(campaign.nominal, datum=datum),
        touches=Touches.from_columns(
            touch=np.arange(40), deviation_um=y, sign=sign, position_mm=place, axis=np.zeros(40)
        ),
    )

    found = repeatability(at_rest)

    assert found.reversal is not None
    assert found.reversal.positions == 4
    assert holds(found.reversal.mean, 11.0)
    assert found.reversal.widest == pytest.approx(20.0, abs=1.5)
    assert found.reversal.at == 30.0
    assert "the reversal error at 4 positions is 11" in sentence(found)
    assert repeatability(replace(at_rest, nominal=campaign.nominal)).reversal is None


def test_growth_with_the_temperature_is_told_by_its_thermometer(machine_sample: Path) -> None:
    temp_c = 20.0 + 3.0 * np.sin(np.arange(60) / 5.0)

    found = of(machine_sample, noise(60) + 4.0 * temp_c, temp_c=temp_c)

    assert holds(found.per_kelvin["machine"], 4.0)


@pytest.mark.long
@pytest.mark.parametrize("seed_of_many", [0])
def test_intervals_hold_the_truth_as_often_as_stated(
    machine_sample: Path, seed_of_many: int
) -> None:
    campaign: Campaign = read_campaign(machine_sample)
    right = {"sigma": 0, "drift": 0, "slope": 0, "first": 0}
    runs = 300
    for seed in range(runs):
        feed = np.where(np.arange(24) // 8 % 2, 600.0, 120.0)
        y = noise(24, seed + seed_of_many)
        made = Touches.from_columns(touch=np.arange(24), deviation_um=y, feed_mm_min=feed)
        found = repeatability(replace(campaign, touches=made))
        right["sigma"] += holds(found.sigma, SIGMA_UM)
        for name in ("drift", "slope", "first"):
            right[name] += holds(getattr(found, name), 0.0)

    # 95 % of 300 is 285; below 272 or above 296 is one in a thousand.
    assert all(270 <= count <= 298 for count in right.values()), right


def test_log_goes_straight_to_json_and_picture(tmp_path: Path) -> None:
    out, picture = tmp_path / "r.json", tmp_path / "r.svg"
    arguments = ["repeat", str(LOGS / "klipper_octoprint.log"), "--json", str(out)]

    result = CliRunner().invoke(group, [*arguments, "--picture", str(picture)])

    assert result.exit_code == 0, result.output
    document = json.loads(out.read_text())
    assert document["n"] == 6
    assert document["range_um"] == pytest.approx(22.5)
    assert document["sigma_um_interval"][0] < document["sigma_um"]
    assert document["slope_ms"] is None
    assert {"mean_um", "first_touch_um", "drift_um_per_touch", "outliers"} <= document.keys()
    assert "<svg" in picture.read_text()


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("klipper_newest_first.log", "klipper"),
        ("marlin_m48.log", "marlin"),
        ("linuxcnc_probe.txt", "linuxcnc"),
        ("saleae_latches.csv", "a logic analyser"),
        ("saleae_dates.csv", "a logic analyser"),
    ],
)
def test_kind_of_a_log_is_told_by_what_stands_in_it(name: str, kind: str) -> None:
    result = CliRunner().invoke(group, ["repeat", str(LOGS / name)])

    assert result.exit_code == 0, result.output
    assert f"log of {kind}" in result.output


def test_coarse_values_are_no_outliers_of_finer_ones(machine_sample: Path) -> None:
    y = np.concatenate([np.zeros(10), np.tile([-10.0, 10.0], 4)])

    found = of(machine_sample, y)

    assert found.outliers == ()
    assert found.sigma.value > 4.0


def test_bench_without_motion_repeats_in_time(tmp_path: Path) -> None:
    bench, out = tmp_path / "bench", tmp_path / "r.json"
    words = ["import", "edges", str(LOGS / "saleae_latches.csv"), "-o", str(bench)]
    assert CliRunner().invoke(group, words).exit_code == 0

    result = CliRunner().invoke(group, ["repeat", str(bench), "--json", str(out)])

    assert result.exit_code == 0, result.output
    document = json.loads(out.read_text())
    assert document["n"] == 60
    assert document["mean_us"] == pytest.approx(49.0, abs=0.2)
    assert document["sigma_us"] == pytest.approx(2.0 / np.sqrt(12.0), abs=0.1)
    assert "60 latches come 49.0" in result.output


def test_what_cannot_be_told_is_refused(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "x.txt").write_text("hello\n")
    (tmp_path / "few.log").write_text("[PRB:0.000,0.000,-1.000:1]\n")

    kinds = refused("repeat", tmp_path / "x.txt").partition("expected a campaign or a log of ")[2]
    assert "grbl, " in kinds
    said = refused("repeat", tmp_path / "few.log")
    assert said.startswith(f"skiplatch: {tmp_path}/few.log: expected a surface that was touched 3")


@pytest.mark.parametrize(
    ("text", "kind", "said"),
    [
        ("Send: M48\nRecv: M48 Z-Probe Repeatability Test\nRecv: Finished!\n", "marlin", "M48 V4"),
        ("// probe accuracy results: maximum 0.9, minimum 0.8\n", "klipper", "the lines above"),
        (">>> G38.2 Z-3 F25\nok\n", "grbl", "log what the controller answers, too"),
    ],
)
def test_log_without_touches_is_told_as_import_tells_it(
    tmp_path: Path, refused: Program, text: str, kind: str, said: str
) -> None:
    (tmp_path / "a.log").write_text(text)

    told = refused("repeat", tmp_path / "a.log")

    assert said in told
    assert told == refused("import", kind, tmp_path / "a.log", "-o", tmp_path / "x")


def test_old_g29_goes_straight_to_repeat(tmp_path: Path) -> None:
    touched = "".join(f"12:26:5{i}.3 : Bed x: 40.00 y: 40.00 z: 8.4{i}\n" for i in range(4))
    (tmp_path / "m.log").write_text(touched)

    result = CliRunner().invoke(group, ["repeat", str(tmp_path / "m.log")])

    assert "log of marlin, 4 touches" in result.output


def test_slip_in_the_name_of_a_command_is_told() -> None:
    result = CliRunner().invoke(group, ["diagnoze", "x"])

    assert result.exit_code == 2
    assert 'no command "diagnoze"; did you mean "diagnose"?' in result.output


def test_package_runs_as_a_module() -> None:
    words = [sys.executable, "-m", "skiplatch", "--version"]

    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout

    assert said.startswith("skiplatch, version ")


@pytest.fixture
def both_paths(tmp_path: Path, bench_sample: Path) -> Path:
    """A bench whose skip input takes 7 ± 0.3 µs, and whose PLC task polls every 4 ms."""
    rng, n = np.random.default_rng(3), 60
    path = np.repeat([InputPath.SKIP, InputPath.PLC], n)
    edge_us = np.tile(np.arange(n) * 1e6, 2)
    waits_us = np.append(rng.normal(7.0, 0.3, n), rng.uniform(0.0, 4000.0, n))
    touches = Touches.from_columns(
        touch=np.arange(2 * n),
        time_s=np.arange(2.0 * n),
        path=path,
        feed_mm_min=np.full(2 * n, 100.0),
        approach_mm=np.full(2 * n, 2.0),
        edge_us=edge_us,
        latch_us=edge_us + waits_us.round(3),
    )
    return kept(tmp_path / "bench", read_campaign(bench_sample), touches)


def kept(folder: Path, campaign: Campaign, touches: Touches) -> Path:
    folder.mkdir()
    write_nominal(folder / "nominal.toml", campaign.nominal)
    write_touches(folder / "touches.csv", touches)
    return folder


def test_each_path_repeats_by_itself(both_paths: Path, tmp_path: Path) -> None:
    out, page, picture = (tmp_path / name for name in ("r.json", "r.html", "r.svg"))
    words = ["repeat", str(both_paths), "--json", str(out), "--html", str(page)]

    result = CliRunner().invoke(group, [*words, "--picture", str(picture)], catch_exceptions=False)

    document = json.loads(out.read_text())
    skip, plc = (document["paths"][path] for path in ("skip", "plc"))
    assert skip["sigma_us"] == pytest.approx(0.3, rel=0.3)
    assert skip["mean_us"] == pytest.approx(7.0, abs=0.2)
    assert plc["sigma_us"] == pytest.approx(4000.0 / np.sqrt(12.0), rel=0.2)
    assert plc["n"] == 60
    assert {name: document[name] for name in skip} == skip  # the top level is the skip input's
    for said in (result.output, page.read_text()):
        for path, found in (("Skip input", skip), ("PLC task", plc)):
            assert f"{path}: {found['sentence']}" in said
    assert "Skip input: 60 touches" in picture.read_text()


def test_a_path_with_too_few_touches_hides_no_other(both_paths: Path, tmp_path: Path) -> None:
    whole = read_campaign(both_paths)
    few = kept(tmp_path / "few", whole, whole.touches.select(slice(None, 62)))

    result = CliRunner().invoke(group, ["repeat", str(few)], catch_exceptions=False)

    assert "Skip input: 60 latches come" in result.output
    assert "PLC task: no surface was touched often enough" in result.output


def test_attempts_that_failed_are_said_beside_the_figures(machine_sample: Path) -> None:
    y = np.append(noise(20), [np.nan] * 3)
    status = np.append(np.zeros(20), [1, 1, 2]).astype(np.int8)

    found = of(machine_sample, y, status=status)

    assert len(found.touches) == 20
    assert "besides, 2 were missed; besides, 1 was latched without a contact." in sentence(found)
    assert (as_json(found)["missed"], as_json(found)["false"]) == (2, 1)


@pytest.mark.parametrize(("steps", "outliers"), [(1, ()), (2, ()), (4, (7,))])
def test_a_step_of_the_resolution_is_no_outlier(
    machine_sample: Path, steps: int, outliers: tuple[int, ...]
) -> None:
    y = np.full(20, 36.084)
    y[7] += steps * read_campaign(machine_sample).nominal.axis.resolution_um

    found = of(machine_sample, y)

    assert found.outliers == outliers


def pairs(machine_sample: Path, deviation_um: np.ndarray) -> Repeatability:
    """Each surface touched twice, as a printer's bed is with two samples."""
    places = np.repeat(np.arange(len(deviation_um) // 2), 2).astype(float)
    return of(machine_sample, deviation_um + 100.0 * np.sin(places), position_mm=places)


def test_surfaces_that_were_touched_twice_tell_the_scatter(machine_sample: Path) -> None:
    found = pairs(machine_sample, noise(80))

    assert (len(found.touches), found.surfaces) == (80, 40)
    assert holds(found.sigma, SIGMA_UM)
    assert found.outliers == ()


def test_nobody_knows_which_of_two_touches_is_the_outlier(machine_sample: Path) -> None:
    off_um = noise(80)
    off_um[31] += 50.0 * SIGMA_UM

    assert pairs(machine_sample, off_um).outliers == (30, 31)


@pytest.mark.parametrize(("touched", "got"), [([2, 1], "one that was twice"), ([1], "none that")])
def test_too_few_touches_for_a_scatter_are_refused(
    machine_sample: Path, touched: list[int], got: str
) -> None:
    places = np.repeat(np.arange(len(touched)), touched).astype(float)

    with pytest.raises(InputError, match=f"touched 3 times, or two that were twice, got {got}"):
        of(machine_sample, noise(len(places)), position_mm=places)


def test_drift_of_unknown_sense_is_one_of_the_coordinate(machine_sample: Path) -> None:
    rising = 10.0 * np.arange(30.0) + noise(30)

    found = of(machine_sample, rising, axis=np.full(30, Axis.Y), sign=np.full(30, np.nan))

    assert "a touch, Y rises" in sentence(found)
    assert "approach" not in sentence(found)


FOUR_RUNS_S = np.concatenate([run * 1800.0 + 5.0 * np.arange(10) for run in range(4)])
"""Of ten touches each, half an hour apart."""


def test_drift_goes_with_time_where_touches_show_it(machine_sample: Path) -> None:
    y = noise(40) + 30.0 * FOUR_RUNS_S / 3600.0

    found = of(machine_sample, y, time_s=FOUR_RUNS_S)

    assert holds(found.sigma, SIGMA_UM)
    assert holds(found.drift, 30.0 * np.ptp(FOUR_RUNS_S) / 3600.0 / 39)
    assert "they drift with time, by 29.3 µm (28.3 … 30.2) an hour" in sentence(found)
    document = as_json(found)
    assert document["drift_um_per_h"] == pytest.approx(30.0, abs=2.0)
    assert document["drift_um_per_touch"] == found.drift.value  # type: ignore[union-attr]


def test_drift_goes_by_number_where_time_is_no_better(machine_sample: Path) -> None:
    found = of(machine_sample, noise(40) + 1.0 * np.arange(40), time_s=FOUR_RUNS_S)

    assert holds(found.drift, 1.0)
    assert as_json(found)["drift_um_per_h"] is None


def test_drift_shows_where_the_first_times_are_missing(machine_sample: Path) -> None:
    time_s = np.where(np.arange(40) < 10, np.nan, 10.0 * np.arange(40))

    found = of(machine_sample, noise(40) + 1.0 * np.arange(40), time_s=time_s)

    assert holds(found.drift, 1.0)
    assert holds(found.sigma, SIGMA_UM)
    assert found.touches == tuple(range(40))
