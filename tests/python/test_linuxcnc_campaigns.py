"""Campaigns that the real LinuxCNC probed, with one thing wrong: what is found, and its size.

They were recorded by ``python -m tests.linuxcnc.campaigns``.
"""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from skiplatch.campaign import read_campaign
from skiplatch.diagnosis import Diagnosis, Verdict, diagnose
from tests.linuxcnc.campaigns import CONDITIONS

DATA = Path(__file__).parent / "data/linuxcnc"

pytestmark = pytest.mark.xdist_group("linuxcnc_campaigns")


@cache
def diagnosed(name: str) -> Diagnosis:
    return diagnose(read_campaign(DATA / name), seed=1, jobs=2)


@pytest.mark.parametrize("name", CONDITIONS)
def test_what_linuxcnc_logged_is_in_the_campaign(name: str) -> None:
    """Touches that were left out are missing by their number, which is the line of the log."""
    logged_mm = np.loadtxt(DATA / name / "probe.log")[:, 0]
    touches = read_campaign(DATA / name).touches
    latched_mm = touches.position_mm + touches.sign * touches.deviation_um / 1000.0

    np.testing.assert_allclose(logged_mm[touches.touch], latched_mm, atol=2e-6)


@pytest.mark.long
def test_a_sound_machine_has_no_gap() -> None:
    assert list(diagnosed("nothing").effects) == []


# Effect that is named or listed as not to be told from it, a parameter, its truth, and how far off.
# A low pass of 3 ms, computed once a period, lags by T·a/(1 - a) with a = exp(-T/3 ms): 2.53 ms.
# Beside a datum that may be anywhere its interval of 90 % is 53 µs to either side.
TRUTHS = {
    "debounced": ("input_image_delay", "scans", 5.0, 0.1),
    "backlash": ("backlash", "backlash_um", -60.0, 0.5),
    "screw": ("scale_error", "scale_ppm", -1000.0, 10.0),
    "lagging": ("following_error", "lag_us", -2528.0, 60.0),
}


# The likelihood is the same within the whole interval, as that of a box is: any value there fits.
FLAT = {"lagging"}


# How the row of each begins in the table of docs/LINUXCNC.md.
ROWS = {
    "servo_period": "servo period 2 ms",
    "debounced": "LinuxCNC's `debounce`",
    "backlash": "backlash",
    "screw": "screw too long",
    "lagging": "feedback through a low pass",
    "bounced": "a quarter of the contacts",
}


@pytest.mark.long
@pytest.mark.parametrize("name", TRUTHS)
def test_what_is_wrong_is_named_with_its_size_and_the_gap_is_gone(name: str) -> None:
    diagnosis = diagnosed(name)
    effect, parameter, truth, off = TRUTHS[name]

    (named,) = diagnosis.effects
    alike = {e.id: e for model in diagnosis.rivals for e in model.effects} | {
        named.effect.id: named.effect
    }
    assert effect in {named.effect.id, *named.alternatives}
    if name in FLAT:
        assert named.effect.id == effect
        low, high = named.intervals[parameter]
        assert low <= truth <= high
        assert high - low < 2.0 * off
    else:
        assert alike[effect].parameters[parameter] == pytest.approx(truth, abs=off)
    (gap,) = diagnosis.gap.values()
    assert gap.after < 1.5 * gap.noise_floor


@pytest.mark.long
def test_another_period_is_named() -> None:
    """2 ms, where 1 ms is believed."""
    (named,) = diagnosed("servo_period").effects
    low, high = named.intervals["period_us"]

    assert named.effect.id == "scan_period"
    assert low <= 1000.0 <= high


def shown(cell: str) -> list[float]:
    """Give the numbers of a cell that no name holds."""
    return [float(n.replace("−", "-")) for n in re.findall(r"(?<![\w.])[-−]?\d+\.?\d*", cell)]


@pytest.mark.long
@pytest.mark.parametrize("name", ROWS)
def test_the_page_has_what_is_found(name: str) -> None:
    """To the last digit that stands there, as another processor may round in another way."""
    page = Path("docs/LINUXCNC.md").read_text(encoding="utf-8")
    (row,) = (line for line in page.splitlines() if line.startswith(f"| {ROWS[name]}"))
    _, _, found, _, scores, _ = row.split("|")
    diagnosis = diagnosed(name)

    (named,) = diagnosis.effects
    (gap,) = diagnosis.gap.values()
    assert f"`{named.effect.id}`" in found
    assert ("in part" in found) == (diagnosis.verdict is Verdict.PARTLY_EXPLAINED)
    parameter = next(iter(named.intervals))
    figures = [named.effect.parameters[parameter], *named.intervals[parameter]]
    percent = 100.0 if parameter == "probability" else 1.0
    numbers = shown(found)
    expected = [percent * figure for figure in figures[: 3 if len(numbers) >= 3 else 1]]
    assert numbers[: len(expected)] == pytest.approx(expected, rel=0.02)
    assert shown(scores) == pytest.approx([gap.before, gap.after, gap.noise_floor], rel=0.01)


@pytest.mark.long
def test_two_late_contacts_in_a_hundred_are_named_with_what_would_do_the_same() -> None:
    """Late scans and retries would; a score that forgives what is rare hardly shrinks."""
    diagnosis = diagnosed("bounced")
    (named,) = diagnosis.effects

    assert diagnosis.verdict is Verdict.PARTLY_EXPLAINED
    assert "contact_bounce" in {named.effect.id, *named.alternatives}
