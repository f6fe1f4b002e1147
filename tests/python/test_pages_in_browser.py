"""Pages of comparisons, touches, drive chains and rotary axes, as browsers show them."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

import kinematics_programs
from browser import Browser
from conftest import SAMPLES
from page_faults import ASIDE, CONTRAST, CUT, LEAST_CONTRAST, LEAST_SCALE, SCALE
from skiplatch.campaign import read_campaign
from skiplatch.cli import group
from skiplatch.comparison import compare
from skiplatch.report.comparison import as_html
from skiplatch.transmission.pulses import write_binary
from test_diagnosis_report import prose
from test_transmission_command import OPTIONS, planted

SCREENS = [
    ("light", 400),
    ("dark", 1280),
    pytest.param("light", 1280, marks=pytest.mark.nightly),
    pytest.param("dark", 400, marks=pytest.mark.nightly),
]
"""Colours are the same at any width."""
LOG = Path(__file__).parent / "data" / "logs" / "klipper_octoprint.log"


def comparison(folder: Path) -> Path:
    """Compare touches enough for wide figures."""
    campaign = read_campaign(SAMPLES / "bench_isr_latency")
    few = replace(campaign, touches=campaign.touches.select(slice(200)))
    path = folder / "comparison.html"
    path.write_text(as_html(few, compare(few, seed=1, jobs=1), name="bench"))
    return path


def kinematics(folder: Path) -> Path:
    program = kinematics_programs.SAMPLES / "optimise_then_check.h"
    result = kinematics_programs.run(program, folder, has_charts=True)
    assert result.exit_code == 0, result.output
    return folder / "log.html"


def repeatability(folder: Path) -> Path:
    return written(folder / "touches.html", "repeat", str(LOG))


def transmission(folder: Path) -> Path:
    write_binary(folder / "pulses.bin", [planted(2.0)])
    return written(folder / "chain.html", "transmission", str(folder / "pulses.bin"), *OPTIONS)


def written(path: Path, *command: str) -> Path:
    result = CliRunner().invoke(group, [*command, "--html", str(path)])
    assert result.exit_code == 0, result.output
    return path


MAKERS: tuple[Callable[[Path], Path], ...] = (
    comparison,
    kinematics,
    repeatability,
    transmission,
)


@pytest.fixture(scope="module", params=MAKERS, ids=lambda make: make.__name__)
def page(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    make: Callable[[Path], Path] = request.param
    return make(tmp_path_factory.mktemp("page"))


@pytest.mark.parametrize(("scheme", "width_px"), SCREENS)
def test_nothing_is_cut_off_hidden_or_too_pale(
    window: Browser, page: Path, scheme: str, width_px: int
) -> None:
    window.open(page, scheme, width_px)

    assert window.evaluate("document.documentElement.scrollWidth") <= width_px
    assert window.evaluate(ASIDE) == []
    assert window.evaluate(CUT) == []
    assert window.evaluate(SCALE) >= LEAST_SCALE
    assert window.evaluate(CONTRAST) >= LEAST_CONTRAST
    assert window.events_of("Log.entryAdded") == []


def test_what_rounds_to_nothing_has_no_minus(page: Path) -> None:
    assert re.findall(r"-0\.0+(?!\d)", prose(page.read_text(encoding="utf-8"))) == []
