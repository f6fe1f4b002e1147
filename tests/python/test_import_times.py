"""When the moves of a log began, which tells of each touch once it is over."""

from pathlib import Path

import pytest

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
