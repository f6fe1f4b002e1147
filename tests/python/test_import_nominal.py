"""``skiplatch import --nominal``: what is taken of the nominal.toml of the rig."""

from pathlib import Path

import pytest

from skiplatch.campaign import DatumFreedom
from skiplatch.campaign.datum import Datum
from test_import_logs import Run, log

RIG = 'format = "skiplatch-campaign/2"\nkind = "machine"\n\n[plc]\nscan_us = 2000.0\n'
OFF_KNOWN_FACES = "touch,deviation_um,feed_mm_min\n1,2.5,100\n2,3.5,400\n"
MAPPED = ("--map", "deviation_um=deviation_um", "--map", "feed_mm_min=feed_mm_min")


@pytest.mark.parametrize(
    ("stated", "datum"),
    [
        ("", Datum(DatumFreedom.AXIS)),
        ('\n[datum]\nfree = "axis_sense"\n', Datum(DatumFreedom.AXIS_SENSE)),
        ('\n[datum]\nfree = "campaign"\nu_um = 2.0\n', Datum(DatumFreedom.CAMPAIGN, 2.0)),
        ('\n[datum]\nfree = "none"\n', Datum(DatumFreedom.NONE)),
    ],
)
def test_datum_of_the_rig_goes_with_a_table_of_how_far_touches_were_off(
    tmp_path: Path, stated: str, datum: Datum
) -> None:
    (tmp_path / "rig.toml").write_text(RIG + stated)
    (tmp_path / "t.csv").write_text(OFF_KNOWN_FACES)

    run = Run(
        *(tmp_path, "csv", str(tmp_path / "t.csv"), *MAPPED),
        *("--nominal", str(tmp_path / "rig.toml")),
    )

    assert run.campaign.nominal.datum == datum
    assert run.campaign.nominal.plc.scan_us == 2000.0
    assert "but for its [datum]" not in run.text


def test_surfaces_held_against_their_own_middles_have_a_datum_of_their_own(tmp_path: Path) -> None:
    """A rig whose datum was known once has no known one for a log of other surfaces."""
    (tmp_path / "rig.toml").write_text(f'{RIG}\n[datum]\nfree = "none"\n')
    words = ("--program", log("linuxcnc_bore.ngc"), "--nominal", str(tmp_path / "rig.toml"))

    run = Run(tmp_path, "linuxcnc", log("linuxcnc_bore.txt"), *words)

    assert run.campaign.nominal.datum == Datum(DatumFreedom.SESSION)
    assert 'but for its [datum]: free = "session" is that of these touches' in run.text
