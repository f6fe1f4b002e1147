"""Which test files `make quick` runs."""

from pathlib import Path

import pytest

import quick_tests

CASE = '<testcase classname="tests.python.{}" time="{}"/>'
FILES = [Path(f"tests/python/{name}.py") for name in ("test_slow", "test_quick", "test_new")]


def test_quick_new_and_changed_files_are_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cases = CASE.format("test_slow", 0.7) * 2 + CASE.format("test_quick", 0.9)
    (tmp_path / "junit.xml").write_text(f"<testsuites>{cases}</testsuites>")

    monkeypatch.setattr(quick_tests, "changed", set)
    assert quick_tests.quick(FILES, tmp_path / "junit.xml", 1.0) == FILES[1:]

    monkeypatch.setattr(quick_tests, "changed", lambda: {FILES[0]})
    assert quick_tests.quick(FILES, tmp_path / "junit.xml", 1.0) == FILES


def test_without_a_run_the_changed_files_are_run_and_it_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(quick_tests, "changed", lambda: {FILES[0], Path("README.md")})

    assert quick_tests.quick(FILES, tmp_path / "none.xml", 1.0) == FILES[:1]
    assert "make test has not run here" in capsys.readouterr().err


def test_the_last_line_counts_what_passed() -> None:
    """`make quick` in a fresh clone said nothing of what had run."""
    recipe = Path("mk/quick.mk").read_text().rstrip().splitlines()
    (told,) = [line for line in recipe if line.lstrip().startswith("END { printf")]

    assert "tests of C in %d files and %d test files of Python passed" in told
    assert recipe.index(told) >= len(recipe) - 2
