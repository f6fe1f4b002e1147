"""docs/GAP.md and WITHHELD.md are true: the table of effects, and the effect that is added."""

import json
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from refusals import Program
from skiplatch.campaign import read_campaign

ROOT = Path(__file__).parents[2]
GAP = (ROOT / "docs" / "GAP.md").read_text(encoding="utf-8")
# The commands before it take an hour.
_, OWN_EFFECT = (
    (ROOT / "docs" / "WITHHELD.md").read_text(encoding="utf-8").split("## Add an effect")
)

# Not the surrounding make's, which would have its own ideas of what to build.
ENVIRONMENT = {"PATH": "/usr/local/bin:/usr/bin:/bin", "LANG": "C.UTF-8"}

Run = Callable[[list[str]], str]

pytestmark = pytest.mark.xdist_group("effects_document")


def blocks(text: str, language: str) -> list[str]:
    found = re.findall(rf"^ *```{language}\n(.*?)^ *```$", text, re.DOTALL | re.MULTILINE)
    return [textwrap.dedent(block) for block in found]


def commands(text: str) -> Iterator[list[str]]:
    for block in blocks(text, "sh"):
        yield from (shlex.split(line) for line in block.replace("\\\n", " ").splitlines())


def project_in(folder: Path) -> Run:
    """Give what runs a command of the document in a copy of the project, and gives its output."""
    for name in ("firmware", "hal", "mk", "scripts", ".clang-format"):
        (folder / name).symlink_to(ROOT / name)
    shutil.copy(ROOT / "Makefile", folder)
    shutil.copytree(ROOT / "host_sim", folder / "host_sim")

    def run(command: list[str]) -> str:
        program, *arguments = command
        if command == ["make", "setup"]:  # all of it but the installing; fast to compile
            command = ["make", "-j4", "INNER=yes", "FLAGS.host=-O1", "library"]
        elif program == "skiplatch":
            command = [sys.executable, "-m", "skiplatch.cli", *arguments]
        environment = {**ENVIRONMENT, "PYTHONPATH": str(folder / "scripts")}
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Run]:
    """The project with the document's effect added, word for word, and built."""
    folder = tmp_path_factory.mktemp("extended")
    run = project_in(folder)
    step = r"^\d\. \*\*`([^`]*)`\*\*,(?: after `([^`]*)`,)?[^\n]*\n\n( *```c\n.*?^ *```$)"
    steps = re.findall(step, OWN_EFFECT, re.DOTALL | re.MULTILINE)
    assert len(steps) == 3
    for path, anchor, block in steps:
        insert_after(folder / path, anchor, block)
    run(["make", "setup"])
    return folder, run


def insert_after(path: Path, anchor: str, block: str) -> None:
    """Put the lines of a code block behind the line that ends with `anchor`; none: a new file."""
    lines = block.splitlines()[1:-1]
    code = "".join(f"{line.removeprefix('   ')}\n" for line in lines)
    before = path.read_text(encoding="utf-8") if anchor else ""
    assert before.count(f"{anchor}\n") == bool(anchor)
    path.write_text(before.replace(f"{anchor}\n", f"{anchor}\n{code}") or code, encoding="utf-8")


def test_its_table_is_what_the_program_prints() -> None:
    table = project_in_place("effects", "--markdown")

    assert table in GAP, "put what 'skiplatch effects --markdown' prints into docs/GAP.md"


def project_in_place(*arguments: str) -> str:
    command = [sys.executable, "-m", "skiplatch.cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout


def test_the_terminal_shows_every_effect_with_its_physics_and_parameters() -> None:
    shown = project_in_place("effects")

    for row in re.findall(r"^\| `(\w+)` \| (\w+) \| (\w+) \| (.*?) \| (.*) \|$", GAP, re.MULTILINE):
        effect_id, stage, paths, physics, parameters = row
        assert f"{stage}:\n" in shown
        assert re.search(rf"^  {effect_id} +{paths} +{re.escape(physics)}$", shown, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", parameters):
            assert f"    {name} " in shown


def test_a_misspelt_effect_is_one_line_that_names_the_nearest(refused: Program) -> None:
    said = refused("simulate", "--effect", "backlsh")

    assert "backlsh" in said
    assert "backlash" in said


@pytest.mark.long
def test_its_own_effect_is_laid_out_as_lint_wants_it(extended: tuple[Path, Run]) -> None:
    folder, run = extended
    files = [str(path) for path in sorted((folder / "host_sim" / "effects").iterdir())]
    clang_format = str(Path(sys.executable).with_name("clang-format"))

    run([clang_format, "--dry-run", "-Werror", *files])


@pytest.mark.long
def test_its_own_effect_is_listed_in_its_stage(extended: tuple[Path, Run]) -> None:
    folder, run = extended

    text = run(["skiplatch", "effects", "--json", "effects.json"])

    rows = json.loads((folder / "effects.json").read_text())["effects"]
    ids = [row["id"] for row in rows]
    assert ids[ids.index("trigger_delay") + 1] == "stylus_bending"
    assert "the stylus bends more than at calibration" in text
    assert "0.1 … 20 mm" in text


@pytest.mark.long
def test_its_own_effect_is_played(extended: tuple[Path, Run]) -> None:
    folder, run = extended
    *others, simulate = commands(OWN_EFFECT)
    assert others == [["make", "setup"], ["skiplatch", "effects"]]
    where = simulate.index("--effect")
    run(simulate)
    run([*simulate[:where], *simulate[where + 2 : -1], "build/nominal"])

    bent, nominal = (
        read_campaign(folder / "build" / name).touches for name in ("with_bending", "nominal")
    )
    # 0.1 N on a beam of 50 mm by 2 mm of tungsten carbide.
    bending_um = 1e3 * 0.1 * 50.0**3 / (3.0 * 600e3 * np.pi * 2.0**4 / 64.0)
    shift_um = (bent.deviation_um - nominal.deviation_um)[nominal.on_skip]
    across = np.cos(np.deg2rad(np.nan_to_num(nominal.beta_deg)))[nominal.on_skip]

    assert bending_um == pytest.approx(8.84, abs=0.01)
    resolution_um = 0.5
    np.testing.assert_allclose(shift_um, bending_um * across, atol=resolution_um + 0.1)
    assert shift_um.mean() == pytest.approx((bending_um * across).mean(), abs=0.05)


def diagnosed(project: tuple[Path, Run], effect: str) -> dict[str, dict[str, float]]:
    """Simulate an effect in the extended project and give what its diagnosis names."""
    folder, run = project
    sample = "scripts/samples/machine_no_gap"
    out = f"build/{effect.partition(':')[0]}"
    head, *rows = (folder / sample / "touches.csv").read_text().splitlines(keepends=True)
    (folder / "conditions.csv").write_text("".join([head, *rows[::2]]))
    played = ["--nominal", f"{sample}/nominal.toml", "--conditions", "conditions.csv"]
    run(["skiplatch", "simulate", "--effect", effect, *played, "--out", out])
    run(["skiplatch", "diagnose", out, "--seed", "1", "--jobs", "2", "--json", "own.json"])
    named = json.loads((folder / "own.json").read_text())["effects"]
    return {effect["id"]: effect["params"] for effect in named}


@pytest.mark.long
def test_the_documents_own_effect_is_named_with_its_size(extended: tuple[Path, Run]) -> None:
    """The bending goes with F·L³/d⁴; which of the three it is, no touch can tell."""
    named = diagnosed(extended, "stylus_bending:force_n=0.1,length_mm=50,diameter_mm=2")

    assert named.keys() == {"stylus_bending"}
    p = named["stylus_bending"]
    size = p["force_n"] * p["length_mm"] ** 3 / p["diameter_mm"] ** 4
    assert size == pytest.approx(0.1 * 50.0**3 / 2.0**4, rel=0.02)


@pytest.mark.long
def test_another_effect_is_not_taken_for_the_documents_own(extended: tuple[Path, Run]) -> None:
    named = diagnosed(extended, "pretravel_lobing:amplitude_um=3,azimuth_deg=20")

    assert named.keys() == {"pretravel_lobing"}
