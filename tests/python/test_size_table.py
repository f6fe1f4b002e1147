"""The record of sizes: what a board that is not in it yet comes to."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

LINT = Path("scripts/lint").resolve()


@pytest.fixture
def size_table(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> ModuleType:
    """Load the script with a board `old` in the record, and sizes that are made up."""
    monkeypatch.syspath_prepend(str(LINT))
    spec = importlib.util.spec_from_file_location("size_table", LINT / "size_table.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "size_table", module)
    spec.loader.exec_module(module)
    record = tmp_path / "SIZE.md"
    record.write_text("| old | program | 1000 | 100 | 100 |\n\n* arm: gcc 1\n", encoding="utf-8")
    monkeypatch.setattr(module, "RECORD", record)
    monkeypatch.setattr(module, "compiler", lambda _: "gcc 1")
    return module


def compare(module: ModuleType, monkeypatch: pytest.MonkeyPatch, flash: int, *boards: str) -> int:
    monkeypatch.setattr(
        module, "measure", lambda board, _: {(board, "program"): module.Size(flash, 100, 100)}
    )
    return int(module.main(["compare", *(f"{board}:arm" for board in boards)]))


def test_a_board_without_a_row_is_skipped_and_named(
    size_table: ModuleType,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert compare(size_table, monkeypatch, 1000, "new") == 77
    last = capsys.readouterr().out.splitlines()[-1]
    assert "new" in last
    assert "make size RECORD=yes" in last


def test_a_board_that_grew_fails_beside_a_new_one(
    size_table: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert compare(size_table, monkeypatch, 1000, "old") == 0
    assert compare(size_table, monkeypatch, 2000, "old", "new") == 1
