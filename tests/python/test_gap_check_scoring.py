"""The scorer of the withheld check, on made-up labels, diagnoses and plays."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from one_thread import one_thread
from skiplatch.campaign import InputPath, Nominal, Touches, read_nominal
from skiplatch.workers import Workers
from tests.withheld import baselines, confusion, goals, reliability, runs, verdicts
from tests.withheld.heldout import read_predictions, shrink_to_oracle
from tests.withheld.nats import nats
from tests.withheld.scoring import FAILED, Found, Scored, calibration_error
from tests.withheld.sealed import HeldBack, Label
from tests.withheld.simulated import play_once
from tests.withheld.streams import Expected, Played, cells, residuals

NAN = float("nan")
RIG = Path(__file__).parents[2] / "scripts" / "samples" / "machine_no_gap" / "nominal.toml"
Names = Sequence[tuple[str, Sequence[str], float]]


def label(case: str, *effects: str, recording: str = "bench", visible: float = 5.0) -> Label:
    return Label(
        case=case,
        recording=recording,
        effects=effects,
        visible=dict.fromkeys(effects, visible),
        not_recorded=frozenset(),
        touches=300,
        scan_phase_us=0.0,
    )


def found(*names: tuple[str, Sequence[str], float], verdict: str = "explained") -> Found:
    """Make a diagnosis from ids, their alternatives and confidences."""
    stages = {"isr_latency": "latch", "isr_blocking": "latch", "backlash": "position"}
    return Found.of(
        {
            "verdict": verdict,
            "effects": [
                {"id": i, "alternatives": others, "stage": stages[i], "confidence": sure}
                for i, others, sure in names
            ],
            "where": [],
        }
    )


def scored(sealed: Label, said: Found, nats: float = 500.0, shrink: float = NAN) -> Scored:
    return Scored(sealed, said, seconds=2.0, nats=nats, shrink=shrink, guesses={})


NOTHING = found(verdict="no_gap")
SURE = ("isr_latency", (), 0.99)
GROUP = ("isr_blocking", ("isr_latency",), 0.99)
WRONG = ("backlash", (), 0.99)
SINGLE = label("single", "isr_latency")
PAIR = label("two", "isr_latency", "backlash")


@pytest.mark.parametrize(
    ("sealed", "names", "exactly", "in_group", "right"),
    [
        (SINGLE, [SURE], True, True, True),
        (SINGLE, [GROUP], False, True, True),
        (SINGLE, [WRONG], False, False, False),
        (SINGLE, [], False, False, False),
        (SINGLE, [SURE, WRONG], False, False, False),
        (PAIR, [SURE, WRONG], True, True, True),
        (PAIR, [SURE], False, False, False),
        (label("none"), [], True, False, True),
        (label("none"), [SURE], False, False, False),
        (label("stranger"), [SURE], False, False, False),
    ],
)
def test_a_name_is_right_by_itself_by_its_group_or_not(
    sealed: Label, names: Names, exactly: bool, in_group: bool, right: bool
) -> None:
    one = scored(sealed, found(*names))

    assert (one.names_exactly, one.names_in_group, one.is_right) == (exactly, in_group, right)


def test_stage_is_that_of_the_names_or_else_of_the_first_place() -> None:
    unknown = Found("unknown", (), ("latch", "position"))

    assert scored(SINGLE, found(GROUP)).has_right_stage
    assert not scored(SINGLE, found(WRONG)).has_right_stage
    assert not scored(SINGLE, found(SURE, WRONG)).has_right_stage
    assert scored(SINGLE, unknown).has_right_stage
    assert not scored(SINGLE, NOTHING).has_right_stage


def row(results: Sequence[Scored], title: str) -> goals.Row:
    return next(r for r in goals.rows(results) if r.title.strip() == title)


def test_table_counts_plain_effects_by_recording() -> None:
    stamped = label("single", "isr_latency", recording="stamped")
    results = [
        scored(SINGLE, found(SURE)),
        scored(SINGLE, found(GROUP)),
        scored(SINGLE, NOTHING),
        scored(SINGLE, found(WRONG), nats=20.0),
        scored(stamped, found(GROUP)),
    ]

    assert row(results, "one effect that shows: name or group").value == 0.75
    assert row(results, "the very name, bench").value == pytest.approx(1 / 3)
    assert row(results, "bench").value == pytest.approx(2 / 3)
    assert row(results, "machine with stamps").value == 1.0
    assert row(results, "position only").count == 0
    assert row(results, "faint (10–30 nats)").value == 0.0
    assert row(results, "truth in the reported group").count == 4
    assert row(results, "nothing named of one effect").value == 0.25
    assert row(results, "median size of the group").value == 2.0
    assert row(results, "the same with edges").value == 1.5


def test_pairs_count_if_both_effects_show() -> None:
    faint = label("two", "isr_latency", "backlash", visible=0.5)
    other = ("isr_blocking", (), 0.5)
    results = [
        scored(PAIR, found(SURE, WRONG)),
        scored(PAIR, found(SURE, other)),
        scored(faint, NOTHING),
    ]

    assert row(results, "both of two effects").value == 0.5
    assert row(results, "both of two effects").count == 2
    assert row(results, "a wrong name beside them").value == 0.5


def test_abstention_is_counted_by_case() -> None:
    unsure = ("backlash", (), 0.6)
    unknown = found(verdict="unknown")
    results = [
        *[scored(label("none"), NOTHING)] * 3,
        scored(label("none"), unknown),
        scored(label("dull"), NOTHING),
        scored(label("stranger"), unknown),
        scored(label("stranger"), found(unsure)),
        scored(label("stranger"), found(WRONG)),
        scored(label("stranger"), NOTHING),
    ]

    assert row(results, "no gap: said so").value == 0.75
    assert row(results, "dull base: no gap").met is True
    assert row(results, "strangers by hand named").value == 0.5
    assert row(results, "strangers of the grammar named").count == 0
    assert row(results, "campaigns with such a name").value == pytest.approx(1 / 9)
    assert row(results, "wrong of the names with confidence ≥ 0.9").value == 1.0


def case(name: str, *said: Found) -> list[Scored]:
    return [scored(label(name), one) for one in said]


UNSURE = ("backlash", (), 0.6)


@pytest.mark.parametrize(
    ("results", "title", "value"),
    [
        (case("strangers", found(UNSURE), NOTHING), "strangers of the grammar named", 0.5),
        (case("strangers", found(UNSURE), found(verdict="unknown")), "told as unknown", 0.5),
        (case("datum", found(SURE), NOTHING, NOTHING, NOTHING), "datum off: no gap", 0.75),
        (
            case("wrong_noise", NOTHING, found(verdict="undecided")),
            "wrong noise believed: no gap",
            0.5,
        ),
        (case("outliers", NOTHING, found(SURE)), "outliers: right all the same", 0.5),
        (case("none", NOTHING, found(verdict="undecided")), "undecided", 0.5),
    ],
)
def test_cases_without_an_effect_have_rows(results: list[Scored], title: str, value: float) -> None:
    assert row(results, title).value == value
    assert row(results, title).interval is not None


@pytest.mark.parametrize(
    ("kind", "title"),
    [
        ("uncertain", "name or group, beliefs uncertain"),
        ("onset", "name or group, begins or ends"),
        ("small", "name or group, few touches"),
    ],
)
def test_variants_of_one_effect_have_rows_of_what_shows(kind: str, title: str) -> None:
    one = label(kind, "isr_latency")
    results = [
        scored(one, found(GROUP)),
        scored(one, found(WRONG)),
        scored(one, NOTHING, nats=20.0),
    ]

    assert row(results, title).value == 0.5
    assert row(results, title).count == 2


def test_three_effects_count_if_all_are_named_and_no_other() -> None:
    three = label("three", "isr_latency", "backlash", "report_delay")
    late = ("isr_blocking", ("report_delay",), 0.9)
    results = [scored(three, found(SURE, WRONG, late)), scored(three, found(SURE, WRONG))]

    assert row(results, "all of three effects").value == 0.5


def shrinking(verdict: str, *shrinks: tuple[float, bool]) -> Found:
    gap = {
        str(i): {"shrink": value, "shrink_interval": [value, value], "beyond_noise": has_gap}
        for i, (value, has_gap) in enumerate(shrinks)
    }
    return Found.of({"verdict": verdict, "effects": [], "where": [], "gap": gap})


def test_explained_without_a_gap_that_shrinks_by_half_is_counted() -> None:
    results = [
        scored(SINGLE, shrinking("explained", (0.9, True), (0.0, False))),
        scored(SINGLE, shrinking("explained", (0.4, True), (0.9, False))),
        scored(SINGLE, shrinking("unknown", (0.0, True))),
        scored(SINGLE, shrinking("explained")),
    ]

    assert row(results, "explained, and nothing shrinks by half").value == 0.5
    assert row(results, "explained, and nothing shrinks by half").met is False


def test_outliers_are_counted_by_touch() -> None:
    spoilt = replace(
        label("outliers"), outliers=frozenset({3, 5, 8}), plain_outliers=frozenset({3, 5})
    )
    said = replace(NOTHING, outliers=frozenset({3, 8, 9}))
    results = [scored(spoilt, said)]

    assert row(results, "those of ten spreads that are listed").value == 0.5
    assert row(results, "listed ones that are some").value == pytest.approx(2 / 3)


def test_a_name_is_wrong_beside_the_right_one_too() -> None:
    results = [scored(SINGLE, found(SURE, WRONG)), scored(SINGLE, found(GROUP))]

    assert row(results, "wrong of the names with confidence ≥ 0.9").value == pytest.approx(1 / 3)
    assert row(results, "campaigns with such a name").value == 0.5


def test_a_line_of_verdicts_is_whole_json_of_a_campaign() -> None:
    said = replace(found(SURE, WRONG), shrinks=shrinking("", (0.9, True), (NAN, False)).shrinks)
    results = [
        replace(scored(SINGLE, said), name="7/g0001"),
        replace(scored(label("none"), NOTHING), name="7/g0000"),
    ]

    first, second = map(json.loads, verdicts.as_lines(results).splitlines())

    assert (first["campaign"], first["confidence"], first["names"]) == ("g0000", None, {})
    assert (second["seed"], second["campaign"], second["case"]) == (7, "g0001", "single")
    assert second["names"] == {"isr_latency": [], "backlash": []}
    assert second["wrong_names"] == ["backlash"]
    assert second["shrink"]["0"] == {"of": 0.9, "interval": [0.9, 0.9], "gap": True}
    assert second["shrink"]["1"]["of"] is None


def test_goals_are_met_at_their_very_value() -> None:
    shrinks = [scored(SINGLE, found(SURE), shrink=s) for s in (0.99, 0.99, 0.99)]

    assert row(shrinks, "held-out shrink ÷ the oracle's, median").met is True
    assert row(shrinks, "tenth percentile").met is True
    worse = [replace(one, shrink=0.98) for one in shrinks]
    assert row(worse, "held-out shrink ÷ the oracle's, median").met is False


def test_what_cannot_shrink_is_left_out() -> None:
    results = [scored(SINGLE, found(SURE), shrink=s) for s in (NAN, 0.9, NAN)]

    assert row(results, "held-out shrink ÷ the oracle's, median").value == 0.9
    assert row(results, "held-out shrink ÷ the oracle's, median").count == 1


def test_calibration_error_of_names_that_are_right_as_often_as_said() -> None:
    half = ("isr_latency", (), 0.5)
    results = [scored(SINGLE, found(half)), scored(label("single", "backlash"), found(half))]

    assert calibration_error(results) == (0.0, 2)


def test_calibration_error_of_sure_names_that_are_wrong() -> None:
    sure, other = ("isr_latency", (), 1.0), ("isr_latency", (), 0.6)
    wrong = label("single", "backlash")
    results = [
        *[scored(SINGLE, found(sure))] * 3,
        scored(wrong, found(sure)),
        *[scored(SINGLE, found(other))] * 2,
    ]

    error, names = calibration_error(results)

    assert names == 6
    assert error == pytest.approx((4 * 0.25 + 2 * 0.4) / 6)


def test_calibration_error_without_names_is_unknown() -> None:
    error, names = calibration_error([scored(SINGLE, NOTHING)])

    assert np.isnan(error)
    assert names == 0


def test_confusion_has_the_name_that_was_taken() -> None:
    results = [
        scored(SINGLE, found(SURE)),
        scored(SINGLE, found(WRONG, SURE)),
        scored(SINGLE, found(WRONG)),
        scored(label("none"), NOTHING),
        scored(label("stranger"), found(verdict="unknown")),
        scored(PAIR, found(SURE)),
    ]

    counts = confusion.matrix(results)

    assert counts == {
        ("isr_latency", "isr_latency"): 2,
        ("isr_latency", "backlash"): 1,
        ("(none)", "(none)"): 1,
        ("(stranger)", "(unknown)"): 1,
    }
    assert "2/3  backlash 1" in confusion.matrix_text(results)


def test_baselines_are_counted_beside_the_diagnosis() -> None:
    guesses = {"guess": "isr_latency"}
    results = [
        replace(scored(SINGLE, NOTHING), guesses=guesses),
        replace(scored(PAIR, found(SURE)), guesses=guesses),
        replace(scored(label("none"), NOTHING), guesses=guesses),
        replace(scored(label("stranger"), found(WRONG)), guesses={"guess": None}),
    ]

    ours, theirs = (line.split() for line in baselines.as_text(results).splitlines()[1:])

    # Right of plain ones and of all, one of two, named on none and on strangers; no others.
    assert ours[2:] == ["0/1", "0/1", "1/1", "0/1", "1/1"]
    assert theirs[1:] == ["1/1", "1/1", "1/1", "1/1", "0/1"]


# ---- plays ---------------------------------------------------------------------------------------

N, PLAYS = 400, 50


@pytest.fixture
def nominal() -> Nominal:
    return read_nominal(RIG)


def touches_at(feeds: Sequence[float], n: int = N) -> Touches:
    rng = np.random.default_rng(1)
    return Touches.from_columns(
        touch=np.arange(n),
        time_s=20.0 * np.arange(n) + rng.random(n),
        path=np.full(n, InputPath.SKIP),
        feed_mm_min=rng.choice(feeds, n),
        approach_mm=np.full(n, 3.0),
        alpha_deg=rng.uniform(0.0, 360.0, n),
        beta_deg=np.zeros(n),
    )


def plays(nominal: Nominal, touches: Touches, shift_um: float, count: int, seed: int) -> Played:
    """Deviations as expected, with Gaussian scatter of 0.2 µm, and shifted."""
    expected = Expected.of(nominal, touches)
    scatter = np.random.default_rng(seed).normal(0.0, 0.2, (count, len(touches)))
    deviation = expected.speed_um_us * expected.wait_us + shift_um + scatter
    empty = np.full_like(deviation, NAN)
    return Played(empty, empty, deviation)


def held_back(nominal: Nominal, shift_um: float, feeds: Sequence[float] = (300, 3000)) -> HeldBack:
    """Touches of a truth that is shifted, with positions alone."""
    touches = touches_at(feeds)
    deviation = plays(nominal, touches, shift_um, 1, seed=2).deviation_um[0]
    oracle = plays(nominal, touches, shift_um, PLAYS, seed=3)
    unchanged = plays(nominal, touches, 0.0, PLAYS, seed=4)
    return HeldBack(
        nominal=nominal,
        touches=replace(touches, deviation_um=deviation),
        oracle=oracle,
        unchanged=unchanged,
        oracle_any_phase=oracle,
        unchanged_any_phase=unchanged,
        recorded=("deviation",),
        scan_phase_us=0.0,
    )


def shrink_at(nominal: Nominal, diagnosed_um: float) -> float:
    """Shrink of a diagnosis that shifts by so much, where 2 µm is the truth."""
    known = held_back(nominal, 2.0)
    diagnosed = plays(nominal, known.touches, diagnosed_um, PLAYS, seed=5)
    rng = np.random.default_rng(0)
    return shrink_to_oracle(known, known.of(diagnosed, rng), rng)


def test_shrink_is_one_for_the_truth_and_zero_for_no_change(nominal: Nominal) -> None:
    assert shrink_at(nominal, 2.0) == pytest.approx(1.0, abs=0.01)
    assert shrink_at(nominal, 0.0) == pytest.approx(0.0, abs=0.01)


def test_shrink_of_half_the_way_is_about_half(nominal: Nominal) -> None:
    # Far off, the score of Gaussian plays is the distance less σ/√π, and right on it σ/√π.
    wanted = 1.0 / (2.0 - 2.0 * 0.2 / np.sqrt(np.pi))
    assert shrink_at(nominal, 1.0) == pytest.approx(wanted, abs=0.01)


def test_shrink_of_the_wrong_sense_is_negative(nominal: Nominal) -> None:
    assert shrink_at(nominal, -1.0) < -0.4


def test_shrink_without_a_gap_is_unknown(nominal: Nominal) -> None:
    known = held_back(nominal, 0.0)
    rng = np.random.default_rng(0)

    assert np.isnan(shrink_to_oracle(known, known.of(known.oracle, rng), rng))


@pytest.mark.parametrize("shift_um", [0.1, 0.2, 0.4])
def test_nats_of_a_shift_are_half_its_square_in_spreads(nominal: Nominal, shift_um: float) -> None:
    known = held_back(nominal, shift_um)

    gained = nats(known, N, np.random.default_rng(0))

    wanted = N * 0.5 * (shift_um / 0.2) ** 2
    assert gained == pytest.approx(wanted, rel=0.2, abs=20.0)


def test_nats_of_nothing_are_few(nominal: Nominal) -> None:
    known = held_back(nominal, 0.0)

    assert abs(nats(known, N, np.random.default_rng(0))) < 15.0


def test_nats_of_lost_touches_count_the_lost(nominal: Nominal) -> None:
    known = held_back(nominal, 0.0)
    lost = np.random.default_rng(6).random((PLAYS + 1, N)) < 0.05
    truth = np.where(lost[0], NAN, known.touches.deviation_um)
    oracle = np.where(lost[1:], NAN, known.oracle.deviation_um)
    known = replace(
        known,
        touches=replace(known.touches, deviation_um=truth),
        oracle=replace(known.oracle, deviation_um=oracle),
    )

    assert nats(known, N, np.random.default_rng(0)) > 3.0 * np.count_nonzero(lost[0])


def test_cells_part_by_path_and_feed_and_bin_many_feeds() -> None:
    few = touches_at([300, 3000])
    many = replace(few, feed_mm_min=np.linspace(100.0, 3000.0, N))
    mixed = replace(few, path=np.where(np.arange(N) % 2, InputPath.PLC, InputPath.SKIP))

    assert [len(cells(one)) for one in (few, many, mixed)] == [2, 5, 4]
    assert np.array_equal(np.sum(cells(mixed), axis=0), np.ones(N))


def test_predictions_are_read_as_residuals(nominal: Nominal, tmp_path: Path) -> None:
    touches = touches_at([300], n=2)
    expected = Expected.of(nominal, touches)
    latch = expected.contact_us + expected.wait_us + 7.0
    header = "touch,replicate,edge_us,latch_us,report_us,deviation_um,status"
    rows = [f"{i},{r},,{latch[i]:.3f},,1.5,ok" for r in (0, 1) for i in (0, 1)]
    rows[1] = "1,0,,,,,missed"
    path = tmp_path / "predicted.csv"
    path.write_text("\n".join([header, *rows]))

    predicted = read_predictions(path, expected)

    stamp = 7.0 + nominal.skip.tick_us / 2
    assert predicted["latch"].ravel() == pytest.approx(
        [stamp, NAN, stamp, stamp], abs=2e-3, nan_ok=True
    )


def test_residuals_of_the_simulator_are_centred(nominal: Nominal) -> None:
    touches = touches_at([100, 1000])
    expected = Expected.of(nominal, touches)

    played = play_once(nominal, touches, [], seed=1, replicates=20)

    off = residuals(expected, played, expected.contact_us)
    for stream in ("latch", "position", "deviation", "report"):
        means = off[stream].mean(axis=0) / expected.spreads[stream]
        assert abs(means.mean()) < 0.05, stream  # 8,000 touches: five standard errors


# ---- the driver ----------------------------------------------------------------------------------


def test_diagnosis_sees_nothing_but_its_campaign(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    campaign = tmp_path / "out" / "campaigns" / "g0000"
    campaign.mkdir(parents=True)
    (campaign / "touches.csv").write_text("")
    spy = tmp_path / "spy"
    spy.write_text(
        f"#!{sys.executable}\nimport os, sys\n"
        "print(sorted(os.listdir('.')), sorted(os.environ), file=open('diagnosis.json', 'w'))\n"
        "open('predicted.csv', 'w')\n"
        "sys.exit(open('diagnosis.json').read())\n"
    )
    spy.chmod(0o755)
    monkeypatch.setattr(runs, "SKIPLATCH", spy)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))

    answer = runs.diagnose(campaign, 1, tmp_path / "found")

    said = (tmp_path / "found" / "failure.txt").read_text()
    assert "['campaign']" in said
    assert "PYTHONPATH" not in said
    assert answer.diagnosis["verdict"] == FAILED
    assert answer.predicted is None


def counting(counted: Path) -> Callable[..., str]:
    """Stand in for skiplatch: write what it would, and a line for each command."""

    def run(folder: Path, *arguments: str) -> str:
        with counted.open("a") as file:
            file.write(arguments[0] + "\n")
        written = arguments[
            arguments.index("--json" if arguments[0] == "diagnose" else "--out") + 1
        ]
        (folder / written).write_text('{"verdict": "no_gap", "effects": [], "where": []}')
        return ""

    return run


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("g0000", "g0001"):
        campaign = tmp_path / "set" / "campaigns" / name
        campaign.mkdir(parents=True)
        (campaign / "touches.csv").write_text("")
    monkeypatch.setattr(runs, "run_skiplatch", counting(tmp_path / "counted"))
    monkeypatch.setattr(runs, "opened", one_thread)
    return tmp_path / "set"


def test_diagnoses_go_on_where_they_were_broken_off(kept: Path) -> None:
    runs.diagnose(kept / "campaigns" / "g0000", 1, kept / "found" / "g0000")
    half = kept / "found" / "g0001"
    half.mkdir()
    (half / "diagnosis.json").write_text("half a")

    first = runs.diagnose_all(kept, 1, Workers(), title="")
    again = runs.diagnose_all(kept, 1, Workers(), title="")

    assert [answer.diagnosis["verdict"] for answer in first] == ["no_gap", "no_gap"]
    assert first == again
    assert (kept.parent / "counted").read_text().split() == ["diagnose", "predict"] * 2


def test_answers_of_another_name_are_made_anew(kept: Path) -> None:
    runs.diagnose_all(kept, 1, Workers(), title="")
    runs.diagnose_all(kept, 1, Workers(), title="", answers="after")

    assert (kept.parent / "counted").read_text().split() == ["diagnose", "predict"] * 4
    assert (kept / "found" / "g0000" / "answered.json").exists()


def test_workers_go_on_where_threads_were_broken_off(
    kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = runs.diagnose_all(kept, 1, Workers(), title="")

    monkeypatch.undo()
    monkeypatch.chdir(kept.parent)
    there = runs.diagnose_all(Path(kept.name), 1, Workers(jobs=2), title="")

    assert there == here


def test_a_generator_that_fails_ends_the_check(tmp_path: Path) -> None:
    order = runs.Order(seed=1, count=1, cases="nonsense")

    with pytest.raises(SystemExit, match="the generator failed"):
        runs.generate(tmp_path / "out", order)


def test_a_set_is_gone_on_with_only_by_its_own_order(tmp_path: Path) -> None:
    (tmp_path / "set.json").write_text('{"seed": 1, "count": 2, "touches": [60, 90]}\n')

    with pytest.raises(SystemExit, match="holds another set"):
        runs.generate(tmp_path, runs.Order(seed=2, count=2))
    assert runs.kept_order(tmp_path) == runs.Order(1, 2, touches=(60, 90))
    with pytest.raises(SystemExit, match="no set was drawn"):
        runs.kept_order(tmp_path / "nowhere")


def test_names_are_counted_by_set_and_a_set_measured_again_counts_once(tmp_path: Path) -> None:
    file = tmp_path / "reliability.json"
    results = [
        scored(SINGLE, found(SURE)),
        scored(SINGLE, found(WRONG, verdict="partly_explained")),
    ]

    for seed, part in ((1, results), (2, results[:1]), (1, results[1:])):
        file.write_text(reliability.with_set(file, part, seed), encoding="utf-8")

    sets = json.loads(file.read_text(encoding="utf-8"))["sets"]
    assert [(one["seed"], one["campaigns"]) for one in sets] == [(2, 1), (1, 1)]
    assert sets[0]["names"]["explained"] == {"right": 1, "wrong": 0}
    assert sets[1]["names"]["partly_explained"] == {"right": 0, "wrong": 1}


def test_names_of_a_form_that_is_far_off_are_counted_by_themselves(tmp_path: Path) -> None:
    far_off = replace(found(SURE, verdict="partly_explained"), failed=frozenset({"has_form"}))

    text = reliability.with_set(tmp_path / "none.json", [scored(SINGLE, far_off)], 1)

    (measured,) = json.loads(text)["sets"]
    assert measured["names"]["form_far_off"] == {"right": 1, "wrong": 0}
    assert measured["names"]["partly_explained"] == {"right": 0, "wrong": 0}
