"""Files and folders are there as a whole or not at all."""

import os
import stat
import threading
from pathlib import Path

import pytest

from refusals import refusal
from skiplatch.errors import InputError
from skiplatch.files import (
    atomic_write_bytes,
    atomic_write_folder,
    atomic_write_text,
    refuse_special_or_large,
)


def names(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


def test_text_is_written_as_utf8_with_its_own_line_ends(tmp_path: Path) -> None:
    atomic_write_text(tmp_path / "a", "µ\r\n\n")

    assert (tmp_path / "a").read_bytes() == b"\xc2\xb5\r\n\n"


def test_file_is_replaced_and_nothing_else_is_left(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("old")

    atomic_write_bytes(tmp_path / "a", b"new")

    assert (tmp_path / "a").read_text() == "new"
    assert names(tmp_path) == ["a"]


def test_new_file_has_the_permissions_of_the_user(tmp_path: Path) -> None:
    previous = os.umask(0o027)
    try:
        atomic_write_bytes(tmp_path / "a", b"")
    finally:
        os.umask(previous)

    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_failure_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / "a").write_text("old")
    monkeypatch.setattr(os, step, fail)

    said = refusal(atomic_write_bytes, tmp_path / "a", b"new", folder=tmp_path)

    assert said == "a: cannot write: No space left on device"
    assert (tmp_path / "a").read_text() == "old"
    assert names(tmp_path) == ["a"]


def test_interruption_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    (tmp_path / "a").write_text("old")
    monkeypatch.setattr(os, "fsync", interrupt)

    with pytest.raises(KeyboardInterrupt):
        atomic_write_bytes(tmp_path / "a", b"new")

    assert (tmp_path / "a").read_text() == "old"
    assert names(tmp_path) == ["a"]


def test_link_is_followed_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("old")
    (tmp_path / "link").symlink_to("a")

    atomic_write_bytes(tmp_path / "link", b"new")

    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "a").read_text() == "new"


def test_loop_of_links_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")

    with pytest.raises(InputError, match="loop/a: cannot write: Too many levels of symbolic links"):
        atomic_write_bytes(tmp_path / "loop" / "a", b"")


def test_device_is_written_to_not_replaced() -> None:
    atomic_write_bytes(os.devnull, b"gone")

    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)  # noqa: PTH116


def test_folder_in_place_of_the_file_is_one_clear_line(tmp_path: Path) -> None:
    assert refusal(atomic_write_bytes, tmp_path, b"") == f"{tmp_path}: cannot write: Is a directory"


def test_missing_folder_is_one_clear_line(tmp_path: Path) -> None:
    said = refusal(atomic_write_bytes, tmp_path / "no" / "a", b"", folder=tmp_path)

    assert said == "no/a: cannot write: No such file or directory"


def test_unwritable_folder_is_one_clear_line() -> None:
    with pytest.raises(InputError, match=r"^/proc/skiplatch: cannot write: "):
        atomic_write_bytes("/proc/skiplatch", b"")


def test_folder_is_written_with_those_above_it(tmp_path: Path) -> None:
    atomic_write_folder(tmp_path / "up" / "new", {"a": "µ\r\n", "b": ""})

    assert names(tmp_path / "up") == ["new"]
    assert names(tmp_path / "up" / "new") == ["a", "b"]
    assert (tmp_path / "up" / "new" / "a").read_bytes() == b"\xc2\xb5\r\n"


def test_empty_folder_is_taken(tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()

    atomic_write_folder(tmp_path / "new", {"a": "1"})

    assert names(tmp_path / "new") == ["a"]


def test_failure_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)

    said = refusal(atomic_write_folder, tmp_path / "new", {"a": "1"}, folder=tmp_path)

    assert said == "new: cannot write: No space left on device"
    assert names(tmp_path) == []


def test_interruption_leaves_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)

    with pytest.raises(KeyboardInterrupt):
        atomic_write_folder(tmp_path / "new", {"a": "1"})

    assert names(tmp_path) == []


@pytest.mark.parametrize("occupied_by", ["file", "folder"])
def test_what_stands_there_already_is_kept(tmp_path: Path, occupied_by: str) -> None:
    target = tmp_path / "new"
    if occupied_by == "folder":
        target.mkdir()
        (target / "a").write_text("old")
    else:
        target.write_text("old")

    said = refusal(atomic_write_folder, target, {"b": "1"}, folder=tmp_path)

    assert said == "new: exists already and is not an empty folder"
    assert names(tmp_path) == ["new"]
    assert target.is_file() or names(target) == ["a"]


def test_what_appears_meanwhile_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def another_is_faster(*_: object) -> None:
        (tmp_path / "new").mkdir()
        (tmp_path / "new" / "a").write_text("other")

    monkeypatch.setattr(os, "fsync", another_is_faster)

    with pytest.raises(InputError, match="new: cannot write: Directory not empty"):
        atomic_write_folder(tmp_path / "new", {"a": "1"})

    assert names(tmp_path) == ["new"]
    assert (tmp_path / "new" / "a").read_text() == "other"


def test_file_among_the_folders_above_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "up").write_text("")

    said = refusal(atomic_write_folder, tmp_path / "up" / "new", {}, folder=tmp_path)

    assert said == "up/new: cannot write: Not a directory"


def test_folder_in_an_unwritable_one_is_one_clear_line() -> None:
    with pytest.raises(InputError, match=r"^/proc/skiplatch: cannot write: "):
        atomic_write_folder("/proc/skiplatch", {})


def test_size_at_the_limit_is_read_and_beyond_it_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"12345")

    refuse_special_or_large(tmp_path / "a", 5)

    with pytest.raises(InputError, match="a: larger than 4 bytes, which is the most that is read"):
        refuse_special_or_large(tmp_path / "a", 4)


def test_no_call_waits_for_the_reader_of_a_pipe(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A signal just before such a call would not end it; data of many pages comes whole."""
    pipe, data, read = tmp_path / "fifo", b"data" * 100_000, []
    os.mkfifo(pipe)
    tries = []

    def opened(path: Path, flags: int) -> int:
        assert flags & os.O_NONBLOCK
        tries.append(path)
        if len(tries) == 3:
            reader.start()
        return plain(path, flags)

    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    plain = os.open
    monkeypatch.setattr("skiplatch.files.os.open", opened)

    atomic_write_bytes(pipe, data)

    reader.join()
    assert read == [data]
    assert len(tries) >= 3
