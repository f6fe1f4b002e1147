"""``skiplatch import mdf``: with asammdf, and what is said without it."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from refusals import Program
from skiplatch.campaign import read_campaign
from skiplatch.cli import group
from skiplatch.errors import CampaignWarning
from skiplatch.importing.apart import read_apart


def test_missing_reader_is_named(
    tmp_path: Path, refused: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "asammdf", None)
    (tmp_path / "b.mf4").write_bytes(b"MDF     4.10    ")

    said = refused("import", "mdf", tmp_path / "b.mf4", "--out", tmp_path / "made")

    assert "asammdf, which is not installed: pip install asammdf" in said
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    ("kind", "happens", "said"),
    [
        ("mdf", "os.kill(os.getpid(), signal.SIGSEGV)", "cannot be read: its reader died of it"),
        ("mdf", "os._exit(0)", "cannot be read: its reader died of it"),
        ("mdf", "raise IndexError('of a block')", '"of a block"'),
        ("can", "os.kill(os.getpid(), signal.SIGSEGV)", "cannot be read: its reader died of it"),
        ("can", "raise IndexError('of a block')", '"of a block"'),
    ],
)
def test_damage_that_its_reader_dies_of_is_one_line(
    happens: str, said: str, kind: str, tmp_path: Path
) -> None:
    """In place of asammdf stands what logs a line, and then dies as it does of damaged files."""
    stand_in = f"""
import os, signal, sys
def dies(*_, **__):
    os.write(2, b"asammdf - ERROR - could not parse header")
    {happens}
def __getattr__(_):
    return dies
for name in ("mdf", "blocks", "blocks.mdf_v4", "blocks.v4_blocks", "blocks.v4_constants"):
    sys.modules["asammdf." + name] = sys.modules[__name__]
"""
    (tmp_path / "asammdf.py").write_text(stand_in)
    (tmp_path / "b.mf4").write_bytes(b"MDF     4.10    ")

    words = ["import", kind, str(tmp_path / "b.mf4"), "--out", str(tmp_path / "made")]
    command = [sys.executable, "-m", "skiplatch", *words]
    sees = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(command, env=sees, capture_output=True, text=True, check=False)

    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.endswith(f"{said}\n")
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "made").exists()


def test_what_a_reader_warns_of_is_told() -> None:
    with pytest.warns(CampaignWarning, match="x: cut") as told:
        assert read_apart(warns, Path("x")) == 7

    assert len(told) == 1


def warns(path: Path) -> int:
    warnings.warn(CampaignWarning(path, None, None, "cut"), stacklevel=1)
    return 7


def test_channels_of_volts_and_of_bits_are_edges(tmp_path: Path) -> None:
    asammdf = pytest.importorskip("asammdf", reason="asammdf is not installed: make mdf")
    step_s, late_s = 1e-6, 12e-6
    times_s = np.arange(200_000) * step_s
    starts_s = 0.01 + 0.03 * np.arange(6)

    def high(begin_s: float) -> NDArray[np.bool_]:
        since_s = times_s[:, None] - starts_s - begin_s
        return np.asarray(((since_s > -step_s / 2) & (since_s < 1e-3)).any(axis=1))

    volts = 0.2 + 4.6 * high(0.0)
    latch = high(late_s).astype(np.uint8)
    with asammdf.MDF(version="4.10") as recording:
        recording.append(
            [
                asammdf.Signal(volts, times_s, name="Edge", unit="V"),
                asammdf.Signal(latch, times_s, name="Latch"),
            ]
        )
        recording.save(tmp_path / "bench.mf4")

    words = ["import", "mdf", str(tmp_path / "bench.mf4"), "-o", str(tmp_path / "made")]
    result = CliRunner().invoke(group, words, catch_exceptions=False)

    assert result.exit_code == 0, result.output
    made = read_campaign(tmp_path / "made")
    assert made.touches.latch_us - made.touches.edge_us == pytest.approx(12.0, abs=1e-3)
    assert len(made.touches) == len(starts_s)
    assert made.nominal.skip.tick_us == pytest.approx(1.0)
