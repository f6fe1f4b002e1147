"""The speed table as the controller has it, in bytes and fixed point, in the whole experiment."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from skiplatch import cli
from skiplatch.compensation.radius_map import Map

LENGTH = 16_384
THE_RING = "ignore:.*touches are no part of the map:skiplatch.errors.CampaignWarning"
"""The recorded campaign holds the ring's touches, too, and is said to."""


def call(*arguments: object) -> None:
    result = CliRunner().invoke(cli.group, [str(each) for each in arguments])
    assert result.exit_code == 0, result.output


def looked_up(table: Path, divisions: int) -> Path:
    """Write the feeds that the controller finds in place of those of a table."""
    alpha_deg, beta_deg, feed_mm_min = np.loadtxt(table, delimiter=",", skiprows=1).T
    cells = Map.from_readings(alpha_deg, beta_deg, feed_mm_min)
    held = cells.lookup(cells.radius_um, divisions=divisions)
    alpha, beta = np.radians(alpha_deg), np.radians(beta_deg)
    unit = np.column_stack(
        [np.cos(beta) * np.cos(alpha), np.cos(beta) * np.sin(alpha), np.sin(beta)]
    )
    found_mm_min = held.speed_mm_min(np.round(LENGTH * unit).astype(np.int16))
    out = table.with_name(f"looked_up_{divisions}.csv")
    rows = np.column_stack([alpha_deg, beta_deg, found_mm_min])
    head = "alpha_deg,beta_deg,feed_mm_min"
    np.savetxt(out, rows, fmt=("%g", "%g", "%.4f"), delimiter=",", header=head, comments="")
    return out


@pytest.mark.long
@pytest.mark.filterwarnings(THE_RING)
def test_the_finest_table_of_the_controller_takes_nine_tenths_off(tmp_path: Path) -> None:
    """A map with one seed, the table measured with another; M = 16 cuts the crests and does not."""
    table, out = tmp_path / "table.csv", tmp_path / "out.json"
    call("pretravel", "--rig", "haas", "--seed", 1, "--record", tmp_path / "one")
    call("compensate", "--from-campaign", tmp_path / "one" / "before", "--v0", 100, "--out", table)
    factors = {}
    for divisions in (16, 32):
        given = ("--table", looked_up(table, divisions), "--json", out)
        call("pretravel", "--rig", "haas", "--seed", 2, *given)
        found = json.loads(out.read_text())
        factors[divisions] = found["vr_before_um"] / found["vr_after_um"]

    assert factors[32] > 10.0 > factors[16] > 5.0
