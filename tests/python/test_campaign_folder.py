"""Whole campaigns: the samples, writing what was read, and nothing half-written."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from refusals import refusal
from skiplatch.campaign import (
    COLUMNS,
    Campaign,
    Kind,
    Touches,
    format_touches,
    read_campaign,
    read_nominal,
    write_campaign,
    write_nominal,
    write_touches,
)
from skiplatch.errors import CampaignWarning


@pytest.fixture
def bench(bench_sample: Path) -> Campaign:
    return read_campaign(bench_sample)


def test_bench_sample_is_read(bench: Campaign) -> None:
    touches = bench.touches

    assert bench.nominal.kind is Kind.BENCH
    assert bench.nominal.skip.latency_us == 2.0
    assert len(touches) == 400
    assert np.count_nonzero(touches.on_skip) == 193
    assert touches.ok.all()
    late_us = (touches.latch_us - touches.edge_us)[touches.on_skip]
    assert 48 < late_us.mean() < 50


def test_machine_sample_is_read(machine_sample: Path) -> None:
    campaign = read_campaign(machine_sample)

    assert campaign.nominal.kind is Kind.MACHINE
    assert campaign.nominal.probe.lobe_phase_deg == 110.99
    assert len(campaign.touches) == 400
    assert np.isnan(campaign.touches.edge_us).all()
    assert not np.isnan(campaign.touches.deviation_um).any()


@pytest.mark.parametrize("sample", ["bench_sample", "machine_sample"])
def test_sample_is_written_as_it_was(
    sample: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    source = request.getfixturevalue(sample)
    campaign = read_campaign(source)

    write_campaign(tmp_path / "copy", campaign.nominal, campaign.touches)

    written = (tmp_path / "copy" / "touches.csv").read_bytes()
    assert written == (source / "touches.csv").read_bytes().replace(b"\r\n", b"\n")
    assert read_nominal(tmp_path / "copy" / "nominal.toml") == campaign.nominal
    assert sorted(p.name for p in (tmp_path / "copy").iterdir()) == ["nominal.toml", "touches.csv"]


def test_occupied_folder_is_kept(bench: Campaign, tmp_path: Path) -> None:
    (tmp_path / "nominal.toml").write_text("mine")

    said = refusal(write_campaign, tmp_path, bench.nominal, bench.touches)

    assert said == f"{tmp_path}: exists already and is not an empty folder"
    assert (tmp_path / "nominal.toml").read_text() == "mine"


def test_touches_the_format_does_not_admit_leave_nothing(bench: Campaign, tmp_path: Path) -> None:
    bad = replace(bench.touches, latch_us=np.full(400, np.inf))

    with pytest.raises(ValueError, match="latch_us"):
        write_campaign(tmp_path / "new", bench.nominal, bad)

    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none", "no such folder"),
        (
            "file",
            "not a folder; skiplatch import makes a campaign of a log, skiplatch repeat reads it",
        ),
    ],
)
def test_what_is_no_folder_is_told(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "file").write_text("")

    assert refusal(read_campaign, tmp_path / name) == f"{tmp_path}/{name}: {message}"


def test_folder_of_campaigns_lists_them(bench: Campaign, tmp_path: Path) -> None:
    for name in ("b", "a"):
        write_campaign(tmp_path / name, bench.nominal, bench.touches)

    said = refusal(read_campaign, tmp_path)

    assert said == f"{tmp_path}: no campaign, but a folder of some: a, b"


@pytest.mark.parametrize("lost", ["nominal.toml", "touches.csv"])
def test_missing_file_of_a_campaign_is_told(bench: Campaign, tmp_path: Path, lost: str) -> None:
    write_campaign(tmp_path / "c", bench.nominal, bench.touches)
    (tmp_path / "c" / lost).unlink()

    said = refusal(read_campaign, tmp_path / "c", folder=tmp_path / "c")

    assert said == f"{lost}: cannot read: No such file or directory"


def test_edge_times_of_a_machine_are_a_warning(bench: Campaign, tmp_path: Path) -> None:
    write_campaign(tmp_path / "c", replace(bench.nominal, kind=Kind.MACHINE), bench.touches)

    with pytest.warns(CampaignWarning) as caught:
        read_campaign(tmp_path / "c")

    (warning,) = caught
    assert str(warning.message) == (
        f"{tmp_path}/c/touches.csv: edge_us: "
        "recorded on a machine, though only a bench knows the true edge time"
    )


@pytest.mark.parametrize(
    ("column", "value"), [("feed_mm_min", 0.0), ("latch_us", np.inf), ("sign", 0.5)]
)
def test_value_the_format_does_not_admit_is_not_written(
    bench: Campaign, column: str, value: float
) -> None:
    touches = Touches(**bench.touches.columns() | {column: np.full(400, value)})

    with pytest.raises(ValueError, match=f"^{column}: expected "):
        format_touches(touches)


def test_campaign_without_touches_is_not_written(bench: Campaign) -> None:
    with pytest.raises(ValueError, match="at least one touch"):
        format_touches(bench.touches.select(slice(0)))


def test_zero_is_written_without_a_sign(bench: Campaign) -> None:
    touches = replace(bench.touches, deviation_um=np.full(400, -0.0001)).select(slice(1))

    assert format_touches(touches).endswith(",0.000,ok\n")


def test_files_are_written_one_by_one(bench: Campaign, tmp_path: Path) -> None:
    write_nominal(tmp_path / "nominal.toml", bench.nominal)
    write_touches(tmp_path / "touches.csv", bench.touches)

    assert read_campaign(tmp_path).nominal == bench.nominal


def test_table_of_columns_is_that_of_the_arrays() -> None:
    beside_them = ["session_names", "thermometers"]
    assert [*COLUMNS, *beside_them] == list(Touches.__dataclass_fields__)
