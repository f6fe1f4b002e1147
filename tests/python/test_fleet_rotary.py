"""A fleet with rotary axes: what is kept and told of them is in arcsec."""

import json
import re
from collections.abc import Sequence
from datetime import timedelta
from pathlib import Path

import duckdb
import pytest
from click.testing import CliRunner

from browser import Browser
from page_faults import ASIDE, CONTRAST, LEAST_CONTRAST
from simulated_fleet import START
from skiplatch.cli import group
from skiplatch.fleet.findings import Findings, change_text, find
from skiplatch.fleet.history import read_history
from skiplatch.fleet.machine_texts import open_metrics
from skiplatch.fleet.reading import opened
from skiplatch.fleet.store import opened_for_writing
from skiplatch.report.fleet import as_html
from test_diagnosis_report import prose

TURNED = "touch,axis,deviation_arcsec,feed_mm_min\n1,C,9,100\n2,C,27,100\n"
MOVED = "touch,axis,deviation_um,feed_mm_min\n1,X,9,100\n2,X,27,100\n"
BOTH = "touch,axis,deviation_um,deviation_arcsec,feed_mm_min\n1,X,9,,100\n2,C,,27,100\n"
GAPS_UM = (2.0, 2.1, 1.9, 2.0, 2.1, 9.0, 9.1, 8.9, 9.0)
"""Of a rig by weeks, in the unit of a diagnosis; 1 µm is 3.6″ of a rotary axis."""


def diagnosis(gap_um: float) -> str:
    """A made-up diagnosis that blames the play for the gap."""
    size = 4.0 * gap_um
    effect = {
        "id": "backlash",
        "stage": "position",
        "confidence": 0.9,
        "params": {"backlash_um": size},
        "intervals": {"backlash_um": [size - 0.5, size + 0.5]},
    }
    gap = {"unit": "µm", "before": gap_um, "after": 0.1, "noise_floor": 0.1}
    return json.dumps(
        {
            "format": "skiplatch-diagnosis/2",
            "verdict": "explained",
            "where": [{"stage": "position"}],
            "gap": {"deviation": gap},
            "effects": [effect],
        }
    )


def kept(store: Path, rig: str, touches: str, gaps_um: Sequence[float]) -> Path:
    """Keep a campaign a week of a rig."""
    with opened_for_writing(store) as writer:
        for week, gap_um in enumerate(gaps_um):
            folder = store.parent / rig / f"week-{week}"
            folder.mkdir(parents=True)
            when = START + timedelta(weeks=week)
            (folder / "nominal.toml").write_text(
                f'format = "skiplatch-campaign/2"\nkind = "machine"\n'
                f"[notes]\nrecorded_at = {when.isoformat()}Z\n"
            )
            (folder / "touches.csv").write_text(touches)
            (folder / "diagnosis.json").write_text(diagnosis(gap_um))
            writer.add(folder)
        writer.commit()
    return store


def told(*words: object) -> str:
    result = CliRunner().invoke(group, ["fleet", *map(str, words)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def findings(store: Path) -> Findings:
    with opened(store, with_touches=False) as reader:
        return find(read_history(reader), days=400.0, alarms_a_month=0.02)


@pytest.fixture(scope="module")
def turning(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with one rig whose axis turns, and which changed."""
    return kept(tmp_path_factory.mktemp("turning") / "store", "table", TURNED, GAPS_UM)


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with a rig of a linear axis beside two whose axes turn, or do both."""
    store = tmp_path_factory.mktemp("mixed") / "store"
    kept(store, "mill", MOVED, GAPS_UM)
    kept(store, "table", TURNED, GAPS_UM)
    return kept(store, "mill-turn", BOTH, GAPS_UM[:2])


def test_gaps_of_a_rotary_axis_are_kept_in_arcsec(mixed: Path) -> None:
    with opened(mixed) as reader:
        rows = reader.query(
            "SELECT rig, axes, gap_um, gap_arcsec FROM campaigns WHERE folder = 'week-0'"
        ).rows
        units = reader.query("SELECT DISTINCT rig, unit FROM gaps ORDER BY rig").rows

    assert rows == [
        ("mill", "linear", 2.0, None),
        ("mill-turn", "mixed", 2.0, None),
        ("table", "rotary", None, pytest.approx(7.2)),
    ]
    assert units == [("mill", "µm"), ("mill-turn", "µm or mdeg"), ("table", "arcsec")]


def test_history_has_gaps_and_parameters_in_the_units_of_the_axes(mixed: Path) -> None:
    with opened(mixed, with_touches=False) as reader:
        history = read_history(reader)
    first = {rig: entries[0] for rig, entries in history.items()}

    assert first["mill"].gap == (2.0, "µm")
    assert first["mill-turn"].gap == (2.0, "µm or mdeg")
    gap = first["table"].gaps["deviation"]
    assert first["table"].gap == (gap.before, "arcsec")
    assert gap.unit == "arcsec"
    assert [gap.before, gap.noise_floor] == pytest.approx([7.2, 0.36])
    turned = {rig: entry.parameters[0].turned for rig, entry in first.items()}
    assert turned == {"mill": "", "mill-turn": "µm or mdeg", "table": "mdeg"}


def test_a_rotary_rig_alone_is_listed_and_shown_without_lengths(turning: Path) -> None:
    rigs, shown = told("list", "--store", turning), told("show", "table", "--store", turning)

    assert "gap_um" not in rigs
    assert re.search(r"gap_arcsec\n.* 32\.4\d*\n", rigs)
    header, first = (
        shown.splitlines()[0],
        next(line for line in shown.splitlines() if "week-0" in line),
    )
    assert "deviation_arcsec" in header
    assert "_um" not in header
    assert "7.2" in first
    assert "backlash.backlash_um = 8.000 (7.500 … 8.500) mdeg" in first


def test_a_linear_rig_alone_has_no_angles(mixed: Path) -> None:
    shown = told("show", "mill", "--store", mixed)

    assert "arcsec" not in shown
    assert "axes" not in shown
    assert "backlash.backlash_um = 8.000 (7.500 … 8.500)\n" in shown


def test_json_has_both_units(mixed: Path) -> None:
    rigs = json.loads(told("list", "--store", mixed, "--json", "-"))["rigs"]
    shown = json.loads(told("show", "table", "--store", mixed, "--json", "-"))["campaigns"]

    assert {rig["rig"]: (rig["gap_um"], rig["gap_arcsec"]) for rig in rigs} == {
        "mill": (9.0, None),
        "mill-turn": (2.1, None),
        "table": (None, pytest.approx(32.4)),
    }
    assert shown[0]["deviation_um"] is None
    assert shown[0]["deviation_arcsec"] == 18.0
    assert shown[0]["axes"] == "rotary"


def test_a_change_is_told_in_arcsec(turning: Path) -> None:
    found = findings(turning)
    (change,) = found.recent
    gauges = open_metrics(found)

    assert " arcsec; began" in change_text(change)
    assert re.search(r"backlash\.backlash_um 8\.\d+ → 36 \(.*\) mdeg", change_text(change))
    assert re.search(r'rig_gap_arcsec\{rig="table"\} 32\.4', gauges)
    assert "rig_gap_um{" not in gauges


def test_page_of_rotary_rigs_says_arcsec(turning: Path) -> None:
    page = as_html(findings(turning), store="works", weeks=52)
    text = prose(page)

    assert "µm" not in text
    assert "Gap in arcsec" in text
    assert "Largest gap of the week in arcsec (″)" in text
    cells = re.findall(r'<td class="(g.)"><a href="#c\d+">([\d.]+″)', page)
    assert cells[0] == ("g4", "32″")
    assert cells[-1] == ("g2", "7.2″")
    assert "<td>32 arcsec</td>" in page
    assert "backlash.backlash_um = 36 (35.5 … 36.5) mdeg" in page


def test_page_of_both_says_each(mixed: Path) -> None:
    page = as_html(findings(mixed), store="works", weeks=52)

    assert "Gap in µm" in page
    assert "Gap in arcsec" in page
    assert "in µm, of rotary axes in arcsec (″)" in page
    for gap in ("9 µm", "32 arcsec", "2.1 µm or mdeg"):
        assert f"<td>{gap}</td>" in page


NEWER = "axes, gap_arcsec, touches_sha256, index_sha256"


def test_a_store_from_before_the_axes_were_kept_is_read_and_added_to(tmp_path: Path) -> None:
    store = kept(tmp_path / "store", "mill", MOVED, GAPS_UM[:2])
    index = store / "campaigns.parquet"
    with duckdb.connect() as engine:
        old = tmp_path / "old.parquet"
        engine.read_parquet(str(index)).project(f"* EXCLUDE ({NEWER})").write_parquet(str(old))
    old.replace(index)

    kept(store, "table", TURNED, GAPS_UM[:1])

    with opened(store, with_touches=False) as reader:
        history = read_history(reader)
    assert [entry.gap for entry in history["mill"]] == [(2.0, "µm"), (2.1, "µm")]
    assert [entry.gap_arcsec for entry in history["table"]] == [pytest.approx(7.2)]


@pytest.mark.parametrize("width_px", [400, 1280])
def test_browser_shows_both_units(
    window: Browser, mixed: Path, tmp_path: Path, width_px: int
) -> None:
    path = tmp_path / "page.html"
    path.write_text(as_html(findings(mixed), store="works", weeks=52))
    window.open(path, "light", width_px)

    assert window.evaluate("document.documentElement.scrollWidth") <= width_px
    assert window.evaluate(ASIDE) == []
    assert window.evaluate(CONTRAST) >= LEAST_CONTRAST
