"""The page of a fleet: what it says, and that browsers and screen readers show it."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from browser import Browser
from conftest import SAMPLES
from page_faults import ASIDE, CONTRAST, LEAST_CONTRAST
from simulated_fleet import LATCH, Fault, Fleet
from skiplatch.cli import group
from skiplatch.fleet.findings import find
from skiplatch.fleet.history import History
from skiplatch.report.fleet import ICONS, NEXT, NEXT_BETTER, NEXT_UNKNOWN, as_html
from skiplatch.simulator.effects import effects
from test_diagnosis_report import Elements, prose

MOST_BYTES = 5_000_000
ODD = '<b>mill "7" & Söhne</b>'
WIDTHS_PX = (400, 1280)


def page_of(history: History, *, weeks: int = 52, days: float = 400.0) -> str:
    findings = find(history, days=days, alarms_a_month=0.02)
    return as_html(findings, store="works", weeks=weeks)


@pytest.fixture(scope="module")
def fleet() -> tuple[History, dict[str, Fault]]:
    """Six rigs, of which three changed; of one every other campaign is not diagnosed."""
    history, faults = Fleet(rigs=6, weeks=30, changing=3, wild=0.0).drawn(4)
    still = next(rig for rig in history if rig not in faults)
    history[ODD] = [
        replace(entry, gap_um=None, verdict=None, gaps={}) if week % 2 else entry
        for week, entry in enumerate(history.pop(still))
    ]
    return history, faults


@pytest.fixture(scope="module")
def page(fleet: tuple[History, dict[str, Fault]]) -> str:
    return page_of(fleet[0])


def test_every_cell_leads_to_its_facts(fleet: tuple[History, dict[str, Fault]], page: str) -> None:
    grid = page[page.index('<div class="weeks"') : page.index("</table>")]
    links = re.findall(r'<td class="g[0-5x]"><a href="#(c\d+)">', grid)
    rows = re.findall(r'<tr id="(c\d+)">', page)

    assert len(links) == sum(map(len, fleet[0].values())) == 6 * 30
    assert sorted(links) == sorted(rows) == sorted(set(rows))
    for rig, entries in fleet[0].items():
        for entry in entries[:2]:
            assert f">{entry.campaign[:12]}</td>" in page, rig


def test_page_is_nested_and_needs_nothing_from_elsewhere(page: str) -> None:
    elements = Elements(page)
    ids = [attributes["id"] for _, attributes in elements.found if "id" in attributes]

    assert elements.open == []
    assert len(ids) == len(set(ids))
    assert not elements.all("script")
    for _, attributes in elements.found:
        for name in ("href", "aria-labelledby"):
            target = attributes.get(name, "data:")
            assert target.startswith("data:") or target.removeprefix("#") in ids
    assert ODD not in page
    assert "mill &#34;7&#34; &amp; Söhne" in page


def test_changed_rigs_come_first_with_what_to_do(
    fleet: tuple[History, dict[str, Fault]], page: str
) -> None:
    history, faults = fleet
    rows = re.findall(r'<tr><th scope="row"><a href="#r\d+">(.*?)</a></th>', page)
    tasks = page[page.index('class="tasks"') : page.index("</ul>")]

    assert set(rows[:3]) == set(faults)
    assert len(rows) == len(history)
    assert "3 of 6 rigs have changed" in page
    for rig, fault in faults.items():
        (task,) = [one for one in tasks.split("<li>") if f">{rig}</a>" in one]
        assert NEXT[fault.observable.stage] in task
        assert f"{fault.observable.effect}.{fault.observable.parameter} 0 → " in task
        assert f'<i class="{fault.observable.stage}">{fault.observable.stage}</i>' in task


def test_cell_shows_gap_stage_and_where_the_change_began(
    fleet: tuple[History, dict[str, Fault]], page: str
) -> None:
    history, faults = fleet
    for rig, fault in faults.items():
        (row,) = re.findall(rf">{rig}</a></th>(.*?)</tr>", page)
        cells = re.findall(r"<td.*?</td>", row)[::-1]
        assert len(cells) == 30
        stage = f'<i class="{fault.observable.stage}">{fault.observable.stage}</i>'
        assert [stage in cell for cell in cells] == [w >= fault.week for w in range(30)]
        (began,) = [week for week, cell in enumerate(cells) if "<u>changed</u>" in cell]
        assert abs(began - fault.week) <= 1
        shown = [float(re.search(r'">([\d.]+)<', cell)[1]) for cell in cells]  # type: ignore[index]
        gaps = [entry.gap_um for entry in history[rig]]
        assert shown == pytest.approx(gaps, rel=0.05)


def test_colour_goes_by_the_gap() -> None:
    history, _ = Fleet(rigs=1, weeks=8, changing=0).drawn(1)
    gaps = [0.0, 0.99, 1.0, 4.9, 5.0, 19.9, 20.0, None]
    entries = [replace(e, gap_um=gap) for e, gap in zip(history["rig-000"], gaps, strict=True)]

    page = page_of({"a": entries})

    marks = re.findall(r'<td class="(g.)">', page)[::-1]
    assert marks == ["g0", "g0", "g1", "g2", "g3", "g4", "g5", "gx"]


def test_what_nobody_diagnosed_is_said(page: str) -> None:
    assert "15 campaigns are not diagnosed" in page
    assert len(re.findall(r'<td class="gx"><a href="#c\d+">\?</a>', page)) == 15


def test_a_fleet_without_changes_says_so() -> None:
    history, _ = Fleet(rigs=3, changing=0, wild=0.0).drawn(2)

    assert "No rig has changed" in page_of(history)


def test_a_repair_is_no_alarm_to_run_for() -> None:
    history, faults = Fleet(rigs=2, changing=1, wild=0.0).drawn(2)
    (rig,) = faults
    times = [entry.time for entry in history[rig]]
    turned = [
        replace(entry, time=when) for entry, when in zip(reversed(history[rig]), times, strict=True)
    ]

    page = page_of({rig: turned})

    assert NEXT_BETTER in page
    assert NEXT_UNKNOWN not in page


def test_only_the_newest_weeks_are_shown(fleet: tuple[History, dict[str, Fault]]) -> None:
    page = page_of(fleet[0], weeks=4)

    assert len(re.findall(r'<tr id="c\d+">', page)) == 6 * 4


def test_of_several_campaigns_in_a_week_the_worst_is_shown() -> None:
    history, _ = Fleet(rigs=1, weeks=1, changing=0).drawn(1)
    (entry,) = history["rig-000"]
    worse = replace(entry, campaign="f" * 64, gap_um=33.0)

    page = page_of({"a": [entry, worse]})

    assert re.findall(r'<td class="(g.)"><a href="#c\d">(.*?)</a>', page) == [("g5", "33")]
    assert len(re.findall(r'<tr id="c\d">', page)) == 2


def test_every_stage_has_an_icon_and_advice() -> None:
    stages = {effect.stage for effect in effects().values()}

    assert set(ICONS) == set(NEXT) == stages
    assert len(set(ICONS.values())) == len(ICONS)


def test_two_hundred_rigs_and_a_year_are_a_small_page() -> None:
    history, _ = Fleet().drawn(1)

    page = page_of(history)

    assert len(page.encode()) < MOST_BYTES
    assert len(re.findall(r'<tr id="c\d+">', page)) == 200 * 52


def test_command_writes_the_page_of_a_store(tmp_path: Path) -> None:
    store, out = tmp_path / "store", tmp_path / "page.html"
    sample = SAMPLES / "rig_nominal"
    runner = CliRunner()
    runner.invoke(group, ["fleet", "add", str(sample), "--rig", ODD, "--store", str(store)])

    words = ["fleet", "report", "--store", str(store), "--html", str(out)]
    result = runner.invoke(group, words, catch_exceptions=False)

    assert result.exit_code == 0, result.output
    assert "1 rig, 0 changed" in result.output
    assert "1 campaign is not diagnosed" in prose(out.read_text())


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_browser_shows_the_page_on_small_and_large_screens(
    window: Browser, page: str, tmp_path: Path, scheme: str
) -> None:
    path = tmp_path / "page.html"
    path.write_text(page)
    for width_px in WIDTHS_PX:
        window.open(path, scheme, width_px)

        assert window.evaluate("document.documentElement.scrollWidth") <= width_px
        assert window.evaluate(ASIDE) == []
        assert window.evaluate(CONTRAST) >= LEAST_CONTRAST
        icon = "getComputedStyle(document.querySelector('.weeks i'), '::before').content"
        assert any(one in window.evaluate(icon) for one in ICONS.values())
        assert window.events_of("Log.entryAdded") == []
        urls = [event["request"]["url"] for event in window.events_of("Network.requestWillBeSent")]
        assert {url for url in urls if not url.startswith("data:")} == {path.as_uri()}


@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_screen_reader_finds_tables_with_names_and_headers(
    window: Browser, page: str, tmp_path: Path, width_px: int
) -> None:
    path = tmp_path / "page.html"
    path.write_text(page)
    window.open(path, "light", width_px)

    nodes = [
        (node["role"]["value"], node.get("name", {}).get("value", ""))
        for node in window.call("Accessibility.getFullAXTree")["nodes"]
        if not node["ignored"] and "role" in node
    ]
    names = {role: [name for found, name in nodes if found == role] for role, _ in nodes}
    assert any("Largest gap of the week in µm" in name for name in names["table"])
    assert {"Rig", "Gap", "Stage"} <= set(names["columnheader"])
    assert ODD in names["rowheader"]
    assert [name for name in names["link"] if not name] == []
    assert any(LATCH.stage in name for name in names["link"])
    assert not any(icon in name for name in names["link"] for icon in ICONS.values())


def test_browser_follows_a_cell_to_its_facts(window: Browser, page: str, tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    path.write_text(page)
    window.open(path, "light", WIDTHS_PX[0])

    window.evaluate("document.querySelectorAll('.weeks td a')[100].click(), 1")

    shown = "document.querySelector(':target').getBoundingClientRect()"
    assert 0 <= window.evaluate(f"{shown}.top") < 1000
