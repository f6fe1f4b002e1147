"""``skiplatch simulate`` and ``predict``: conditions of a log that tells no times and ways."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.campaign import read_campaign
from skiplatch.cli import group
from skiplatch.errors import CampaignWarning

LOG = """G21 G91
G38.2 Z-10 F100
[PRB:0.000,0.000,-12.345:1]
G0 Z3
G38.2 Z-10 F20
[PRB:0.000,0.000,-12.349:1]
"""


@pytest.fixture
def imported(tmp_path: Path) -> Path:
    (tmp_path / "g.log").write_text(LOG)
    words = ["import", "grbl", str(tmp_path / "g.log"), "-o", str(tmp_path / "log")]
    assert CliRunner().invoke(group, words, catch_exceptions=False).exit_code == 0
    return tmp_path / "log"


@pytest.mark.parametrize("command", ["simulate", "predict"])
def test_own_touches_of_a_log_are_played(imported: Path, tmp_path: Path, command: str) -> None:
    out = tmp_path / "out"
    touches = ["--conditions", str(imported / "touches.csv"), "-o", str(out)]
    rig = [str(imported)] if command == "predict" else ["--nominal", str(imported / "nominal.toml")]

    with pytest.warns(CampaignWarning, match="a stand-in is played") as warned:
        result = CliRunner().invoke(group, [command, *rig, *touches], catch_exceptions=False)

    assert result.exit_code == 0
    assert {str(one.message).split(": ")[1] for one in warned} == {"time_s", "approach_mm"}
    if command == "simulate":
        assert read_campaign(out).touches.ok.all()
    else:
        assert len(out.read_text().splitlines()) == 3


def test_feed_has_no_stand_in(imported: Path, tmp_path: Path, refused: Program) -> None:
    path = tmp_path / "c.csv"
    path.write_text("touch,axis,sign,feed_mm_min\n0,Z,-1,100\n1,Z,-1,\n")

    said = refused(
        *("simulate", "--nominal", imported / "nominal.toml", "--conditions", path),
        *("-o", tmp_path / "x"),
    )

    assert "c.csv:3: feed_mm_min: expected a number" in said
