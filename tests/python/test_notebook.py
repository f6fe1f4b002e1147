"""docs/first_diagnosis.ipynb runs from top to bottom, and prints what it was stored with."""

import contextlib
import io
import json
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOK = json.loads((ROOT / "docs" / "first_diagnosis.ipynb").read_text(encoding="utf-8"))
CELLS = [cell for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]
DIAGNOSES = next(
    i for i, cell in enumerate(CELLS) if "skiplatch.diagnose" in "".join(cell["source"])
)


def run(cells: list[dict[str, Any]]) -> list[str]:
    """Run code cells one after the other; give what each printed."""
    known: dict[str, Any] = {}
    printed = []
    for cell in cells:
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec("".join(cell["source"]), known)  # noqa: S102 - the notebook's own
        printed.append(said.getvalue())
    return printed


def stored(cells: list[dict[str, Any]]) -> list[str]:
    return ["".join("".join(out["text"]) for out in cell["outputs"]) for cell in cells]


@pytest.fixture
def beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Jupyter starts in the folder of the notebook."""
    monkeypatch.chdir(ROOT / "docs")
    monkeypatch.setattr(plt, "show", plt.close)


@pytest.mark.usefixtures("beside_it")
def test_it_looks_and_simulates_as_it_says() -> None:
    printed = run(CELLS[:DIAGNOSES])

    assert printed == stored(CELLS[:DIAGNOSES])
    assert sum(bool(text) for text in printed) >= 3
    assert Path.cwd() == ROOT


@pytest.mark.long
@pytest.mark.usefixtures("beside_it")
def test_it_diagnoses_and_predicts_as_it_says() -> None:
    assert run(CELLS) == stored(CELLS)


def test_it_is_of_a_format_that_jupyter_opens() -> None:
    assert NOTEBOOK["nbformat"] == 4
    assert {"kernelspec", "language_info"} <= NOTEBOOK["metadata"].keys()
    ids = [cell["id"] for cell in NOTEBOOK["cells"]]
    assert len(set(ids)) == len(ids)
