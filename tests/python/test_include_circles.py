"""``scripts/lint/lint_dependencies.py`` finds modules that include one another."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from skiplatch.places import ROOT


@pytest.fixture(scope="module")
def lint() -> ModuleType:
    path = ROOT / "scripts" / "lint" / "lint_dependencies.py"
    spec = importlib.util.spec_from_file_location("lint_dependencies", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write(folder: Path, **files: str) -> None:
    for name, includes in files.items():
        stem, _, ending = name.rpartition("_")
        path = folder / "hal" / "ports" / "one" / f"{stem}.{ending}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(f'#include "{each}.h"\n' for each in includes.split()))


def test_two_sources_that_include_each_others_headers_are_a_circle(
    lint: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, edge_h="", edge_c="edge stepper", stepper_h="", stepper_c="stepper edge")
    monkeypatch.chdir(tmp_path)

    assert lint.check_circles() == [
        "include one another: hal/ports/one/edge, hal/ports/one/stepper"
    ]


def test_a_circle_over_three_modules_is_found(
    lint: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, a_h="", a_c="a b", b_h="", b_c="b c", c_h="", c_c="c a", d_h="a", d_c="d")
    monkeypatch.chdir(tmp_path)

    assert lint.check_circles() == [
        "include one another: hal/ports/one/a, hal/ports/one/b, hal/ports/one/c"
    ]


def test_a_part_may_know_what_it_is_part_of(
    lint: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, store_h="", store_c="store slots", slots_h="store", slots_c="slots")
    monkeypatch.chdir(tmp_path)

    assert lint.check_circles() == []


def test_what_a_second_module_uses_is_no_part(
    lint: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, a_h="", a_c="a b", b_h="a", b_c="b", c_h="", c_c="c b")
    monkeypatch.chdir(tmp_path)

    assert lint.check_circles() == ["include one another: hal/ports/one/a, hal/ports/one/b"]
