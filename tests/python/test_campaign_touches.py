"""touches.csv and conditions.csv: what is read, and what is said of what cannot be."""

from pathlib import Path

import numpy as np
import pytest

from refusals import refusal
from skiplatch.campaign import (
    NOT_RECORDED,
    Axis,
    InputPath,
    Status,
    Touches,
    csv_text,
    read_conditions,
    read_touches,
    reading,
)
from skiplatch.errors import CampaignWarning

HEADER = (
    "touch,time_s,path,axis,sign,alpha_deg,beta_deg,feed_mm_min,approach_mm,position_mm,"
    "rotary_deg,temp_c,edge_us,latch_us,report_us,deviation_um,status"
)
OK = "7,14.25,skip,X,-1,180,30,60,2.5,-171.75,90,20.5,16563155.06,16563204,16563751.774,0.05,ok"
MISSED = "3,42,plc,Y,1,90,0,1000,4.5,-41.605,0,20,42303246.589,,,,missed"
FALSE = "5,51.5,plc,Z,-1,0,-90,1000,5.5,,,,,52172661,,-31.1,false"
SHORT = "touch,time_s,path,feed_mm_min,approach_mm"


def table(*rows: str) -> str:
    return "".join(row + "\n" for row in (HEADER, *rows))


def read(folder: Path, text: str | bytes) -> Touches:
    data = text if isinstance(text, bytes) else text.encode()
    (folder / "touches.csv").write_bytes(data)
    return read_touches(folder / "touches.csv")


def complaint(folder: Path, text: str | bytes) -> str:
    return refusal(read, folder, text, folder=folder)


def ok_with(column: str, cell: str) -> str:
    cells = OK.split(",")
    cells[HEADER.split(",").index(column)] = cell
    return ",".join(cells)


def assert_same(left: Touches, right: Touches) -> None:
    for (name, a), b in zip(left.columns().items(), right.columns().values(), strict=True):
        np.testing.assert_array_equal(a, b, err_msg=name)


def test_every_cell_arrives_in_its_place(tmp_path: Path) -> None:
    touches = read(tmp_path, table(OK, MISSED, FALSE))

    nan = np.nan
    expected = {
        "touch": [7, 3, 5],
        "time_s": [14.25, 42.0, 51.5],
        "path": [InputPath.SKIP, InputPath.PLC, InputPath.PLC],
        "axis": [Axis.X, Axis.Y, Axis.Z],
        "sign": [-1.0, 1.0, -1.0],
        "alpha_deg": [180.0, 90.0, 0.0],
        "beta_deg": [30.0, 0.0, -90.0],
        "feed_mm_min": [60.0, 1000.0, 1000.0],
        "approach_mm": [2.5, 4.5, 5.5],
        "position_mm": [-171.75, -41.605, nan],
        "rotary_deg": [90.0, 0.0, nan],
        "temp_c": [20.5, 20.0, nan],
        "edge_us": [16563155.06, 42303246.589, nan],
        "latch_us": [16563204.0, nan, 52172661.0],
        "report_us": [16563751.774, nan, nan],
        "deviation_um": [0.05, nan, -31.1],
        "status": [Status.OK, Status.MISSED, Status.FALSE],
        "session": [0, 0, 0],
        "position_deg": [nan, nan, nan],
        "deviation_arcsec": [nan, nan, nan],
    }
    assert list(touches.columns()) == list(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(touches.columns()[name], values, err_msg=name)


def test_columns_have_the_types_of_their_kind(tmp_path: Path) -> None:
    types = {name: values.dtype for name, values in read(tmp_path, table(OK)).columns().items()}

    assert {types.pop(name) for name in ("touch", "session")} == {np.dtype(np.int64)}
    assert {types.pop(name) for name in ("path", "axis", "status")} == {np.dtype(np.int8)}
    assert set(types.values()) == {np.dtype(np.float64)}


def test_absent_columns_count_as_empty(tmp_path: Path) -> None:
    touches = read(tmp_path, f"{SHORT}\n1,2,skip,60,3\n")

    assert touches.axis[0] == NOT_RECORDED
    assert touches.status[0] == NOT_RECORDED
    assert np.isnan([touches.sign[0], touches.edge_us[0], touches.deviation_um[0]]).all()


def test_columns_may_stand_in_any_order(tmp_path: Path) -> None:
    reordered = "".join(",".join(row.split(",")[::-1]) + "\n" for row in (HEADER, OK, MISSED))

    assert_same(read(tmp_path, reordered), read(tmp_path, table(OK, MISSED)))


@pytest.mark.parametrize(
    "text",
    [
        table(OK, MISSED).replace("\n", "\r\n"),
        table(OK, MISSED).replace("\n", "\r"),
        "\ufeff" + table(OK, MISSED),
        '"' + table(OK, MISSED).replace(",", '","').replace("\n", '"\n"').removesuffix('"'),
        table(OK, MISSED).replace("\n", "\n\n"),
        table(OK, MISSED).removesuffix("\n"),
        table(OK, MISSED).replace(",60,", ",6.0e+1,").replace(",-1,", ",-1.0,"),
        table(OK, MISSED).replace(",60,", ",+060.,").replace("0.05", ".05"),
    ],
    ids=["CRLF", "CR", "BOM", "quotes", "blank lines", "no last line end", "floats", "short"],
)
def test_the_same_written_otherwise_is_the_same(tmp_path: Path, text: str) -> None:
    assert_same(read(tmp_path, text), read(tmp_path, table(OK, MISSED)))


def test_unknown_column_is_a_warning_naming_it(tmp_path: Path) -> None:
    with pytest.warns(CampaignWarning) as caught:
        touches = read(tmp_path, f"{SHORT},tempc,operator,\n1,2,skip,60,3,x,y,z\n")

    assert [str(w.message).removeprefix(f"{tmp_path}/") for w in caught] == [
        'touches.csv:1: unknown column "tempc" is ignored; did you mean "temp_c"?',
        'touches.csv:1: unknown column "operator" is ignored',
        'touches.csv:1: unknown column "" is ignored',
    ]
    assert len(touches) == 1


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("", "touches.csv:1: expected a header row, got an empty file"),
        ("\n\n", "touches.csv:1: expected a header row, got an empty file"),
        (
            "touch,time_s,path,approach_mm\n",
            'touches.csv:1: missing column "feed_mm_min"',
        ),
        ("touch,time_s,path\n", 'touches.csv:1: missing column "feed_mm_min", "approach_mm"'),
        (SHORT.replace("path", "Way") + "\n", 'touches.csv:1: missing column "path"'),
        (f"{SHORT},sign,path\n", 'touches.csv:1: column "path" stands 2 times'),
        (f"{SHORT},x,x,x\n", 'touches.csv:1: column "x" stands 3 times'),
        ("\n" + SHORT + "\n", "touches.csv:2: expected touches after the header, got none"),
        (SHORT, "touches.csv:1: expected touches after the header, got none"),
        (SHORT + "," * 200, "touches.csv:1: more than 200 columns"),
    ],
)
def test_wrong_header_is_told(tmp_path: Path, header: str, message: str) -> None:
    assert complaint(tmp_path, header) == message


@pytest.mark.parametrize("column", SHORT.split(","))
def test_every_required_column_is_missed(tmp_path: Path, column: str) -> None:
    rest = ",".join(name for name in SHORT.split(",") if name != column)

    assert complaint(tmp_path, rest) == f'touches.csv:1: missing column "{column}"'


@pytest.mark.parametrize(
    ("column", "cell", "expected"),
    [
        ("touch", "-1", "a whole number from 0 to 9007199254740991"),
        ("touch", "1.0", "a whole number from 0 to 9007199254740991"),
        ("touch", "+1", "a whole number from 0 to 9007199254740991"),
        ("touch", "9007199254740992", "a whole number from 0 to 9007199254740991"),
        ("touch", "1" * 25, "a whole number from 0 to 9007199254740991"),
        ("time_s", "-0.5", "a number >= 0 in s"),
        ("path", "skipped", "skip or plc"),
        ("axis", "U", "X, Y, Z, A, B or C"),
        ("sign", "0", "1 or -1"),
        ("sign", "+", "1 or -1"),
        ("alpha_deg", "12,5", "a number in deg"),
        ("beta_deg", "90.001", "a number from -90 to 90 in deg"),
        ("beta_deg", "-90.001", "a number from -90 to 90 in deg"),
        ("feed_mm_min", "-3", "a number > 0 in mm/min"),
        ("feed_mm_min", "0", "a number > 0 in mm/min"),
        ("feed_mm_min", "1e-7", "a number >= 1e-06 in mm/min"),
        ("feed_mm_min", "1e16", "a number <= 1e+09 in mm/min"),
        ("feed_mm_min", "inf", "a number > 0 in mm/min"),
        ("feed_mm_min", "1_000", "a number > 0 in mm/min"),
        ("feed_mm_min", "0x10", "a number > 0 in mm/min"),
        ("feed_mm_min", "１", "a number > 0 in mm/min"),
        ("feed_mm_min", "6-0", "a number > 0 in mm/min"),
        ("feed_mm_min", "e5", "a number > 0 in mm/min"),
        ("approach_mm", "-2", "a number > 0 in mm"),
        ("position_mm", "left", "a number in mm"),
        ("rotary_deg", "-1e16", "a number >= -1e+07 in deg"),
        ("temp_c", "-300", "a number from -273.15 to 2500 in °C"),
        ("temp_c", "5000", "a number from -273.15 to 2500 in °C"),
        ("latch_us", "1e400", "a number <= 1e+15 in µs"),
        ("report_us", "Infinity", "a number in µs"),
        ("deviation_um", "a\u2028b\x00", "a number in µm"),
        ("deviation_um", "-1.1e7", "a number >= -1e+07 in µm"),
        ("time_s", "1e10", "a number <= 1e+09 in s"),
        ("status", "good", "ok, missed or false"),
    ],
)
def test_wrong_cell_is_told_with_line_and_column(
    tmp_path: Path, column: str, cell: str, expected: str
) -> None:
    quoted = f'"{cell}"'
    shown = quoted.replace("\u2028", "\\u2028").replace("\x00", "\\x00")

    assert complaint(tmp_path, table(MISSED, ok_with(column, quoted))) == (
        f"touches.csv:3: {column}: expected {expected}, got {shown}"
    )


@pytest.mark.parametrize("column", SHORT.split(","))
def test_required_cell_must_not_be_empty(tmp_path: Path, column: str) -> None:
    message = complaint(tmp_path, table(MISSED, ok_with(column, "")))

    assert message.startswith(f"touches.csv:3: {column}: expected ")
    assert message.endswith(", got an empty cell")


@pytest.mark.parametrize(
    "column", [name for name in HEADER.split(",") if name not in SHORT.split(",")]
)
def test_other_cells_may_be_empty(tmp_path: Path, column: str) -> None:
    touches = read(tmp_path, table(MISSED, ok_with(column, "")))

    value = touches.columns()[column][1]
    assert value == NOT_RECORDED or np.isnan(value)


@pytest.mark.parametrize(
    ("row", "got"), [(OK + ",", 18), (OK.removesuffix(",ok"), 16), ("7", 1), ('""', 1)]
)
def test_row_of_another_length_is_told(tmp_path: Path, row: str, got: int) -> None:
    assert complaint(tmp_path, table(MISSED, row)) == (
        f"touches.csv:3: expected 17 cells, got {got}"
    )


def test_line_numbers_count_blank_and_quoted_lines(tmp_path: Path) -> None:
    text = f'{SHORT},"no\nte"\n\n1,2,skip,60,3,"a\r\nb"\n2,2,skip,60,x,\n'

    with pytest.warns(CampaignWarning, match="unknown column"):
        message = complaint(tmp_path, text)

    assert message == 'touches.csv:6: approach_mm: expected a number > 0 in mm, got "x"'


def test_of_many_wrong_cells_the_first_line_is_told(tmp_path: Path) -> None:
    rows = [ok_with("touch", "x"), OK, ok_with("status", "bad"), ok_with("touch", "y")]

    assert complaint(tmp_path, table(MISSED, *rows[1:])) == (
        'touches.csv:4: status: expected ok, missed or false, got "bad"'
    )
    assert complaint(tmp_path, table(*rows)).startswith("touches.csv:2: touch: ")


def test_wrong_cell_behind_many_rows_is_found(tmp_path: Path) -> None:
    rows = "".join(f"{i},{i},skip,60,3\n" for i in range(5000))

    assert complaint(tmp_path, f"{SHORT}\n{rows}9999,-1,skip,60,3\n") == (
        'touches.csv:5002: time_s: expected a number >= 0 in s, got "-1"'
    )


def test_repeated_serial_number_is_told_with_both_lines(tmp_path: Path) -> None:
    rows = (MISSED, OK, FALSE, ok_with("time_s", "99"), MISSED)

    assert complaint(tmp_path, table(*rows)) == (
        "touches.csv:5: touch: serial number 7 stands already in line 3"
    )


@pytest.mark.parametrize(
    ("tail", "column", "got"),
    [
        ("42303661,,", "latch_us", "42303661.000"),
        (",42303661,", "report_us", "42303661.000"),
        (",,-3.5", "deviation_um", "-3.500"),
    ],
)
def test_missed_touch_with_an_outcome_is_told(
    tmp_path: Path, tail: str, column: str, got: str
) -> None:
    row = MISSED.replace(",,,,missed", f",{tail},missed")

    assert complaint(tmp_path, table(OK, row)) == (
        f'touches.csv:3: {column}: expected an empty cell in a missed touch, got "{got}"'
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (table(OK, 'a"b'), "touches.csv:3: expected 17 cells, got 1"),
        (table(OK, '"a"b'), "touches.csv:3: not valid CSV: ',' expected after '\"'"),
        (table(OK, '"a'), "touches.csv:3: not valid CSV: unexpected end of data"),
        (table(OK) + "," * 70_000, "touches.csv:3: line of more than 65536 characters"),
    ],
)
def test_malformed_csv_is_told_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    assert complaint(tmp_path, text) == message


def test_cell_that_runs_over_the_whole_file_is_one_line(tmp_path: Path) -> None:
    message = complaint(tmp_path, table(OK, '"' + MISSED) + (MISSED + "\n") * 3000)

    assert message.endswith("not valid CSV: field larger than field limit (131072)")


@pytest.mark.parametrize("before", [0, 5000])
def test_bytes_that_are_no_utf8_are_told_with_their_line(tmp_path: Path, before: int) -> None:
    rows = "".join(f"{i},{i},skip,60,3\n" for i in range(before))
    data = f"{SHORT}\n{rows}".encode() + b"99999,1,sk\xefp,60,3\n"

    assert complaint(tmp_path, data) == f"touches.csv:{before + 2}: not UTF-8 text"


def test_other_encodings_are_told(tmp_path: Path) -> None:
    assert complaint(tmp_path, table(OK).encode("utf-16")) == "touches.csv:1: not UTF-8 text"


def test_too_many_rows_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MAX_ROWS", 2)
    monkeypatch.setattr(reading, "CHUNK_ROWS", 2)

    assert len(read(tmp_path, table(OK, MISSED))) == 2
    assert complaint(tmp_path, table(OK, MISSED, FALSE)) == (
        "touches.csv: more than 2 touches, which is the most that is read"
    )


def test_too_large_a_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_text, "MAX_BYTES", 10)

    assert complaint(tmp_path, table(OK)) == (
        "touches.csv: larger than 10 bytes, which is the most that is read"
    )


def test_missing_file_is_told(tmp_path: Path) -> None:
    said = refusal(read_touches, tmp_path / "touches.csv", folder=tmp_path)

    assert said == "touches.csv: cannot read: No such file or directory"


@pytest.mark.parametrize("path", ["/dev/zero", "/"])
def test_what_is_no_file_is_told(path: str) -> None:
    assert refusal(read_touches, path) == f"{path}: not a regular file"


def test_conditions_are_touches_without_outcomes(tmp_path: Path) -> None:
    path = tmp_path / "conditions.csv"
    path.write_text("".join(row.rsplit(",", 4)[0] + "\n" for row in (HEADER, OK, MISSED)))

    conditions = read_conditions(path)

    assert conditions.edge_us.tolist() == [16563155.06, 42303246.589]
    assert not conditions.measured.any()
    assert (conditions.status == NOT_RECORDED).all()


def test_outcomes_in_conditions_are_not_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "touches.csv"
    path.write_text(f"{SHORT},status,latch_us\n1,2,skip,60,3,nonsense,4\n")

    conditions = read_conditions(path)

    assert np.isnan(conditions.latch_us).all()
    assert (conditions.status == NOT_RECORDED).all()


def test_masks_tell_paths_and_outcomes_apart(tmp_path: Path) -> None:
    touches = read(tmp_path, table(OK, MISSED, FALSE))

    assert touches.on_skip.tolist() == [True, False, False]
    assert touches.on_plc.tolist() == [False, True, True]
    assert touches.ok.tolist() == [True, False, False]
    assert touches.missed.tolist() == [False, True, False]
    assert touches.false.tolist() == [False, False, True]
    assert touches.measured.tolist() == [True, False, True]


@pytest.mark.parametrize("outcome", ["latch_us", "report_us", "deviation_um"])
def test_touch_of_unrecorded_status_is_ok_if_it_has_an_outcome(
    tmp_path: Path, outcome: str
) -> None:
    touches = read(tmp_path, f"{SHORT},{outcome}\n1,2,skip,60,3,4\n2,2,skip,60,3,\n")

    assert touches.ok.tolist() == [True, False]
    assert not touches.missed.any()
    assert not touches.false.any()


def test_rows_are_selected_and_ordered(tmp_path: Path) -> None:
    touches = read(tmp_path, table(FALSE, OK, MISSED))

    assert touches.touch.tolist() == [5, 7, 3]
    assert touches.in_order_of_time().touch.tolist() == [7, 3, 5]
    assert touches.select(touches.on_plc).touch.tolist() == [5, 3]
    assert touches.select(slice(1, 2)).time_s.tolist() == [14.25]
    assert len(touches.select(touches.time_s < 0)) == 0


def test_touch_without_a_time_stays_behind_the_one_before_it() -> None:
    time_s = np.array([np.nan, 4.0, np.nan, 1.0, np.nan, np.nan, 2.0])

    ordered = Touches.from_columns(touch=np.arange(7), time_s=time_s).in_order_of_time()

    assert ordered.touch.tolist() == [0, 3, 4, 5, 6, 1, 2]


def test_touches_are_built_from_some_columns() -> None:
    touches = Touches.from_columns(
        touch=np.arange(2),
        time_s=np.array([1.0, 2.0]),
        path=np.array([InputPath.SKIP, InputPath.PLC]),
        feed_mm_min=np.array([60, 100]),
        approach_mm=np.array([1.0, 2.0]),
    )

    assert touches.feed_mm_min.dtype == np.float64
    assert touches.path.dtype == np.int8
    assert np.isnan(touches.latch_us).all()


def test_columns_of_different_lengths_are_refused() -> None:
    with pytest.raises(ValueError, match="not all of one"):
        Touches.from_columns(touch=np.arange(2), time_s=np.array([1.0]))
