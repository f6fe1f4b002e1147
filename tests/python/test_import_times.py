"""When the moves of a log began, which tells of each touch once it is over."""

from pathlib import Path

import pytest

from refusals import Program
from skiplatch.importing.model import Touch
from skiplatch.importing.touch_times import begun_before
from test_import_logs import Run


def touch(time_s: float | None, *, way: float | None = 10.0, feed: float | None = 60.0) -> Touch:
    start = None if way is None else -5.0 + way
    return Touch(axis="Z", coordinate=-5.0, start=start, feed=feed, time_s=time_s)


def began(*touches: Touch) -> list[float | None]:
    list(begun_before(touches))
    return [touch.time_s for touch in touches]


def test_move_began_as_long_before_its_end_as_its_way_takes() -> None:
    assert began(touch(100.0), touch(120.0)) == [90.0, 110.0]


def test_move_begins_no_sooner_than_the_one_before_ended() -> None:
    """Stamps of whole seconds leave it less time than it took."""
    assert began(touch(100.0), touch(105.0)) == [90.0, 100.0]


@pytest.mark.parametrize("unknown", [{"way": None}, {"feed": None}])
def test_end_stands_for_the_beginning_where_the_way_or_the_feed_is_not_known(
    unknown: dict[str, None],
) -> None:
    touches = [touch(100.0, **unknown), touch(120.0, **unknown)]

    assert list(begun_before(touches)) == []
    assert [one.time_s for one in touches] == [100.0, 120.0]


def test_log_without_times_has_none() -> None:
    assert began(touch(None), touch(None)) == [None, None]


def test_slow_touch_before_a_fast_one_does_not_overlap_it(tmp_path: Path) -> None:
    """By the times of the replies, the fast touch would begin before the slow one was over."""
    pair = (
        "[12:0{m}:00.000] > G91\n[12:0{m}:00.000] > G0 Z8\n[12:0{m}:01.000] > G38.2 Z-20 F60\n"
        "[12:0{m}:11.000] [PRB:0.000,0.000,-10.001:1]\n[12:0{m}:11.000] > G0 Z2\n"
        "[12:0{m}:12.000] > G38.2 Z-20 F600\n[12:0{m}:12.200] [PRB:0.000,0.000,-10.011:1]\n"
    )
    (tmp_path / "p.log").write_text("".join(pair.format(m=minute) for minute in range(4)))

    run = Run(tmp_path, "grbl", str(tmp_path / "p.log"))

    assert run.said["odd"] == []
    began_s = run.campaign.touches.time_s
    assert began_s[3] - began_s[2] == pytest.approx(12.0 - 3.0, abs=0.02)  # 8 mm, and 0.2 s


MAPS = ("--map", "coordinate_mm=Z [mm]", "--axis", "Z", "--sign", "-1", "--feed", "100")
TIME, DATE = ("--map", "time=Uhrzeit"), ("--map", "date=Datum")


def dated(folder: Path, heads: str, *stamps: str) -> str:
    """Write a table of touches whose first cells tell when they were made."""
    rows = [f"{stamp};{-12.0 - i / 1e3:.3f}" for i, stamp in enumerate(stamps)]
    (folder / "t.csv").write_text("\n".join([f"{heads};Z [mm]", *rows]) + "\n")
    return str(folder / "t.csv")


@pytest.mark.parametrize("maps", [(), TIME, (*TIME, *DATE)])
@pytest.mark.parametrize(
    ("dates", "times"),
    [
        (("2026-03-13", "2026-03-13", "2026-03-16"), ("22:00:00", "23:30:00", "06:00:00")),
        (("13.03.2026", "13.3.2026", "16.03.2026"), ("22:00:00", "23:30:00,0", "6:00:00")),
        (("13/03/2026", "13/03/2026", "16/03/2026"), ("22:00", "23:30", "06:00")),
        (("3/13/2026", "3/13/2026", "3/16/2026"), ("22:00:00", "23:30:00", "06:00:00")),
        (("4/5/2026", "4/5/2026", "4/8/2026"), ("10:00:00 PM", "11:30:00 PM", "6:00:00 AM")),
        (("2026/03/13", "", "2026/03/16"), ("22:00:00", "23:30:00", "06:00:00")),
    ],
)
def test_dates_in_a_column_of_their_own_count(
    tmp_path: Path, maps: tuple[str, ...], dates: tuple[str, ...], times: tuple[str, ...]
) -> None:
    """By times of day alone the last touch would be 6.5 h after the one before, not 54.5 h."""
    stamps = (";".join(pair) for pair in zip(dates, times, strict=True))
    table = dated(tmp_path, "Datum;Uhrzeit", *stamps)

    run = Run(tmp_path, "csv", table, *maps, *MAPS)

    assert run.campaign.touches.time_s.tolist() == [0.0, 5400.0, 56 * 3600.0]
    assert 'date from "Datum"' in run.said["known"]
    assert not any("times of day" in line for line in run.said["assumed"])


def test_empty_date_goes_on_past_midnight(tmp_path: Path) -> None:
    stamps = ("13.03.2026;23:59:00", ";00:01:00", ";00:02:00", "14.03.2026;00:03:00")

    run = Run(tmp_path, "csv", dated(tmp_path, "Datum;Uhrzeit", *stamps), *MAPS)

    assert run.campaign.touches.time_s.tolist() == [0.0, 120.0, 180.0, 240.0]


@pytest.mark.parametrize(
    ("heads", "stamps"),
    [
        ("Date;Time", ("04/05/2026;10:00:00", "05/06/2026;11:00:00")),  # day or month first?
        ("Date;Time", ("batch 7;10:00:00", "batch 7;11:00:00")),
        ("Date;Test date;Time", ("2026-03-13;2026-03-14;10:00:00",)),
        ("Order;Time", ("2026-03-13;10:00:00", "2026-03-14;11:00:00")),
    ],
)
def test_column_that_may_be_no_date_is_not_taken(
    tmp_path: Path, heads: str, stamps: tuple[str, ...]
) -> None:
    table = dated(tmp_path, heads, *stamps)

    run = Run(tmp_path, "csv", table, "--map", "time=Time", *MAPS)

    assert not any(line.startswith("date from") for line in run.said["known"])
    assert any("times of day without a date" in line for line in run.said["assumed"])


@pytest.mark.parametrize(
    ("stamp", "maps", "said"),
    [
        ("04/05/2026;10:00", (*TIME, *DATE), ":2: Datum: expected dates such as 2026-03-14"),
        ("2026-03-13;2026-03-13T10:00", (*TIME, *DATE), ":2: Uhrzeit: expected times of day"),
        ("2026-03-13;10:00", DATE, ": date: expected --map time= beside it"),
    ],
)
def test_dates_that_are_none_are_refused(
    tmp_path: Path, refused: Program, stamp: str, maps: tuple[str, ...], said: str
) -> None:
    table = dated(tmp_path, "Datum;Uhrzeit", stamp, stamp)

    assert said in refused("import", "csv", table, *maps, *MAPS, "-o", tmp_path / "c")


def test_times_that_run_backwards_are_said_to_be_odd(tmp_path: Path) -> None:
    rows = ("3,0.1", "1,0.2", "0.5,0.3", "7,-0.1")
    (tmp_path / "t.csv").write_text("t [s],dev [um]\n" + "\n".join(rows) + "\n")
    maps = ("--map", "time_s=t [s]", "--map", "deviation_um=dev [um]", "--axis", "Z")

    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *maps, "--feed", "100")

    (said,) = (line for line in run.said["odd"] if line.startswith("time_s"))
    assert said.endswith("touches are taken in order of time: touches 1, 2")
