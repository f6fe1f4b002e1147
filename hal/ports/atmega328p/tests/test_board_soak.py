"""The soak of the ATmega328P in simavr: a short one, and what makes it fall."""

import numpy as np
import pytest

from hal.ports.atmega328p.tests.edges import plan
from hal.ports.atmega328p.tests.emulator import Events, run
from hal.ports.atmega328p.tests.simavr_rig import frames_of, latches
from hal.ports.atmega328p.tests.soak import FallError, Soak, check_edges, cut_off
from hal.ports.atmega328p.tests.test_board_atmega328p import program

TOUCHES = 30
RUNS, MOST = 3, 80


def soak() -> Soak:
    return Soak(np.random.default_rng(1))


@pytest.fixture(scope="module")
def events() -> Events:
    return run(program("nominal"), plan(TOUCHES, seed=1)[0])


def test_a_short_one_accounts_for_each_record() -> None:
    program("prescaler")
    played = Soak(np.random.default_rng(1), most=MOST)

    for _ in range(RUNS):
        played.play()

    assert played.runs == RUNS
    assert min(played.disturbed, played.reports.lost) > 0
    assert 0.9 * played.edges < played.sent <= played.edges


def test_the_power_fails_before_the_end() -> None:
    stimuli, blocks = plan(TOUCHES, seed=1)

    few, cut = cut_off(stimuli, blocks, np.random.default_rng(1))

    assert few[-1][1:] == ("q", 0)
    assert few[:-1] == stimuli[: len(few) - 1]
    assert sum(block.count for block in cut) == sum(one[1:] == ("e", 1) for one in few)


def test_a_record_that_is_not_the_one_sent_is_a_fall(events: Events) -> None:
    sent, frames = [latch for latch, _ in latches(events)], frames_of(events)

    soak().pass_on(sent, frames)
    with pytest.raises(FallError, match="came as"):
        soak().pass_on([*sent[1:], sent[0]], frames)


def test_a_record_that_nobody_counts_is_a_fall(events: Events) -> None:
    sent, frames = [latch for latch, _ in latches(events)], frames_of(events)
    played = soak()
    played.pass_on(sent, frames)
    played.runs, played.sent = 1, played.sent + 1

    with pytest.raises(FallError, match="counted as lost"):
        played.check_sums()


def test_an_edge_that_was_not_latched_is_a_fall(events: Events) -> None:
    _, blocks = plan(TOUCHES, seed=1)
    deaf = Events(
        rises=events.rises,
        received=events.received[:160],
        overflows=events.overflows,
        end=events.end,
    )

    check_edges(events, blocks, prescaler=1)
    for may_miss_scans in (True, False):  # those of the skip path are not excused
        with pytest.raises(FallError, match="was not latched"):
            check_edges(deaf, blocks, prescaler=1, may_miss_scans=may_miss_scans)
