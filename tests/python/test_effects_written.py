"""Whatever an effect does within its ranges is written and read back, or refused in one line."""

import re
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from effects_rig import BENCH, MACHINE, SCAN_US, TICK_US, assert_close, mixed_touches, run
from refusals import Program
from skiplatch import cli, simulate
from skiplatch.campaign import (
    COLUMNS,
    CONDITIONS,
    InputPath,
    Nominal,
    Touches,
    format_touches,
    read_campaign,
    write_campaign,
    write_nominal,
)
from skiplatch.campaign.columns import MEASURED_OUTCOMES
from skiplatch.simulator.effects import Effect, EffectDescription, effects
from skiplatch.simulator.library import SimulationError

TABLE = list(effects().values())
RIGS = {"machine": MACHINE, "bench": BENCH}
LONGEST_S = 8.64e6
HOUR_S = 3600.0
REFUSALS = ("is more than the rig counts or a campaign holds", "the device clock would run at less")

each_effect = pytest.mark.parametrize("row", TABLE, ids=[row.id for row in TABLE])
each_rig = pytest.mark.parametrize("nominal", RIGS.values(), ids=RIGS.keys())


def within(low: float, high: float) -> st.SearchStrategy[float]:
    return st.sampled_from([low, high, min(max(0.0, low), high)]) | st.floats(low, high)


def sizes_of(row: EffectDescription) -> st.SearchStrategy[Effect]:
    ranges = {p.name: within(p.low, p.high) for p in row.parameters}
    return st.fixed_dictionaries(ranges).map(lambda sizes: Effect(row.id, sizes))


@st.composite
def conditions(draw: st.DrawFn) -> Touches:
    """A few touches on all axes, from the very start or late, in minutes or in months."""
    touches = mixed_touches(12, seed=draw(st.integers(0, 1000)))
    begin_s = draw(st.sampled_from([0.0, 1000.0]))
    last_s = draw(st.sampled_from([HOUR_S, 50.0 * HOUR_S, LONGEST_S]))
    return replace(
        touches,
        time_s=np.linspace(begin_s, last_s, len(touches)),
        axis=np.arange(len(touches), dtype=np.int8) % 3,
        temp_c=touches.temp_c + draw(st.sampled_from([0.0, 0.0, -200.0, 900.0])),
        sign=np.resize([1.0, -1.0, -1.0], len(touches)),
    )


def assert_written_as_played(nominal: Nominal, touches: Touches, effect: Effect) -> None:
    try:
        played = simulate(nominal, touches, effects=[effect])
    except SimulationError as error:
        said = str(error)
        if not any(refusal in said for refusal in REFUSALS) or "\n" in said:
            raise
        return
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "played"
        write_campaign(folder, nominal, played.touches)
        read = read_campaign(folder).touches

    np.testing.assert_array_equal(read.status, played.touches.status)
    for name in MEASURED_OUTCOMES:
        half_a_digit = 0.501 * 10.0 ** -COLUMNS[name].decimals  # type: ignore[attr-defined]
        np.testing.assert_allclose(
            getattr(read, name), getattr(played.touches, name), 1e-15, half_a_digit, err_msg=name
        )


@each_rig
@each_effect
@settings(max_examples=8)
@given(data=st.data())
def test_an_effect_of_any_size_is_written_and_read_back(
    row: EffectDescription, nominal: Nominal, data: st.DataObject
) -> None:
    assert_written_as_played(nominal, data.draw(conditions()), data.draw(sizes_of(row)))


@pytest.mark.nightly
@each_rig
@each_effect
@settings(max_examples=30)
@given(data=st.data())
def test_an_effect_of_any_size_is_written_and_read_back_at_length(
    row: EffectDescription, nominal: Nominal, data: st.DataObject
) -> None:
    assert_written_as_played(nominal, data.draw(conditions()), data.draw(sizes_of(row)))


@pytest.mark.parametrize("path", InputPath)
@each_rig
def test_a_stamp_of_after_the_report_is_told_as_it_is(nominal: Nominal, path: InputPath) -> None:
    touches = mixed_touches(50, seed=2, path=path)
    ahead = Effect("timer_quantisation", {"tick_us": TICK_US, "origin_us": 10_000.0})

    right, late = run(touches, nominal=nominal), run(touches, ahead, nominal=nominal)

    assert (late.latch_us > late.report_us).all()
    assert_close(late.latch_us - right.latch_us, 10_000.0, 2.0 * TICK_US)


def test_a_stamp_of_before_the_clock_began_is_below_nothing() -> None:
    touches = replace(
        mixed_touches(1, seed=2, path=InputPath.SKIP),
        time_s=np.zeros(1),
        approach_mm=np.full(1, 0.01),
        feed_mm_min=np.full(1, 3000.0),
    )
    early = Effect("timer_quantisation", {"tick_us": TICK_US, "origin_us": -10_000.0})

    right, stamped = run(touches, nominal=BENCH), run(touches, early, nominal=BENCH)

    assert (right.latch_us < SCAN_US * 10.0).all()
    assert_close(stamped.latch_us - right.latch_us, -10_000.0, 2.0 * TICK_US)


def words_for(folder: Path, touches: Touches, effect: str) -> list[str]:
    """The command that plays these touches on a machine."""
    nominal, conditions_csv = folder / "nominal.toml", folder / "conditions.csv"
    write_nominal(nominal, MACHINE)
    conditions_csv.write_text(format_touches(touches, CONDITIONS))
    files = ["--nominal", nominal, "--conditions", conditions_csv, "--out", folder / "out"]
    return ["simulate", *map(str, files), "--effect", effect]


def test_a_coarse_clock_is_simulated(tmp_path: Path) -> None:
    coarse = "timer_quantisation:tick_us=7627.66,origin_us=9433.8,nearest=0.9"

    result = CliRunner().invoke(cli.group, words_for(tmp_path, mixed_touches(9, seed=3), coarse))

    assert result.exit_code == 0, result.exception
    assert read_campaign(tmp_path / "out").touches.ok.any()


def test_a_position_beyond_what_is_counted_is_one_line(tmp_path: Path, refused: Program) -> None:
    touches = replace(mixed_touches(9, seed=3), axis=np.ones(9, dtype=np.int8))

    said = refused(
        *words_for(tmp_path, touches, "following_error:lag_us=200000,y_excess_ratio=1000")
    )

    assert re.match("skiplatch: deviation_um of touch 3: [0-9.e+]+ is more than the rig cou", said)
    assert not (tmp_path / "out").exists()


def test_a_clock_that_runs_backwards_is_one_line(tmp_path: Path, refused: Program) -> None:
    touches = replace(mixed_touches(9, seed=3), time_s=np.linspace(0.0, LONGEST_S, 9))

    said = refused(*words_for(tmp_path, touches, "timer_drift:ageing_ppm_h=-10000"))

    assert said.startswith("skiplatch: the device clock would run at less than half or more than")
    assert not (tmp_path / "out").exists()
