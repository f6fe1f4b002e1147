"""What all Python tests share."""

from pathlib import Path

import pytest
from hypothesis import settings

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"

# Every run tries the same cases, so that a red build can be repeated; `--hypothesis-profile
# explore` looks for new ones.
settings.register_profile("steady", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, max_examples=2000)
settings.load_profile("steady")


@pytest.fixture
def bench_sample() -> Path:
    """A recorded bench campaign whose skip input latches late."""
    return SAMPLES / "bench_isr_latency"


@pytest.fixture
def machine_sample() -> Path:
    """A recorded machine campaign without a gap."""
    return SAMPLES / "machine_no_gap"
