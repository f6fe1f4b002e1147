"""The table of effects is true: every row, whatever it does, keeps to its stage and its paths."""

import numpy as np
import pytest

from effects_rig import (
    BENCH,
    CONTROLLER,
    EXAMPLES,
    MACHINE,
    POSITION_TOLERANCE_UM,
    RESOLUTION_UM,
    STAMP_TOLERANCE_US,
    TICK_US,
    assert_close,
    example,
    mixed_touches,
    run,
)
from skiplatch.campaign import InputPath, Nominal
from skiplatch.simulator.effects import Effect, EffectDescription, effects
from skiplatch.simulator.library import SimulationError
from skiplatch.simulator.playing import Outcomes, play

TABLE = list(effects().values())
PATHS = {"both": set(InputPath), "skip": {InputPath.SKIP}, "plc": {InputPath.PLC}}
STAGES = ("motion", "probe", "link", "input", "latch", "scan", "position", "report")
OUTCOMES = ("true_edge_us", "latch_us", "report_us", "deviation_um", "status")

# What a stage leaves alone: all that is settled before it, and what does not depend on it.
UNTOUCHED = {
    "motion": (),
    "probe": (),
    "link": (),
    "input": ("true_edge_us",),
    "latch": ("true_edge_us",),
    "scan": ("true_edge_us",),
    "position": ("true_edge_us", "latch_us", "report_us", "status"),
    "report": ("true_edge_us", "latch_us", "deviation_um", "status"),
}
OF_THE_CLOCK_ALONE = {"timer_quantisation", "timer_drift"}

# The size at which an effect is none, where that is not 0.
NEUTRAL = {
    "unfinished_acceleration": {"accel_ratio": 1.0},
    "timer_quantisation": {"tick_us": TICK_US},
    "encoder_quantisation": {"resolution_um": RESOLUTION_UM},
}
NEVER_NEUTRAL = {"link_slotting", "servo_hold", "scan_phase_lock"}

each_effect = pytest.mark.parametrize("row", TABLE, ids=[row.id for row in TABLE])


def differs(a: Outcomes, b: Outcomes, names: tuple[str, ...] = OUTCOMES) -> np.ndarray:
    """In which touches any of these outcomes is not the same, to the last bit; shape (n,)."""
    unequal = [
        ~np.equal(getattr(a, name), getattr(b, name))
        & ~(np.isnan(getattr(a, name)) & np.isnan(getattr(b, name)))
        for name in names
    ]
    return np.asarray(np.any(unequal, axis=(0, 1)))


def test_every_effect_of_the_catalogue_is_in_the_table_in_the_order_of_the_chain() -> None:
    stages = [STAGES.index(row.stage) for row in TABLE]

    assert set(EXAMPLES) <= set(effects())
    assert stages == sorted(stages)
    assert {row.paths for row in TABLE} <= set(PATHS)


@each_effect
def test_parameters_are_described(row: EffectDescription) -> None:
    names = [parameter.name for parameter in row.parameters]

    assert row.physics
    assert len(names) == len(set(names)) > 0
    for parameter in row.parameters:
        assert parameter.unit
        assert parameter.meaning
        assert parameter.low < parameter.high


@each_effect
def test_an_effect_acts_on_its_paths_alone(row: EffectDescription) -> None:
    touches = mixed_touches(300, seed=3)

    changed = differs(run(touches), run(touches, example(row.id)))

    for path in InputPath:
        assert changed[touches.path == path].any() == (path in PATHS[row.paths])


@each_effect
def test_an_effect_leaves_alone_what_is_settled_before_its_stage(row: EffectDescription) -> None:
    touches = mixed_touches(300, seed=4)
    untouched = UNTOUCHED[row.stage]
    if row.id in OF_THE_CLOCK_ALONE:
        untouched = ("true_edge_us", "report_us", "status")

    nominal, changed = run(touches), run(touches, example(row.id))

    assert differs(nominal, changed).any()
    assert not untouched or not differs(nominal, changed, untouched).any()


@each_effect
def test_a_bench_has_neither_probe_nor_link(row: EffectDescription) -> None:
    touches = mixed_touches(300, seed=5)

    changed = differs(run(touches, nominal=BENCH), run(touches, example(row.id), nominal=BENCH))

    assert changed.any() == (row.stage not in {"probe", "link"})


@pytest.mark.parametrize("row", [row for row in TABLE if row.id not in NEVER_NEUTRAL])
@pytest.mark.parametrize("nominal", [MACHINE, BENCH], ids=["machine", "bench"])
def test_an_effect_of_no_size_is_none(row: EffectDescription, nominal: Nominal) -> None:
    touches = mixed_touches(400, seed=6)
    none = Effect(row.id, NEUTRAL.get(row.id, {p.name: max(0.0, p.low) for p in row.parameters}))

    assert not differs(run(touches, nominal=nominal), run(touches, none, nominal=nominal)).any()


@each_effect
def test_threads_do_not_matter(row: EffectDescription) -> None:
    touches = mixed_touches(100, seed=7)

    one, three = (
        play(
            MACHINE,
            CONTROLLER,
            touches,
            seed=1,
            replicates=4,
            jobs=jobs,
            switched_on=[example(row.id)],
        )
        for jobs in (1, 3)
    )

    assert not differs(one, three).any()


@each_effect
def test_the_order_of_rows_does_not_matter(row: EffectDescription) -> None:
    touches = mixed_touches(200, seed=8)
    order = np.random.default_rng(1).permutation(len(touches))

    in_order = run(touches, example(row.id))
    shuffled = run(touches.select(order), example(row.id))

    for name in OUTCOMES:
        np.testing.assert_array_equal(getattr(in_order, name)[:, order], getattr(shuffled, name))


@each_effect
def test_the_ends_of_every_range_are_played_and_what_lies_beyond_is_refused(
    row: EffectDescription,
) -> None:
    touches = mixed_touches(50, seed=9)
    for end in ("low", "high"):
        at_the_end = {p.name: getattr(p, end) for p in row.parameters}
        run(touches, Effect(row.id, at_the_end))
    for parameter in row.parameters:
        step = 1e-6 * (parameter.high - parameter.low)
        for value in (parameter.low - step, parameter.high + step, float("nan")):
            beyond = {**example(row.id).parameters, parameter.name: value}
            with pytest.raises(SimulationError, match=rf"^{row.id}\.{parameter.name}: expected"):
                run(touches, Effect(row.id, beyond))


@pytest.mark.parametrize("first", range(0, len(TABLE), 8))
def test_eight_effects_at_once_are_played_and_nine_are_refused(first: int) -> None:
    touches = mixed_touches(200, seed=10)
    nine = [example(TABLE[(first + i) % len(TABLE)].id) for i in range(9)]

    outcomes = run(touches, *nine[:8])

    assert np.isfinite(outcomes.latch_us[outcomes.ok]).all()
    assert outcomes.ok.mean() > 0.5
    with pytest.raises(SimulationError, match="expected at most 8 effects, got 9"):
        run(touches, *nine)


def test_an_unknown_effect_is_refused_by_name() -> None:
    with pytest.raises((SimulationError, KeyError), match="no_such_effect"):
        run(mixed_touches(3, seed=1), Effect("no_such_effect", {}))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("backlash", "scale_error"),
        ("thermal_drift", "rotary_pivot"),
        ("trigger_delay", "following_error"),
        ("trigger_delay", "input_filter"),
        ("contact_bounce", "isr_blocking"),
        ("link_retry", "isr_latency"),
        ("pretravel_lobing", "report_delay"),
    ],
)
def test_independent_effects_add_up(one: str, other: str) -> None:
    """Also where both draw: what an effect draws does not depend on the others."""
    touches = mixed_touches(300, seed=12, path=InputPath.SKIP)
    nominal, first, second, both = (
        run(touches, *(example(effect_id) for effect_id in ids))
        for ids in ((), (one,), (other,), (one, other))
    )

    for name, tolerance in (
        ("latch_us", 2.0 * STAMP_TOLERANCE_US),
        ("report_us", 0.01),
        ("deviation_um", 2.0 * POSITION_TOLERANCE_UM),
    ):
        start = getattr(nominal, name)
        shifts = [getattr(outcomes, name) - start for outcomes in (first, second, both)]
        assert_close(shifts[2], shifts[0] + shifts[1], tolerance)


def test_the_same_effect_twice_draws_twice() -> None:
    touches = mixed_touches(300, seed=13, path=InputPath.SKIP)
    once = Effect("isr_latency", {"jitter_us": 100.0})

    nominal, one, two = run(touches), run(touches, once), run(touches, once, once)

    first, second = one.latch_us - nominal.latch_us, two.latch_us - one.latch_us
    assert abs(np.corrcoef(first[0], second[0])[0, 1]) < 0.25  # a false alarm in 100,000
    assert second.max() > 90.0
