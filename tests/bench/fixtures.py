"""Fixtures of the tests in the rig. Without devices every test is skipped, and says why."""

from collections.abc import Iterator

import pytest

from tests.bench.bus import Bus
from tests.bench.injection import EDGE_ID, STATUS_ID
from tests.bench.programs import LATCH_ID
from tests.bench.rig import Line, Rig

HOW = "no vcan and gpio-sim here; as root: . tests/bench/devices.sh, or `make bench-vm`"


@pytest.fixture(scope="session")
def rig() -> Rig:
    """The devices of the bench."""
    rig = Rig.from_environment()
    if rig is None:
        pytest.skip(HOW)
    return rig


@pytest.fixture
def line(rig: Rig) -> Iterator[Line]:
    """Line 0 of the chip, at rest before and after."""
    line = rig.line(0)
    line.set(high=False)
    yield line
    rig.set_chip_live(live=True)
    rig.set_link(up=True)
    line.set(high=False)


@pytest.fixture
def bus(rig: Rig, line: Line) -> Iterator[Bus]:
    """A socket that hears what the programs under test say."""
    with Bus(rig.can, LATCH_ID, STATUS_ID, EDGE_ID) as bus:
        yield bus
