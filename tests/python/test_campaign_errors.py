"""The one line in which the user learns what is wrong."""

import pickle
import re
import shutil
from pathlib import Path

import pytest

from skiplatch.campaign import read_campaign
from skiplatch.errors import CampaignWarning, InputError, hint, quoted


@pytest.mark.parametrize(
    ("line", "column", "text"),
    [
        (None, None, "rig/nominal.toml: wrong"),
        (3, None, "rig/nominal.toml:3: wrong"),
        (3, 7, "rig/nominal.toml:3:7: wrong"),
        (3, "feed_mm_min", "rig/nominal.toml:3: feed_mm_min: wrong"),
        (None, "edge_us", "rig/nominal.toml: edge_us: wrong"),
    ],
)
def test_known_parts_of_the_place_are_told(
    line: int | None, column: int | str | None, text: str
) -> None:
    assert str(InputError(Path("rig/nominal.toml"), line, column, "wrong")) == text


def test_message_is_one_printable_line_whatever_the_input_holds() -> None:
    error = InputError("a\nb", 1, None, "got \r\n\x1b[2J\u2028\udcff\x00 end")

    assert str(error) == "a\\nb:1: got \\r\\n\\x1b[2J\\u2028\\udcff\\x00 end"


def test_error_survives_the_way_back_from_a_worker_process() -> None:
    error = InputError("touches.csv", 4, "sign", "wrong")

    assert str(pickle.loads(pickle.dumps(error))) == str(error)  # noqa: S301


def test_several_errors_are_a_line_each_by_their_place_also_from_a_worker() -> None:
    error = InputError.together([InputError("a", 4, 1, "x\ny"), InputError("a", 2, None, "z")])

    assert str(pickle.loads(pickle.dumps(error))) == "a:2: z\na:4:1: x\\ny"  # noqa: S301
    assert [str(one) for one in error.apart] == ["a:2: z", "a:4:1: x\\ny"]


def test_of_very_many_errors_the_first_are_told() -> None:
    error = InputError.together([InputError("a", line, None, "x") for line in range(1, 100)])

    assert str(error).splitlines()[-2:] == ["a:20: x", "a: and 79 more"]


def test_warning_speaks_like_an_error() -> None:
    assert str(CampaignWarning("touches.csv", 1, None, "odd")) == "touches.csv:1: odd"


def test_long_quotation_is_shortened() -> None:
    assert quoted("x" * 40) == '"' + "x" * 40 + '"'
    assert quoted("x" * 41) == '"' + "x" * 39 + '…"'


def test_hint_names_the_close_word_only() -> None:
    assert hint("delay_ms", ["delay_us", "tick_us"]) == '; did you mean "delay_us"?'
    assert hint("colour", ["delay_us", "tick_us"]) == ""


def test_what_is_wrong_with_either_file_is_told_in_one_run(
    machine_sample: Path, tmp_path: Path
) -> None:
    rig = shutil.copytree(machine_sample, tmp_path / "rig")
    nominal, touches = rig / "nominal.toml", rig / "touches.csv"
    nominal.write_text(re.sub("tick_us.*", "tick_us = -1.0", nominal.read_text()))
    touches.write_text(touches.read_text().replace(",skip,", ",slip,", 1))

    with pytest.raises(InputError) as refused:
        read_campaign(rig)

    of_rig, of_touches = str(refused.value).splitlines()
    assert "nominal.toml:" in of_rig
    assert "skip.tick_us" in of_rig
    assert 'path: expected skip or plc, got "slip"' in of_touches
