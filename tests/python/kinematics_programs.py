"""Programs with cycles 450 and 451 for tests, and the sample machine that they run on."""

from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from unittest.mock import patch

from click.testing import CliRunner, Result

from skiplatch.cli import group
from skiplatch.kinematics.machine import RotaryAxis, read_machine

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples" / "kinematics"
MACHINE = SAMPLES / "machine_bc.toml"
LOCATIONS = SAMPLES / "truth_bc_locations.toml"
TRUTH = SAMPLES / "truth_bc.toml"


def program_of(folder: Path, text: str) -> Path:
    path = folder / "program.h"
    path.write_text(text, encoding="utf-8")
    return path


def without_charts() -> AbstractContextManager[object]:
    """Have no charts drawn in the log of a run: they take ten times as long as all the rest."""
    return patch("skiplatch.report.kinematics.draw_axis", return_value={})


def run(
    program: Path, folder: Path, *more: str, truth: Path = LOCATIONS, has_charts: bool = False
) -> Result:
    return evaluated(program, folder, "--truth", str(truth), *more, has_charts=has_charts)


def evaluated(program: Path, folder: Path, *more: str, has_charts: bool = False) -> Result:
    """Run a program, without charts in its log unless they are wanted."""
    files = {"--html": "log.html", "--memory": "store.bin", "--json": "out.json"}
    options = [text for flag, name in files.items() for text in (flag, str(folder / name))]
    with nullcontext() if has_charts else without_charts():
        return CliRunner().invoke(group, ["kinematics", "run", str(program), *options, *more])


def axes_of(path: Path) -> tuple[RotaryAxis, ...]:
    return read_machine(path).axes
