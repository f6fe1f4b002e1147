"""The speed table for a target and for a control, as these read them."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from seat_probe import OMP40, directions, radii, write_radii
from skiplatch import cli

ROOT = Path(__file__).parents[2]
V0, TAU = 50.0, 12.68
PROGRAM = """
#include <stdio.h>
#include "probe_feeds.h"
int main(void)
{
    int dx, dy, dz;
    while (scanf("%d %d %d", &dx, &dy, &dz) == 3) {
        double units = pretravel_lookup(&probe_feeds, (int16_t)dx, (int16_t)dy, (int16_t)dz);
        printf("%.6f\\n", units * PROBE_FEEDS_UNIT_NM_MIN / 1e6);
    }
    return 0;
}
"""


def write(folder: Path, *arguments: str) -> str:
    path = write_radii(folder / "radii.csv", radii(OMP40, V0, TAU, runs=1, sigma_um=0.0))
    base = ["compensate", str(path), "--v0", "50", "--tau", "12.68", "--out", str(folder / "t.csv")]
    result = CliRunner().invoke(cli.group, [*base, *arguments])
    assert result.exit_code == 0, result.output
    return result.output


def looked_up(folder: Path, vectors: np.ndarray) -> np.ndarray:
    """Compile the header with the firmware's lookup, and ask it; shape (n,)."""
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("no gcc: the header for the target is not compiled")
    (folder / "main.c").write_text(PROGRAM)
    sources = [str(folder / "main.c"), str(ROOT / "firmware/comp/pretravel_lookup.c")]
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    program = folder / "main"
    command: list[str | Path] = [
        compiler,
        *flags,
        f"-I{ROOT / 'firmware'}",
        f"-I{folder}",
        *sources,
        "-o",
        program,
    ]
    subprocess.run(command, check=True)
    asked = "\n".join(" ".join(map(str, vector)) for vector in vectors.tolist())
    answer = subprocess.run([program], input=asked, capture_output=True, text=True, check=True)
    return np.array(answer.stdout.split(), dtype=float)


def vectors_of(alpha_deg: np.ndarray, beta_deg: np.ndarray) -> np.ndarray:
    alpha, beta = np.radians(alpha_deg), np.radians(beta_deg)
    unit = [np.cos(beta) * np.cos(alpha), np.cos(beta) * np.sin(alpha), np.sin(beta)]
    return np.round(16_000.0 * np.column_stack(unit)).astype(int)


def test_header_gives_the_feeds_of_the_table_on_the_target(tmp_path: Path) -> None:
    """Both are straight lines between points, and corners of the table are cut.

    Its azimuths are 30° apart, vertices at most 3.6°: a corner in the middle between two of these
    is cut by the slope times half of that, and a vertex is rounded to a byte.
    """
    output = write(tmp_path, "--header", str(tmp_path / "probe_feeds.h"), "--divisions", "32")

    found = looked_up(tmp_path, vectors_of(*directions()))
    table = np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)[:, 2]
    slope = np.abs(np.diff(table[:108].reshape(9, 12), axis=1)).max() / 30.0
    worst = float(np.abs(found - table).max())
    assert worst < slope * 3.6 / 2.0 + table.max() / 255.0
    assert f"within {worst:.2f} mm/min of the table, {worst * TAU / 60.0:.2f} µm of" in output


def test_coarser_header_is_smaller_and_less_exact(tmp_path: Path) -> None:
    text, errors = [], []
    for divisions in ("4", "16"):
        write(tmp_path, "--header", str(tmp_path / "probe_feeds.h"), "--divisions", divisions)
        text.append((tmp_path / "probe_feeds.h").read_text())
        table = np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)[:, 2]
        found = looked_up(tmp_path, vectors_of(*directions()))
        errors.append(float(np.abs(found - table).max()))

    assert [int(re.findall(r"vertices\[(\d+)\]", part)[0]) for part in text] == [41, 545]
    assert errors[1] < 0.5 * errors[0]


def test_file_name_makes_a_name_of_c(tmp_path: Path) -> None:
    write(tmp_path, "--header", str(tmp_path / "2nd probe.h"))

    assert (
        "static const pretravel_lookup_t probe_2nd_probe = {"
        in (tmp_path / "2nd probe.h").read_text()
    )


def test_control_gets_a_variable_for_each_direction(tmp_path: Path) -> None:
    write(tmp_path, "--nc", str(tmp_path / "t.nc"), "--nc-first", "601")

    program = (tmp_path / "t.nc").read_text()
    lines = program.splitlines()
    pattern = r"#(\d+)=(\d+\.\d+) \(ALPHA ([\d.]+) BETA ([\d.]+)\)"
    rows = np.array(re.findall(pattern, program), dtype=float)
    table = np.loadtxt(tmp_path / "t.csv", delimiter=",", skiprows=1)
    assert (lines[0], lines[-2:]) == ("%", ["M99", "%"])
    assert rows[:, 0].tolist() == list(range(601, 710))
    np.testing.assert_allclose(rows[:, [2, 3, 1]], table, atol=1e-9)
    assert program.isascii()
    assert all(line.count("(") <= 1 for line in lines)


@pytest.mark.parametrize(("first", "fits"), [("891", True), ("892", False), ("10891", True)])
def test_table_ends_with_the_variables_of_the_control(
    tmp_path: Path, first: str, *, fits: bool
) -> None:
    path = write_radii(tmp_path / "radii.csv", radii(OMP40, V0, TAU, runs=1, sigma_um=0.0))
    arguments = ["--v0", "50", "--tau", "12.68", "--out", str(tmp_path / "t.csv")]
    control = ["--nc", str(tmp_path / "t.nc"), "--nc-first", first]

    result = CliRunner().invoke(cli.group, ["compensate", str(path), *arguments, *control])

    assert (result.exit_code == 0) is fits
    assert (tmp_path / "t.nc").exists() is fits
    assert (tmp_path / "t.csv").exists() is fits
