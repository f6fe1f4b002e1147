"""Version 2 of the format: what may be left out, what may stand there beside version 1."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from refusals import refusal
from skiplatch.campaign import (
    KEYS,
    Axis,
    BelievedEffect,
    Campaign,
    Datum,
    DatumFreedom,
    InputPath,
    Kind,
    Nominal,
    Touches,
    format_nominal,
    format_touches,
    read_campaign,
    read_nominal,
    read_touches,
    write_campaign,
)
from skiplatch.errors import CampaignWarning

BARE = 'format = "skiplatch-campaign/2"\n'


def nominal(folder: Path, text: str = "") -> Nominal:
    (folder / "nominal.toml").write_text(BARE + text)
    return read_nominal(folder / "nominal.toml")


def touches(folder: Path, text: str) -> Touches:
    (folder / "touches.csv").write_text(text)
    return read_touches(folder / "touches.csv", ("touch",))


def campaign(folder: Path, toml: str, csv: str) -> Campaign:
    nominal(folder, toml)
    (folder / "touches.csv").write_text(csv)
    return read_campaign(folder)


def test_file_with_a_format_alone_stands_at_its_defaults(tmp_path: Path) -> None:
    read = nominal(tmp_path)

    assert read.kind is Kind.MACHINE
    assert read.unknown == frozenset(KEYS)
    assert {key: read.number(*key) for key in KEYS} == {k: v.default for k, v in KEYS.items()}


def test_only_what_is_left_out_is_unknown(tmp_path: Path) -> None:
    read = nominal(tmp_path, "[plc]\nscan_us = 4000\n[probe]\ndelay_us = 0\n")

    assert read.plc.scan_us == 4000.0
    assert read.unknown == frozenset(KEYS) - {("plc", "scan_us"), ("probe", "delay_us")}


def test_value_with_its_uncertainty_is_read(tmp_path: Path) -> None:
    read = nominal(tmp_path, "[probe]\ndelay_us = {value = 500, u = 50.0}\nlobe_um = {value = 1}\n")

    assert read.probe.delay_us == 500.0
    assert read.probe.lobe_um == 1.0
    assert read.uncertainty == {("probe", "delay_us"): 50.0}


@pytest.mark.parametrize("written", ["{u = 3}", "{value = 1, v = 2}", "{}"])
def test_table_that_is_no_value_is_told(tmp_path: Path, written: str) -> None:
    said = refusal(nominal, tmp_path, f"[probe]\ndelay_us = {written}\n", folder=tmp_path)

    assert said == (
        "nominal.toml:3:12: probe.delay_us: expected a number or {value = …, u = …}, got a table"
    )


def test_negative_uncertainty_is_told(tmp_path: Path) -> None:
    said = refusal(nominal, tmp_path, "plc.scan_us = {value = 9, u = -1}\n", folder=tmp_path)

    assert said == "nominal.toml:2:15: plc.scan_us.u: expected a number >= 0, got -1"


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize(
    ("sample", "free"),
    [("machine_sample", DatumFreedom.AXIS), ("bench_sample", DatumFreedom.NONE)],
)
def test_datum_is_by_the_kind_where_nothing_is_said_of_it(
    sample: str, free: DatumFreedom, version: int, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    read = read_nominal(request.getfixturevalue(sample) / "nominal.toml")
    (tmp_path / "again.toml").write_text(format_nominal(replace(read, version=version)))

    assert read.version == 1
    assert read.datum == read_nominal(tmp_path / "again.toml").datum == Datum(free)


@pytest.mark.parametrize("free", DatumFreedom)
def test_datum_is_read(tmp_path: Path, free: DatumFreedom) -> None:
    assert nominal(tmp_path, f'datum.free = "{free}"').datum == Datum(free, None)
    assert nominal(tmp_path, f'[datum]\nfree = "{free}"\nu_um = 3').datum == Datum(free, 3.0)


def test_wrong_datum_is_told(tmp_path: Path) -> None:
    said = refusal(nominal, tmp_path, 'datum.free = "axes"', folder=tmp_path)

    assert said == (
        'nominal.toml:2:14: datum.free: expected "none", "campaign", "axis", "axis_sense", '
        '"session" or "zero", got "axes"'
    )


def test_notes_may_hold_anything(tmp_path: Path) -> None:
    text = '[notes]\nwho = "A. N."\nsheet = {page = 3, of = [1, 2]}\n[[notes.more]]\nx = 1\n'

    assert nominal(tmp_path, text) == nominal(tmp_path)


def test_believed_effects_are_read(tmp_path: Path) -> None:
    read = nominal(
        tmp_path,
        '[[effect]]\nid = "backlash"\nbacklash_um = {value = 3, u = 0.5}\n'
        '[[effect]]\nid = "isr_latency"\nlatency_us = 4\n',
    )

    assert read.believed_effects == (
        BelievedEffect("backlash", {"backlash_um": 3.0}, {"backlash_um": 0.5}),
        BelievedEffect("isr_latency", {"latency_us": 4.0}),
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("effect = 3", "effect: expected tables written as [[effect]], got 3"),
        ("[effect]\nid = 'x'", "effect: expected tables written as [[effect]], got a table"),
        ("[[effect]]\nx = 3", 'effect: expected a table with id = "…", got a table'),
        ("[[effect]]\nid = 'x'\ny = 'z'", 'effect.y: expected a number, got "z"'),
    ],
)
def test_wrong_believed_effect_is_told(tmp_path: Path, text: str, message: str) -> None:
    assert message in refusal(nominal, tmp_path, text)


def test_each_believed_effect_that_is_wrong_is_told_by_its_own_line(tmp_path: Path) -> None:
    good = "[[effect]]\nid = 'isr_latency'\nlatency_us = 4\n"
    text = good + good.replace("4", "'4'") + "[[effect]]\nx = 1\n" + good.replace("4", "true")

    told = refusal(nominal, tmp_path, text).splitlines()

    start = BARE.count("\n")
    assert [line.split(": ")[0] for line in told] == [
        f"{tmp_path}/nominal.toml:{start + 6}:14",
        f"{tmp_path}/nominal.toml:{start + 7}",
        f"{tmp_path}/nominal.toml:{start + 11}:14",
    ]


def test_nominal_is_written_in_the_oldest_version_that_holds_it(machine_sample: Path) -> None:
    read = read_nominal(machine_sample / "nominal.toml")
    negative = replace(read, probe=replace(read.probe, pretravel_um=-1.0))
    bounded = replace(read, axis=replace(read.axis, min_mm=-100.0))

    assert 'campaign/1"' in format_nominal(read)
    assert 'campaign/2"' in format_nominal(negative)
    assert "min_mm = -100.0\n" in format_nominal(bounded)
    assert 'free = "none"\n' in format_nominal(replace(read, datum=Datum(DatumFreedom.NONE)))


def test_negative_pretravel_in_version_1_is_read_back_as_it_was(
    tmp_path: Path, machine_sample: Path
) -> None:
    text = (machine_sample / "nominal.toml").read_text(encoding="utf-8")
    path = tmp_path / "nominal.toml"
    path.write_text(text.replace("pretravel_um = ", "pretravel_um = -"), encoding="utf-8")
    read = read_nominal(path)

    path.write_text(format_nominal(read), encoding="utf-8")

    assert read.probe.pretravel_um < 0.0
    assert read_nominal(path) == read


def test_bench_without_motion_is_a_campaign(tmp_path: Path) -> None:
    read = campaign(tmp_path, 'kind = "bench"', "touch,edge_us,latch_us\n1,10,15\n2,20,\n")

    assert read.touches.on_skip.all()
    assert read.touches.ok.tolist() == [True, False]
    assert np.isnan([read.touches.time_s, read.touches.feed_mm_min]).all()


def test_version_1_still_wants_its_columns(tmp_path: Path, machine_sample: Path) -> None:
    (tmp_path / "nominal.toml").write_text((machine_sample / "nominal.toml").read_text())
    (tmp_path / "touches.csv").write_text("touch,feed_mm_min,deviation_um\n1,60,3\n")

    assert refusal(read_campaign, tmp_path, folder=tmp_path) == (
        'touches.csv:1: missing column "time_s", "path", "approach_mm"'
    )


def test_cells_of_what_may_be_left_out_may_be_empty(tmp_path: Path) -> None:
    read = touches(tmp_path, "touch,time_s,path\n1,,\n2,3,plc\n")

    assert read.path.tolist() == [InputPath.SKIP, InputPath.PLC]
    assert np.isnan(read.time_s[0])
    assert read.in_order_of_time().touch.tolist() == [1, 2]


def test_sessions_are_numbered_as_they_come(tmp_path: Path) -> None:
    read = touches(tmp_path, "touch,session\n1,late\n2,early\n3,\n4,late\n")

    assert read.session.tolist() == [0, 1, 2, 0]
    assert read.session_names == ("late", "early", "")
    assert read.select(slice(1, 3)).session_names == read.session_names


def test_one_session_where_none_is_recorded(tmp_path: Path) -> None:
    read = touches(tmp_path, "touch\n1\n2\n")

    assert read.session.tolist() == [0, 0]
    assert read.session_names == ("",)


def test_thermometers_are_read_by_their_names(tmp_path: Path) -> None:
    read = touches(tmp_path, "touch,temp_spindle_c,Temp_Nut-X_C,temp_c\n1,20.5,,21\n2,22,nan,20\n")

    assert list(read.thermometers) == ["spindle", "nut-x"]
    assert read.thermometers["spindle"].tolist() == [20.5, 22.0]
    assert np.isnan(read.thermometers["nut-x"]).all()
    assert read.select(np.array([1])).thermometers["spindle"].tolist() == [22.0]


def test_rotary_axes_are_read(tmp_path: Path) -> None:
    read = touches(
        tmp_path, "touch,axis,position_deg,deviation_arcsec\n1,A,45,1.5\n2,c,-90.000001,-2\n"
    )

    assert read.axis.tolist() == [Axis.A, Axis.C]
    assert read.position_deg.tolist() == [45.0, -90.000001]
    assert read.deviation_arcsec.tolist() == [1.5, -2.0]
    assert read.ok.all()


@pytest.mark.parametrize(
    ("stamps", "seconds"),
    [
        (("2026-03-01T14:00:10", "2026-03-01 14:00:00.25"), (9.75, 0.0)),
        (("2026-03-01T14:00:00Z", "2026-03-01T15:30:00+01:00"), (0.0, 1800.0)),
        (("", "20260301T140000"), (np.nan, 0.0)),
    ],
)
def test_time_stamps_count_from_the_first(
    tmp_path: Path, stamps: tuple[str, str], seconds: tuple[float, float]
) -> None:
    read = touches(tmp_path, f"touch,time\n1,{stamps[0]}\n2,{stamps[1]}\n")

    np.testing.assert_array_equal(read.time_s, seconds)


@pytest.mark.parametrize(
    ("stamps", "message"),
    [
        (("now", ""), 'touches.csv:2: time: expected a date and time such as "2026-'),
        (("2026-03-01", ""), "touches.csv:2: time: expected a date and time"),
        (
            ("2026-03-01T14:00", "2026-03-01T14:00Z"),
            "touches.csv:3: time: expected a zone in every",
        ),
        (("0001-01-01T00:00+01:00", ""), "touches.csv:2: time: expected a date and time"),
        (("0001-01-01T00:00", "2026-01-01T00:00"), "touches.csv: time: runs from 0001"),
    ],
)
def test_wrong_time_stamps_are_told(tmp_path: Path, stamps: tuple[str, str], message: str) -> None:
    said = refusal(touches, tmp_path, f"touch,time\n1,{stamps[0]}\n2,{stamps[1]}\n")

    assert message in said


@pytest.mark.parametrize(
    ("cell", "ending"),
    [("2026-03-01T14:00:10", '"; dates and times go in a column "time"'), ("soon", '"soon"')],
)
def test_where_dates_go_is_told_in_the_column_of_seconds(
    tmp_path: Path, cell: str, ending: str
) -> None:
    assert refusal(touches, tmp_path, f"touch,time_s\n1,{cell}\n").endswith(ending)


NEAT = "touch,path,axis,deviation_um,session\n1,plc,X,12.5,a b\n2,skip,Y,,c\n"


@pytest.mark.parametrize(
    "text",
    [
        NEAT.replace(",", ";").replace("12.5", "12,5"),
        NEAT.replace(",", "\t"),
        "sep=;\n" + NEAT.replace(",", ";"),
        "# a list, with commas; and semicolons\n\n" + NEAT.replace("\n2", "\n# break\n2"),
        NEAT.replace("plc,X", "PLC,x").replace("touch,path", "Touch, PATH "),
        NEAT.replace(",,c", ",NaN,c").replace(",X,", ", X ,"),
        NEAT.replace("12.5", "1.25e1"),
    ],
    ids=["semicolons", "tabs", "sep", "comments", "case", "nan", "exponent"],
)
def test_the_same_written_otherwise_is_the_same(tmp_path: Path, text: str) -> None:
    assert format_touches(touches(tmp_path, text)) == format_touches(touches(tmp_path, NEAT))


def test_rows_with_another_delimiter_than_the_header_are_told(tmp_path: Path) -> None:
    said = refusal(touches, tmp_path, "touch,path\n1;skip\n", folder=tmp_path)

    assert said == ("touches.csv:2: expected 2 cells, got 1; this file uses ; between columns")


def test_one_row_is_a_campaign(tmp_path: Path) -> None:
    assert len(campaign(tmp_path, "", "touch,deviation_um\n1,-3\n").touches) == 1


def test_campaign_of_version_2_is_written_and_read_back(tmp_path: Path) -> None:
    written = Touches.from_columns(
        touch=np.array([1, 2]),
        axis=np.array([Axis.X, Axis.B]),
        deviation_um=np.array([-3.0, np.nan]),
        deviation_arcsec=np.array([np.nan, 2.0]),
        session=["first, cold", "#2"],
        thermometers={"bed": np.array([20.0, np.nan])},
    )
    believed = replace(nominal(tmp_path), kind=Kind.BENCH)

    write_campaign(tmp_path / "new", believed, written)

    read = read_campaign(tmp_path / "new")
    assert format_touches(read.touches) == format_touches(written)
    assert read.nominal == believed


def test_touches_that_version_1_cannot_hold_make_it_version_2(
    tmp_path: Path, machine_sample: Path
) -> None:
    sample = read_campaign(machine_sample)
    untimed = replace(sample.touches, time_s=np.full(len(sample.touches), np.nan))

    write_campaign(tmp_path / "new", sample.nominal, untimed)

    assert read_campaign(tmp_path / "new").nominal == replace(
        sample.nominal, version=2, unknown=frozenset(k for k, v in KEYS.items() if v.since > 1)
    )


def test_sessions_without_a_name_are_refused() -> None:
    with pytest.raises(ValueError, match="sessions beyond"):
        Touches.from_columns(touch=np.arange(2), session=np.array([0, 1]), session_names=("only",))


def test_an_axis_that_can_reach_nothing_is_refused_by_its_key(tmp_path: Path) -> None:
    said = refusal(nominal, tmp_path, "[axis]\nmin_mm = 500\nmax_mm = 300\n", folder=tmp_path)

    expected = "axis.max_mm: expected at least axis.min_mm = 500 in mm, got 300.0"
    assert said == f"nominal.toml:4:10: {expected}"


def test_an_axis_may_have_one_end_or_none(tmp_path: Path) -> None:
    for ends in ("min_mm = 500", "max_mm = -500", "min_mm = 3\nmax_mm = 3", ""):
        nominal(tmp_path, f"[axis]\n{ends}\n")


def test_an_axis_that_can_reach_nothing_is_not_written(tmp_path: Path) -> None:
    read = nominal(tmp_path)

    with pytest.raises(ValueError, match=r"axis\.max_mm: expected at least axis\.min_mm"):
        format_nominal(replace(read, axis=replace(read.axis, min_mm=500.0, max_mm=300.0)))


@pytest.mark.parametrize(
    ("rows", "line"),
    [("0;100;1.200\n1;100;2,5\n", 2), ("0;100;2,5\n1;100;1.200\n", 3), ("0;0,5;1.200\n", 2)],
)
def test_number_that_may_be_in_thousands_is_refused(tmp_path: Path, rows: str, line: int) -> None:
    said = refusal(touches, tmp_path, f"touch;feed_mm_min;deviation_um\n{rows}", folder=tmp_path)

    assert said.startswith(f'touches.csv:{line}: column 3: "1.200" may be 1200 or 1,200')


def test_decimal_points_alone_tell_no_thousands(tmp_path: Path) -> None:
    read = touches(tmp_path, "touch;deviation_um\n0;1.200\n1;2.5\n")

    assert read.deviation_um.tolist() == [1.2, 2.5]


NO_PATH = "touch,time_s,feed_mm_min,approach_mm,latch_us\n"
SCAN, INTERRUPT = "[plc]\nscan_us = 4000\n", "[skip]\nlatency_us = 5\njitter_us = 1\n"


def without_path(folder: Path, toml: str, stamps_us: Sequence[float], **columns: str) -> Campaign:
    head = NO_PATH.strip() + "".join(f",{name}" for name in columns) + "\n"
    rest = "".join(f",{value}" for value in columns.values()) + "\n"
    rows = [f"{i},{us / 1e6 - 0.6:.6f},300,3,{us:.3f}" for i, us in enumerate(stamps_us)]
    return campaign(folder, toml, head + "".join(row + rest for row in rows))


SCANS_US = [1_000_000.0 + 4_000.0 * k**2 for k in range(24)]
ANYTIME_US = [us + 1_234.5 * k**2 % 4_000.0 for k, us in enumerate(SCANS_US)]


@pytest.mark.parametrize(
    ("toml", "stamps_us", "why"),
    [
        (SCAN, ANYTIME_US, "nominal.toml has a scan and no interrupt"),
        (SCAN + INTERRUPT, SCANS_US, "stamps lie on the grid of the scans"),
    ],
)
def test_touches_without_a_path_are_those_of_a_plc_where_something_tells(
    tmp_path: Path, toml: str, stamps_us: list[float], why: str
) -> None:
    with pytest.warns(CampaignWarning) as told:
        read = without_path(tmp_path, toml, stamps_us)

    assert read.touches.on_plc.all()
    assert [str(one.message) for one in told] == [
        f"{tmp_path / 'touches.csv'}: path: not recorded; taken as plc, for {why}"
    ]


@pytest.mark.parametrize("toml", ["", INTERRUPT, SCAN + INTERRUPT])
def test_touches_without_a_path_are_those_of_a_skip_input_where_nothing_tells(
    tmp_path: Path, toml: str
) -> None:
    assert without_path(tmp_path, toml, ANYTIME_US).touches.on_skip.all()


def test_a_path_that_is_said_stays(tmp_path: Path) -> None:
    assert without_path(tmp_path, SCAN, SCANS_US, path="skip").touches.on_skip.all()
