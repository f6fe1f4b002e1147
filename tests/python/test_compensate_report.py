"""The page of a compensation: what it says, that it needs nothing else, that browsers show it."""

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from browser import Browser
from seat_probe import OMP40, radii, write_radii, write_speeds
from skiplatch import cli
from test_diagnosis_report import SCHEMES, SCREENS, Elements, prose

V0, TAU = 50.0, 12.68
CASES = ("predicted", "measured", "single")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Pages with what is predicted, with what was measured, and of a single run."""
    folder = tmp_path_factory.mktemp("pages")
    many = write_radii(folder / "many.csv", radii(OMP40, V0, TAU, runs=10, sigma_um=0.3))
    one = write_radii(folder / "one.csv", radii(OMP40, V0, TAU, runs=1, sigma_um=0.0))
    speeds = write_speeds(folder / "speeds.csv", TAU, sigma_um=0.2)

    def page(name: str, *arguments: object) -> Path:
        path = folder / f"{name}.html"
        out = ["--out", folder / "t.csv", "--html", path]
        call = ["compensate", *map(str, [*arguments, "--v0", V0, *out])]
        result = CliRunner().invoke(cli.group, call)
        assert result.exit_code == 0, result.output
        return path

    found = {"predicted": page("predicted", many, "--tau-from", speeds)}
    feeds = np.loadtxt(folder / "t.csv", delimiter=",", skiprows=1)[:, 2]
    again = radii(OMP40, feeds, TAU, runs=10, sigma_um=0.3, seed=8)
    after = write_radii(folder / "after.csv", again)
    found["measured"] = page("measured", many, "--tau-from", speeds, "--after", after)
    found["single"] = page("single", one, "--tau", TAU)
    return found


@pytest.fixture(params=CASES)
def page(request: pytest.FixtureRequest, pages: dict[str, Path]) -> str:
    return pages[request.param].read_text()


def test_page_is_nested_and_every_id_is_there_once(page: str) -> None:
    elements = Elements(page)
    ids = [attributes["id"] for _, attributes in elements.found if "id" in attributes]

    assert page.startswith("<!DOCTYPE html>")
    assert elements.open == []
    assert len(ids) == len(set(ids))
    for _, attributes in elements.found:
        for name in ("aria-labelledby", "xlink:href"):
            if name in attributes:
                assert attributes[name].removeprefix("#") in ids


def test_page_needs_nothing_from_elsewhere_and_takes_its_own_colours(page: str) -> None:
    elements = Elements(page)
    drawn = "".join(re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL))

    assert not elements.all("script")
    assert set(re.findall(r"url\((.)", page)) <= {"#"}
    for _, attributes in elements.found:
        for name in ("href", "xlink:href", "src"):
            assert attributes.get(name, "#").startswith(("#", "data:"))
    assert not re.findall(r"(?:fill|stroke): #[0-9a-f]{6}", drawn)


def test_every_picture_has_text_of_its_own(page: str) -> None:
    labels = [attributes.get("aria-label", "") for attributes in Elements(page).all("svg")]

    assert len(labels) >= 3
    assert all(len(label) > 100 for label in labels)
    assert len(set(labels)) == len(labels)


def test_predicted_page_has_delay_figures_budget_and_draws(pages: dict[str, Path]) -> None:
    text = prose(pages["predicted"].read_text())

    assert re.search(
        r"Trigger radius varies by 1\d\.\d µm; with the speed table, \d\.\d µm, as", text
    )
    for words in (
        "as predicted",
        "the delay is the slope: τ = 12.",
        "ring, β 80°",
        "sphere 109",
        "between two directions of the map",
        "Monte Carlo: standard deviation",
    ):
        assert words in text
    assert "Notes" not in text
    assert "measured with the table" not in text


def test_measured_page_shows_both_and_takes_the_measured_one(pages: dict[str, Path]) -> None:
    page = pages["measured"].read_text()
    text = prose(page)

    assert re.search(r"with the speed table, \d\.\d µm, as measured", text)
    assert "measured with the table, less its mean: V_r" in text
    assert "Range of the trigger radii on ring and sphere, measured with a table" in text
    assert page.count("<svg") == 6


def test_single_run_says_that_its_random_error_is_unknown(pages: dict[str, Path]) -> None:
    text = prose(pages["single"].read_text())

    assert "One run says nothing of random error" in text
    assert "repeatability: unknown" in text
    assert "109 directions · 1 run " in text


def test_same_input_is_the_same_page(pages: dict[str, Path], tmp_path: Path) -> None:
    folder = pages["single"].parent
    path = tmp_path / "again.html"
    base = ["compensate", str(folder / "one.csv"), "--v0", str(V0), "--tau", str(TAU)]
    CliRunner().invoke(cli.group, [*base, "--out", str(tmp_path / "t.csv"), "--html", str(path)])

    assert path.read_text() == pages["single"].read_text()


@pytest.mark.parametrize(("width_px", "scheme"), SCREENS)
@pytest.mark.parametrize("case", CASES)
def test_browser_shows_the_page_without_a_complaint(
    window: Browser, pages: dict[str, Path], case: str, width_px: int, scheme: str
) -> None:
    window.open(pages[case], scheme, width_px)

    ground = window.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == SCHEMES[scheme]
    first = window.evaluate("document.querySelector('svg [id$=patch_1]').id")
    patch = f"getComputedStyle(document.querySelector('svg #{first} path')).fill"
    assert window.evaluate(patch) == ground
    assert window.evaluate("document.documentElement.scrollWidth") <= width_px
    assert window.picture().startswith(b"\x89PNG")
    for event in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"):
        assert window.events_of(event) == []
