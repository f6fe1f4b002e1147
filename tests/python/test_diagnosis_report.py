"""The page of a diagnosis: what it says, that it needs nothing else, and that browsers show it."""

import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from browser import Browser
from made_diagnoses import made
from page_faults import ASIDE, CUT
from skiplatch import cli
from skiplatch.campaign import Axis, Campaign, Status, Touches, read_campaign
from skiplatch.commands import examining as command
from skiplatch.diagnosis import Diagnosis, Named, Place, Verdict
from skiplatch.diagnosis.candidates.axes import idle
from skiplatch.diagnosis.experiment import Experiment
from skiplatch.diagnosis.fit.beliefs import uncertain
from skiplatch.diagnosis.fit.material import Materiality
from skiplatch.diagnosis.plays.left import Left
from skiplatch.diagnosis.plays.playing import Rig
from skiplatch.diagnosis.plays.surfaces import FittedDatum
from skiplatch.diagnosis.reported.diagnosis import Ranked
from skiplatch.diagnosis.reported.notes import notes
from skiplatch.diagnosis.reported.text import as_text
from skiplatch.diagnosis.scene.scene import Scene
from skiplatch.diagnosis.verdict.shrink import Gap, PlayedRigs
from skiplatch.diagnosis.verdict.verdict import Failure
from skiplatch.errors import InputError
from skiplatch.report.conditions import conditions, most_telling
from skiplatch.report.evidence import gather
from skiplatch.report.page import as_html
from skiplatch.report.words import found
from skiplatch.simulator.effects import Effect, effects
from skiplatch.statistics import Interval
from skiplatch.ways import Ways

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
BENCH = SAMPLES / "bench_isr_latency"
MOST_BYTES = 2_000_000
VOID = {"meta", "link", "br", "wbr", "hr", "img", "input"}
SCHEMES = {"light": "rgb(255, 255, 254)", "dark": "rgb(13, 17, 23)"}
WIDE_PX, NARROW_PX = 1200, 360
SCREENS = [
    (WIDE_PX, "light"),
    (NARROW_PX, "dark"),
    pytest.param(WIDE_PX, "dark", marks=pytest.mark.nightly),
    pytest.param(NARROW_PX, "light", marks=pytest.mark.nightly),
]
"""Colours are the same at any width."""


def effect(effect_id: str, **given: float) -> Effect:
    """Give an effect with all of its parameters."""
    known = effects()[effect_id].parameters
    return Effect(effect_id, {p.name: given.get(p.name, max(0.0, p.low)) for p in known})


LATE = effect("isr_latency", latency_us=41.7)
FILTER = effect("input_filter", delay_us=41.7)
LATE_LATCH = Place("latch", "skip", "latch_skip", "everywhere", 41.7, "µs", ("isr_latency",))


def diagnosed(campaign: Campaign, verdict: Verdict, *found: Effect) -> Diagnosis:
    """Put a diagnosis together by hand, so that the page is tested apart from the search."""
    scene = Scene.of(campaign)
    everything = scene.has_stamps | ~scene.has_stamps
    intervals = {name: (value - 0.5, value + 0.5) for name, value in LATE.parameters.items()}
    believed, rig = Rig(campaign.nominal), Rig(campaign.nominal, found)
    return made(
        verdict,
        believed,
        rig,
        [Named(one, "latch", intervals, ("input_filter",), 0.9) for one in found],
        where=[LATE_LATCH] if found else [],
        gap=PlayedRigs.of(scene, believed, rig, seed=1, jobs=2).gaps(everything),
        ranking=[Ranked((LATE,), 900.0), Ranked((FILTER,), 898.5), Ranked((), -2.0)],
        rivals=[Ranked((LATE,), 900.0), Ranked((FILTER,), 898.5)],
        touches=len(scene),
        used=len(scene),
        notes=["A note."],
    )


@cache
def explained() -> tuple[Campaign, Diagnosis]:
    campaign = read_campaign(BENCH)
    return campaign, diagnosed(campaign, Verdict.EXPLAINED, LATE)


@cache
def no_gap() -> tuple[Campaign, Diagnosis]:
    campaign = read_campaign(SAMPLES / "machine_no_gap")
    return campaign, replace(diagnosed(campaign, Verdict.NO_GAP), ranking=[], rivals=[], notes=[])


@cache
def unknown() -> tuple[Campaign, Diagnosis]:
    campaign = read_campaign(BENCH)
    place = Place("latch", "skip", "latch_skip", "time squared", 0.4, "1")
    left = [Left("latch", "skip", "shift", ("time",), 0.4, "µs", 1.2, 0.33, 0.25, 9.5)]
    return campaign, replace(diagnosed(campaign, Verdict.UNKNOWN), where=[place], left=left)


CASES = {"explained": explained, "no_gap": no_gap, "unknown": unknown}


@pytest.fixture(scope="module")
def pages() -> dict[str, str]:
    return {
        name: as_html(campaign, diagnosis, name=name, seed=1, jobs=2)
        for name, (campaign, diagnosis) in ((name, case()) for name, case in CASES.items())
    }


@pytest.fixture(params=list(CASES))
def page(request: pytest.FixtureRequest, pages: dict[str, str]) -> str:
    return pages[request.param]


class Elements(HTMLParser):
    """Every element with its attributes, in order; checks that they are nested."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str]]] = []
        self.open: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), (tag, names)
        self.found.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag

    def all(self, tag: str) -> list[dict[str, str]]:
        return [attributes for name, attributes in self.found if name == tag]


def prose(page: str) -> str:
    """Give what a reader sees, without tags."""
    body = re.sub(r"<svg.*?</svg>", "", page[page.index("<body>") :], flags=re.DOTALL)
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", body.replace("<wbr>", "")))


def test_page_is_nested_and_every_id_is_there_once(page: str) -> None:
    elements = Elements(page)
    ids = [attributes["id"] for _, attributes in elements.found if "id" in attributes]

    assert page.startswith("<!DOCTYPE html>")
    assert elements.open == []
    assert elements.all("html") == [{"lang": "en"}]
    assert len(ids) == len(set(ids))
    for _, attributes in elements.found:
        for name in ("aria-labelledby", "xlink:href"):
            if name in attributes:
                assert attributes[name].removeprefix("#") in ids
        for reference in re.findall(r"url\(#([^)]*)\)", " ".join(attributes.values())):
            assert reference in ids


def test_every_figure_has_text(page: str) -> None:
    elements = Elements(page)
    pictures = [a for _, a in elements.found if a.get("role") == "img"]

    assert len(elements.all("svg")) >= 6
    assert all(a.get("role") == "img" for a in elements.all("svg"))
    assert all(len(a.get("aria-label", "")) > 60 for a in elements.all("svg"))
    assert len(pictures) > len(elements.all("svg"))  # the chain
    assert all(a.get("aria-label") for a in pictures)
    labels = [a["aria-label"] for a in elements.all("svg")]
    assert len(labels) == len(set(labels))


def test_page_needs_nothing_from_elsewhere(page: str) -> None:
    elements = Elements(page)

    assert len(page.encode()) < MOST_BYTES
    assert not elements.all("script")
    assert not any(name.startswith("on") for _, a in elements.found for name in a)
    for _, attributes in elements.found:
        for name in ("href", "xlink:href", "src", "srcset", "data", "action"):
            assert attributes.get(name, "#").startswith(("#", "data:"))
    assert "@import" not in page
    assert set(re.findall(r"url\((.)", page)) <= {"#"}


def test_pictures_take_every_colour_from_the_page(page: str) -> None:
    drawn = "".join(re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL))

    assert not re.findall(r"(?:fill|stroke): #[0-9a-f]{6}", drawn)
    used = set(re.findall(r"var\(--([a-z-]+)\)", page))
    for variable in used:
        assert len(re.findall(rf"--{variable}: #", page)) == len(SCHEMES), variable


def test_explained_gap_is_named_marked_and_measured(pages: dict[str, str]) -> None:
    text = prose(pages["explained"])
    stages = dict(re.findall(r'class="stage (\w*)"><b>(\w+)', pages["explained"]))

    assert "isr_latency explains the gap" in text
    assert "latency_us 41.7 41.2 … 42.2 µs" in text
    assert "Cannot be told from input_filter" in text
    assert stages["found"] == "latch"
    assert stages["possible"] == "input"
    assert re.search(r"latch − edge (9\d|100)%.{0,20} µs 4\d\.\d 0\.\d+ 0\.\d+", text)
    assert re.search(r"input_filter.{0,60}898\.5 1\.5 cannot be told from it", text)
    assert "Of the others tried, 1 gained nothing." in text
    assert "simulation with the effects" in text
    assert "A note." in text


def test_no_gap_marks_nothing(pages: dict[str, str]) -> None:
    text = prose(pages["no_gap"])

    assert "No gap" in text
    assert not re.search(r'class="stage (found|possible|left)"', pages["no_gap"])
    assert "with the effects" not in text
    assert "What causes it" not in text
    assert "Notes" not in text


def test_unknown_says_where_it_sits_and_what_it_looks_like(pages: dict[str, str]) -> None:
    text = prose(pages["unknown"])

    assert "no effect of the catalogue explains it" in text
    assert "It shows in latch." in text
    assert "latch, the skip path goes with time 0.400 µs 1e-21" in text
    assert re.findall(r'class="stage left"><b>(\w+)', pages["unknown"]) == ["latch"]
    assert "What causes it" not in text


def test_next_experiment_is_a_table_if_there_is_one(pages: dict[str, str]) -> None:
    campaign, diagnosis = no_gap()
    touches = campaign.touches.select(slice(20))
    experiment = Experiment("Record <edge_us>.", None, touches, 0.1, 0.9, 12, (("a",), ("b",)))

    page = as_html(campaign, diagnosis, name="a", seed=1, next_experiment=experiment)

    assert "<p>Record &lt;edge_us&gt;.</p>" in page
    assert page.count('data-label="feed_mm_min"') == 10
    assert "… and 10 other conditions Expected: 0.9 bits in all touches" in prose(page)
    assert "feed_mm_min Programmed measuring feed" in prose(page)  # among the words
    assert "What to do next" not in pages["no_gap"]


@pytest.mark.usefixtures("unrendered")
def test_ranking_shows_differences_and_no_powers_of_ten() -> None:
    campaign, diagnosis = explained()
    tiny = replace(FILTER, parameters={**FILTER.parameters, "tail_us": 3.66e-08})
    close = [Ranked((LATE,), 1658.0), Ranked((tiny,), 1643.0), Ranked((FILTER, tiny), 400.0)]

    page = as_html(campaign, replace(diagnosis, ranking=close), name="a", seed=1)

    assert re.findall(r'style="width: ([\d.]+)%"', page) == ["0.0", "50.0", "100.0"]
    assert page.count('<i class="cut" style="width: 100.0%">') == page.count('class="cut"') == 1
    assert "is cut at 30 nats" in prose(page)
    assert "tail_us 0;" in prose(page) or "tail_us 0 " in prose(page)
    assert "e-08" not in prose(page)


@pytest.mark.usefixtures("unrendered")
def test_no_bar_is_called_cut_that_ends_within_the_scale() -> None:
    campaign, diagnosis = explained()
    close = [Ranked((LATE,), 1658.0), Ranked((FILTER,), 1628.0)]

    page = as_html(campaign, replace(diagnosis, ranking=close), name="a", seed=1)

    assert 'class="cut"' not in page
    assert "is cut at" not in page


def test_words_of_the_page_are_explained(pages: dict[str, str]) -> None:
    assert "Natural logarithm of how many times likelier" in prose(pages["explained"])


def test_names_are_escaped() -> None:
    campaign, diagnosis = no_gap()

    page = as_html(campaign, diagnosis, name='<script>"a" & b', seed=1)

    assert "<script" not in page
    assert "&lt;script&gt;&#34;a&#34; &amp; b" in page


def test_same_diagnosis_is_the_same_page(pages: dict[str, str]) -> None:
    campaign, diagnosis = explained()

    assert as_html(campaign, diagnosis, name="explained", seed=1) == pages["explained"]


def test_simulation_with_the_effects_leaves_less() -> None:
    campaign, diagnosis = explained()

    evidence = gather(campaign, diagnosis, seed=1, jobs=2)
    seen = evidence.seen[evidence.telling]
    skip = evidence.touches.on_skip

    assert evidence.telling == "latch_after_edge_us"
    assert seen.left_after is not None
    assert 41.0 < seen.left_before[skip].mean() < 43.0
    assert abs(seen.left_after[skip].mean()) < 0.5


@pytest.mark.usefixtures("unrendered")
def test_missed_touches_are_counted() -> None:
    campaign, diagnosis = explained()
    touches = campaign.touches
    lost = touches.on_skip & (touches.touch % 2 == 0)
    columns = touches.columns()
    for name in ("edge_us", "latch_us", "report_us", "deviation_um"):
        columns[name] = columns[name].copy()
        columns[name][lost] = float("nan")
    columns["status"] = touches.status.copy()
    columns["status"][lost] = 1
    broken = replace(campaign, touches=Touches(**columns))

    text = prose(as_html(broken, diagnosis, name="a", seed=1))

    share = lost.sum() / touches.on_skip.sum()
    assert f"skip input {share:.1%} 0.0% 0.0%" in text


def test_condition_that_matters_most_comes_first() -> None:
    touches = read_campaign(BENCH).touches.in_order_of_time()

    chosen = most_telling(conditions(touches), touches.sign + 1e-3 * touches.temp_c, 2)

    assert chosen[0].title == "sense"
    assert len(chosen) == 2


@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize(
    ("share", "said"),
    [
        (Interval(0.984, 0.951, 0.996), "98% (95% … 100%)"),
        (Interval(1.0, 0.999, 1.0), "100%"),
        (Interval(-0.001, -0.3, 0.2), "0% (-30% … 20%)"),
    ],
)
def test_shrink_is_told_with_its_interval(share: Interval, said: str) -> None:
    campaign, diagnosis = explained()
    gap = {"latch_after_edge_us": Gap("latch − edge", "µs", 40.0, 1.0, 0.5, share)}

    text = prose(as_html(campaign, replace(diagnosis, gap=gap), name="a", seed=1))

    assert f"latch − edge {said} µs 40.0 1.00 0.500 " in text
    assert f"shrinks the gap in latch − edge by {said}, from 40.0 to 1.00 µs" in text


@pytest.mark.usefixtures("unrendered")
def test_gap_within_the_noise_is_not_said_to_shrink() -> None:
    campaign, diagnosis = explained()
    within = Gap("latch − edge", "µs", 0.4, 0.4, 0.5, Interval(0.0, -0.5, 0.5), is_clear=False)
    gap = {"latch_after_edge_us": within}

    text = prose(as_html(campaign, replace(diagnosis, gap=gap), name="a", seed=1))

    assert "shrinks the gap" not in text
    assert "latch − edge no gap µs 0.400 0.400 0.500" in text


@pytest.mark.parametrize("rows", [1, 7])
def test_few_touches_still_make_a_page(rows: int) -> None:
    campaign, diagnosis = explained()
    few = replace(campaign, touches=campaign.touches.select(slice(rows)))

    page = as_html(few, replace(diagnosis, gap={}), name="few", seed=1)

    assert "isr_latency explains the gap" in page


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the command find what is known already."""
    monkeypatch.setattr(command, "diagnose", lambda *_, **__: explained()[1])


@pytest.mark.usefixtures("quick")
def test_command_writes_the_page(tmp_path: Path) -> None:
    path = tmp_path / "page.html"

    result = CliRunner().invoke(cli.group, ["diagnose", str(BENCH), "--html", str(path)])

    assert result.exit_code == 0, result.output
    assert "bench_isr_latency · bench campaign · 400 touches" in path.read_text()
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("quick")
def test_page_that_cannot_be_written_is_bad_input(tmp_path: Path) -> None:
    path = tmp_path / "absent" / "page.html"

    with pytest.raises(InputError, match=r"page\.html: cannot write"):
        CliRunner().invoke(
            cli.group, ["diagnose", str(BENCH), "--html", str(path)], catch_exceptions=False
        )


@pytest.mark.parametrize(("width_px", "scheme"), SCREENS)
@pytest.mark.parametrize("case", list(CASES))
def test_browser_shows_the_page_without_a_complaint(
    window: Browser, pages: dict[str, str], tmp_path: Path, case: str, width_px: int, scheme: str
) -> None:
    path = tmp_path / f"{case}.html"
    path.write_text(pages[case])
    window.open(path, scheme, width_px)

    assert window.evaluate("document.compatMode") == "CSS1Compat"
    ground = window.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == SCHEMES[scheme]
    patch = "getComputedStyle(document.querySelector('svg #PATCH path')).fill"
    first = window.evaluate("document.querySelector('svg [id$=patch_1]').id")
    assert window.evaluate(patch.replace("PATCH", first)) == ground
    assert window.evaluate(CUT) == []
    assert window.evaluate(ASIDE) == []
    assert window.evaluate("document.documentElement.scrollWidth") <= width_px
    hidden = "[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth)"
    assert window.evaluate(f"{hidden}.length") == 0
    assert window.picture().startswith(b"\x89PNG")
    assert window.events_of("Runtime.exceptionThrown") == []
    assert window.events_of("Runtime.consoleAPICalled") == []
    assert window.events_of("Log.entryAdded") == []
    requests = [event["request"]["url"] for event in window.events_of("Network.requestWillBeSent")]
    assert {url for url in requests if not url.startswith("data:")} == {path.as_uri()}


def test_screen_reader_finds_a_name_for_every_picture(
    window: Browser, pages: dict[str, str], tmp_path: Path
) -> None:
    path = tmp_path / "page.html"
    path.write_text(pages["explained"])
    window.open(path, "light", WIDE_PX)

    nodes = window.call("Accessibility.getFullAXTree")["nodes"]
    names = [
        node.get("name", {}).get("value", "")
        for node in nodes
        if node.get("role", {}).get("value") in ("img", "image") and not node["ignored"]
    ]
    assert len(names) >= len(Elements(pages["explained"]).all("svg"))
    assert all(names)


@pytest.mark.parametrize(
    ("axes", "expected"),
    [
        ([Axis.Z], {"y_excess_ratio", "z_excess_ratio"}),
        ([Axis.X, Axis.Z], {"y_excess_ratio"}),
        ([Axis.X, Axis.Y, Axis.Z], set()),
    ],
)
def test_parameters_of_axes_that_do_not_touch_are_not_told(
    axes: list[Axis], expected: set[str]
) -> None:
    campaign, diagnosis = explained()
    touches = replace(campaign.touches, axis=np.resize(axes, len(campaign.touches)))
    sizes = {"y_excess_ratio": 0.0, "z_excess_ratio": 0.0, "scatter_us": 0.0}
    lag = effect("following_error", lag_us=50.0, **sizes)
    intervals = {name: (value, value) for name, value in lag.parameters.items()}
    named = Named(lag, "position", intervals, (), 0.9, idle=idle(touches, lag))

    told = found(named, no_gap()[1]).parameters.rows
    text = as_text(replace(diagnosis, effects=[named]))

    assert named.idle == expected
    assert {row[0] for row in told} == {"lag_us", *sizes} - expected
    assert "lag_us = 50" in text
    assert all(
        (f"  {name} = " in text) == (name not in expected)
        for name in ("y_excess_ratio", "z_excess_ratio")
    )
    assert idle(touches, replace(lag, parameters={**lag.parameters, "z_excess_ratio": 0.1})) == (
        expected - {"z_excess_ratio"}
    )


def turned(campaign: Campaign, rows: np.ndarray) -> Campaign:
    """Give the same touches by a rotary axis, as far as `rows` says: a degree for a millimetre."""
    axis = np.where(rows, Axis.C, campaign.touches.axis).astype(np.int8)
    return replace(campaign, touches=replace(campaign.touches, axis=axis))


@cache
def of_axes(*, all_turn: bool) -> tuple[Campaign, Diagnosis]:
    """Give a campaign of a rotary axis, or of one beside linear axes, and a made-up diagnosis."""
    whole = read_campaign(SAMPLES / "machine_no_gap")
    few = replace(whole, touches=whole.touches.select(np.arange(120)))
    campaign = turned(few, np.arange(120) % 4 < (4 if all_turn else 2))
    play = effect("backlash", backlash_um=12.5)
    diagnosis = diagnosed(campaign, Verdict.PARTLY_EXPLAINED, play)
    return campaign, replace(
        diagnosis,
        where=[
            Place("position", "skip", "deviation_skip", "everywhere", 10.0, "µm", ("backlash",))
        ],
        left=[Left("position", "skip", "shift", ("time",), 2.0, "µm", 1.2, 0.33, 0.25, 9.5)],
        effects=[Named(play, "position", {n: (v, v) for n, v in play.parameters.items()}, (), 0.9)],
        ranking=[],
        rivals=[],
        materiality=Materiality(um=1.0),
        rig=replace(diagnosis.rig, datum=FittedDatum({"C": 5.0})),
        ways=Ways.of(campaign.touches),
    )


@pytest.mark.usefixtures("unrendered")
def test_a_gap_of_which_nothing_is_seen_to_be_left_is_told_from_one_with_more() -> None:
    campaign, more = of_axes(all_turn=False)
    whole = replace(more, left=[])
    off = replace(whole, outliers=[3])
    wanting, apart = (
        replace(whole, failures=[Failure(rule, 0.0, "a reason", "words")])
        for rule in ("held_out", "few_outliers")
    )

    cases = ((more, False), (whole, True), (off, False), (wanting, True), (apart, False))
    for diagnosis, is_whole in cases:
        page = prose(as_html(campaign, diagnosis, name="c", seed=1, jobs=2))
        assert ("something else is left" in as_text(diagnosis)) != is_whole
        assert ("too few to be sure" in as_text(diagnosis)) == is_whole
        assert ("as far as these touches tell" in page) == is_whole
        assert ("explains part of the gap" in page) != is_whole


@pytest.mark.usefixtures("unrendered")
@pytest.mark.parametrize("factor", [1.2, 1.6])
def test_no_gap_says_which_beliefs_it_rests_on(factor: float) -> None:
    campaign, diagnosis = no_gap()
    (noise,) = [b for b in uncertain(campaign.nominal) if b.key[1] == "repeatability_um"]

    moved = replace(diagnosis, beliefs=[(noise, factor * noise.value)])

    is_far = factor > 1.5  # one standard uncertainty of a noise is a factor of 1.35
    assert ("where probe.repeatability_um is" in as_text(moved)) == is_far
    page = prose(as_html(campaign, moved, name="c", seed=1, jobs=2))
    assert ("with another probe.repeatability_um" in page) == is_far


@pytest.mark.usefixtures("unrendered")
def test_a_rotary_axis_is_told_in_arcsec() -> None:
    campaign, diagnosis = of_axes(all_turn=True)

    said = as_text(diagnosis), prose(as_html(campaign, diagnosis, name="c", seed=1, jobs=2))

    for text in said:
        assert not re.search(r"µm|mm/min| mm\b", text)
        assert "36.0 arcsec" in text  # 10 mdeg
        assert re.search(r"12\.5\S* .*mdeg", text)
    assert "7.20 arcsec" in said[1]  # left over
    assert "deg/min" in said[1]
    assert "3.6 arcsec on in lengths" in said[0]
    assert re.search(r"C\.surface_arcsec +0 +18\.0", said[0])
    before = re.search(r"deviation_arcsec +arcsec +(\S+)", said[0])
    assert before is not None
    assert float(before[1]) == pytest.approx(3.6 * diagnosis.gap["deviation_um"].before, rel=0.01)


def test_what_could_hide_at_a_rotary_axis_is_told_in_arcsec() -> None:
    _, diagnosis = of_axes(all_turn=True)
    gap = {"deviation_um": replace(diagnosis.gap["deviation_um"], could_hide=2.0)}

    said = as_text(replace(diagnosis, verdict=Verdict.NO_GAP, effects=[], where=[], gap=gap))

    assert re.search(r"deviation_arcsec +arcsec +7\.2\n", said)


def test_where_a_surface_lies_is_told_to_a_nanometre() -> None:
    _, diagnosis = of_axes(all_turn=False)
    datum = FittedDatum(coordinate_um={"X": 1.72e-6, "Y": -0.612_34})

    said = as_text(replace(diagnosis, rig=replace(diagnosis.rig, datum=datum)))

    assert re.search(r"X\.coordinate_um +0 +0\n", said)
    assert re.search(r"Y\.coordinate_um +0 +-0\.612\n", said)


@pytest.mark.usefixtures("unrendered")
def test_linear_and_rotary_axes_of_a_campaign_have_pictures_in_their_own_units() -> None:
    campaign, diagnosis = of_axes(all_turn=False)

    text = as_text(diagnosis)
    page = as_html(campaign, diagnosis, name="c", seed=1, jobs=2)

    for said in (text, prose(page)):
        assert "10.0 µm or mdeg" in said
    pictures = re.findall(r'aria-label="([^"]+)"', page)
    for unit, feed in (("arcsec", "deg/min"), ("µm", "mm/min")):
        own = [words for words in pictures if f" in {unit}, " in words]
        assert own
        assert all(feed in words for words in own)


def test_each_path_is_told_in_the_unit_of_its_axes() -> None:
    whole, diagnosis = of_axes(all_turn=False)
    touches = replace(whole.touches, axis=np.where(whole.touches.on_plc, Axis.C, Axis.X))
    diagnosis = replace(
        diagnosis,
        where=[
            Place("position", path, f"deviation_{path}", "everywhere", 10.0, "µm", ("backlash",))
            for path in ("skip", "plc")
        ],
        ways_of_paths=Ways.of_paths(touches),
    )

    said = as_text(diagnosis)

    assert re.search(r"position .* skip .* 10\.0 µm ", said)
    assert re.search(r"position .* plc .* 36\.0 arcsec ", said)


def test_what_is_short_of_an_explanation_is_told_in_degrees() -> None:
    campaign, _ = of_axes(all_turn=True)
    failure = Failure("left", 3.0, "", "it leaves 3 µm of position, much of what was there")

    said = notes(Scene.of(campaign), Verdict.UNKNOWN, [failure], [])

    assert "Not explained: it leaves 3 mdeg of position, much of what was there." in said


def test_a_parameter_without_a_unit_has_none_in_words() -> None:
    _, diagnosis = no_gap()
    warm = effect("thermal_drift", drift_um_k=1.5)
    named = Named(warm, "position", {n: (v, v) for n, v in warm.parameters.items()}, (), 0.9)

    said = as_text(replace(diagnosis, verdict=Verdict.EXPLAINED, effects=[named]))

    assert re.search(r"starts_at_calibration = \S+ \([^)]*\), 0: soaked", said)


def test_missed_and_false_touches_are_said_in_words() -> None:
    campaign, _ = no_gap()
    skip = campaign.touches.on_skip
    status = np.full(len(skip), Status.OK)
    status[np.flatnonzero(skip)[:5]] = [Status.MISSED] * 3 + [Status.FALSE] * 2
    touches = replace(campaign.touches, status=status.astype(np.int8))

    said = notes(Scene.of(replace(campaign, touches=touches)), Verdict.NO_GAP, [], [])

    assert f"Missed on the skip path: 3 of {skip.sum()} touches." in said
    assert "Triggers without a contact on the skip path: 2." in said


@pytest.mark.parametrize(
    ("azimuth_deg", "named", "is_said"),
    [
        (90.0, ["backlash"], True),
        (90.4, ["thermal_drift", "backlash"], True),
        (135.0, ["backlash"], False),
        (90.0, ["thermal_drift"], False),
    ],
)
def test_backlash_along_axes_alone_may_be_a_stylus_off_its_centre(
    azimuth_deg: float, named: list[str], *, is_said: bool
) -> None:
    campaign, _ = no_gap()
    alpha_deg = np.where(campaign.touches.sign > 0.0, azimuth_deg, azimuth_deg + 180.0)
    scene = Scene.of(replace(campaign, touches=replace(campaign.touches, alpha_deg=alpha_deg)))

    said = notes(scene, Verdict.EXPLAINED, [], [], named)

    assert any("a stylus off its centre looks like backlash" in one for one in said) is is_said


def test_touches_to_make_stand_within_a_narrow_page(window: Browser, tmp_path: Path) -> None:
    campaign, diagnosis = explained()
    touches = campaign.touches.select(slice(20))
    odd = {"feed_mm_min": 2999.5, "approach_mm": 12.345, "position_mm": -136.634}
    columns = {**touches.columns(), **{name: np.full(20, value) for name, value in odd.items()}}
    experiment = Experiment("x", None, Touches.from_columns(**columns), 0.1, 0.9, 12, (("a",),))
    path = tmp_path / "page.html"
    path.write_text(as_html(campaign, diagnosis, name="a", seed=1, next_experiment=experiment))

    window.open(path, "light", NARROW_PX)

    assert window.evaluate(ASIDE) == []
