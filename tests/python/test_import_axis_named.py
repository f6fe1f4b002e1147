"""``skiplatch import csv``: coordinates under the name of an axis are those of that axis."""

from pathlib import Path

import pytest

from skiplatch.campaign import Axis
from test_import_logs import Run


def axis_of(tmp_path: Path, text: str, *words: str) -> tuple[Axis, list[str]]:
    (tmp_path / "t.csv").write_text(text)
    run = Run(tmp_path, "csv", str(tmp_path / "t.csv"), *words)
    (axis,) = set(run.campaign.touches.axis.tolist())
    said: list[str] = run.said["assumed"]
    return Axis(int(axis)), said


WORDS = "X=250.1198 F=150\nX=250.1216 F=600\n"


@pytest.mark.parametrize(
    ("text", "mapping", "axis"),
    [
        (WORDS, "X", Axis.X),
        (WORDS.replace("X", "B"), "B", Axis.B),
        ("X [mm],F\n250.1,150\n250.2,150\n", "X", Axis.X),
        ("Y,F\n250.1,150\n250.2,150\n", "Y [mm]", Axis.Y),
        ("y_mm,F\n250.1,150\n250.2,150\n", "y_mm", Axis.Y),
    ],
)
def test_head_that_names_an_axis_tells_it(
    tmp_path: Path, text: str, mapping: str, axis: Axis
) -> None:
    found, said = axis_of(tmp_path, text, "--map", f"coordinate_mm={mapping}")

    assert found is axis
    told = f"{axis.name} probed, as the head of coordinate_mm names it; else give --axis"
    assert told in said
    assert not any("no column says which axis" in line for line in said)


def test_axis_beside_faces_is_that_of_the_head(tmp_path: Path) -> None:
    text = "X,face\n250.11,250\n-249.98,-250\n"
    words = ("--map", "coordinate_mm=X", "--map", "position_mm=face")

    assert axis_of(tmp_path, text, *words)[0] is Axis.X


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (WORDS, ("--map", "coordinate_mm=X", "--axis", "Y")),
        ("X,axis\n1.5,Y\n1.6,Y\n", ("--map", "coordinate_mm=X", "--map", "axis=axis")),
    ],
)
def test_axis_that_is_given_goes_before_the_head(
    tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    found, said = axis_of(tmp_path, text, *words)

    assert found is Axis.Y
    assert not any("names it" in line for line in said)


def test_other_heads_tell_no_axis(tmp_path: Path) -> None:
    found, said = axis_of(tmp_path, "U\n1.5\n1.6\n", "--map", "coordinate_mm=U")

    assert found is Axis.Z
    assert any("no column says which axis" in line for line in said)
