"""Bad input of ``skiplatch compensate``: named with its place, exit status 2, nothing written."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner

from refusals import Program, refusal
from seat_probe import OMP40, radii, write_radii, write_speeds
from skiplatch import cli
from skiplatch.compensation import probe_map
from skiplatch.compensation.probe_map import MOST_DIRECTIONS, read_map
from skiplatch.errors import CampaignWarning

Edit = Callable[[list[str]], list[str]]
V0, TAU = "50", "12.68"


@pytest.fixture
def radii_csv(tmp_path: Path) -> Path:
    return write_radii(tmp_path / "radii.csv", radii(OMP40, 50.0, 12.68, runs=2, sigma_um=0.1))


@pytest.fixture
def speeds_csv(tmp_path: Path) -> Path:
    return write_speeds(tmp_path / "speeds.csv", 12.68, sigma_um=0.1)


def edit(path: Path, change: Edit) -> None:
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")


def without(*starts: str) -> Edit:
    return lambda lines: [line for line in lines if not line.startswith(starts)]


def only(*starts: str) -> Edit:
    return lambda lines: [line for line in lines if line.startswith(("alpha", "feed", *starts))]


def line(number: int, text: str) -> Edit:
    return lambda lines: [*lines[: number - 1], text, *lines[number:]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (only("0,0,", "30,0,", "60,0,"), "radii.csv:2: alpha_deg: too few directions"),
        (without("120,0,"), "radii.csv:8: alpha_deg: a gap in the map: no direction for 60 deg"),
        (
            without(*(f"{a},40," for a in range(0, 360, 30))),
            "no direction for 20 deg of beta from alpha 330, beta 30 on",
        ),
        (without("120,30,2"), "run: a gap in the map: alpha 120, beta 30 has no run 2"),
        (line(5, "30,0,2,nan"), 'radii.csv:5: radius_um: expected a number in µm, got "nan"'),
        (line(5, "30,0,2,"), "radii.csv:5: radius_um: expected a number in µm, got an empty cell"),
        (line(5, "30,0,2,inf"), 'radii.csv:5: radius_um: expected a number in µm, got "inf"'),
        (line(5, "400,0,2,1"), "radii.csv:5: alpha_deg: expected a number from 0 to 360"),
        (line(5, "30,95,2,1"), "radii.csv:5: beta_deg: expected a number from 0 to 90"),
        (line(5, "30,0,2"), "radii.csv:5: expected 4 cells, got 3"),
        (line(5, "30,0,1,1"), "radii.csv:5: run: this direction and run stand already in line 4"),
        (line(5, "30,0,x,1"), "radii.csv:5: run: expected a whole number"),
        (line(1, "alpha_deg,beta_deg,run,radius"), 'radii.csv:1: missing column "radius_um"'),
        (line(1, "alpha_deg,beta_deg,run,run"), 'radii.csv:1: column "run" stands twice'),
        (lambda lines: lines[:1], "radii.csv:1: expected rows after the header, got none"),
    ],
)
def test_bad_radii_are_named_with_their_place(
    radii_csv: Path,
    tmp_path: Path,
    change: Edit,
    message: str,
    refused: Program,
) -> None:
    edit(radii_csv, change)
    out = tmp_path / "table.csv"

    error = refused("compensate", radii_csv, "--v0", V0, "--tau", TAU, "--out", out)

    assert message in error
    assert not out.exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (only("100,"), "speeds.csv:2: feed_mm_min: expected several feeds, got only 100 mm/min"),
        (only("50,1,", "100,1,"), "speeds.csv:2: run: expected at least 3 runs, got 2"),
        (line(4, "50,3,nan"), 'speeds.csv:4: mean_radius_um: expected a number in µm, got "nan"'),
        (line(4, "0,3,1"), "speeds.csv:4: feed_mm_min: expected a number > 0 in mm/min"),
        (line(4, "50,2,1"), "speeds.csv:4: run: this feed and run stand already in line 3"),
    ],
)
def test_bad_speeds_are_named_with_their_place(
    radii_csv: Path,
    speeds_csv: Path,
    tmp_path: Path,
    change: Edit,
    message: str,
    refused: Program,
) -> None:
    edit(speeds_csv, change)
    out = tmp_path / "table.csv"

    error = refused("compensate", radii_csv, "--v0", V0, "--tau-from", speeds_csv, "--out", out)

    assert message in error
    assert not out.exists()


@pytest.mark.parametrize(("outside", "hint"), [(True, "or --outside?"), (False, "or --inside?")])
def test_slope_against_the_side_is_a_delay_below_zero(
    radii_csv: Path,
    tmp_path: Path,
    outside: bool,
    hint: str,
    refused: Program,
) -> None:
    speeds = write_speeds(tmp_path / "speeds.csv", 12.68, outside=outside)
    side = "--inside" if outside else "--outside"
    out = tmp_path / "table.csv"

    error = refused("compensate", radii_csv, "--v0", V0, "--tau-from", speeds, side, "--out", out)

    assert "speeds.csv: mean_radius_um: tau <= 0" in error
    assert hint in error
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--v0", "20", "--tau", TAU], "alpha 60, beta 0: "),
        (["--v0", V0, "--tau", TAU, "--max-feed", "60"], "radius_um: alpha "),
        (["--v0", V0, "--tau", TAU, "--previous", "nowhere.csv"], "nowhere.csv: cannot read"),
        (["--v0", V0, "--tau", TAU, "--after", "nowhere.csv"], "nowhere.csv: cannot read"),
        (["--v0", V0, "--tau", TAU, "--json", "no/such/o.json"], "o.json: cannot write"),
    ],
)
def test_refusal_leaves_no_file_at_all(
    radii_csv: Path,
    tmp_path: Path,
    arguments: list[str],
    message: str,
    refused: Program,
) -> None:
    before = set(tmp_path.iterdir())
    outputs = ["--header", tmp_path / "t.h", "--nc", tmp_path / "t.nc", "--out", tmp_path / "t.csv"]

    error = refused("compensate", radii_csv, *arguments, *outputs)

    assert message in error
    assert set(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tau", "0"], "'--tau': expected a number from 1e-06 to 10000, got \"0\""),
        (["--tau", "-3"], "'--tau': expected a number from 1e-06 to 10000, got \"-3\""),
        (["--tau", "nan"], "'--tau': expected a number from 1e-06 to 10000, got \"nan\""),
        ([], "expected --tau or --tau-from"),
        (["--tau", "1", "--tau-from", "s.csv"], "expected either --tau or --tau-from, not both"),
        (["--tau", "1", "--from-campaign", "d"], "expected either RADII or --from-campaign"),
        (["--tau", "1", "--target", "median"], "expected mean, max, min or a radius in µm"),
        (["--tau", "1", "--target", "nan"], "expected mean, max, min or a radius in µm"),
        (["--tau", "1", "--overtravel", "1"], "--overtravel needs --accel"),
        (["--tau-from", "s.csv", "--tau-uncertainty", "1"], "--tau-uncertainty goes with --tau"),
        (["--tau", TAU, "--nc", "x.nc", "--nc-first", "900"], "do not fit in #500 to #999"),
        (["--tau", TAU, "--nc", "t.csv"], "t.csv is named for two outputs"),
        (["--tau", TAU, "--nc", "radii.csv"], "radii.csv is an input, and would be overwritten"),
    ],
)
def test_bad_option_is_told_and_ends_with_2(
    radii_csv: Path,
    tmp_path: Path,
    arguments: list[str],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = set(tmp_path.iterdir())
    monkeypatch.chdir(tmp_path)

    result = CliRunner().invoke(
        cli.group, ["compensate", str(radii_csv), "--v0", V0, "--out", "t.csv", *arguments]
    )

    assert result.exit_code == 2
    assert message in result.output
    assert set(tmp_path.iterdir()) == before


def test_empty_file_is_told(tmp_path: Path, refused: Program) -> None:
    path = tmp_path / "radii.csv"
    path.touch()

    error = refused("compensate", path, "--v0", V0, "--tau", TAU, "--out", "t.csv")

    assert "radii.csv:1: expected a header row, got an empty file" in error


def test_unknown_column_is_warned_of_and_ignored(radii_csv: Path, tmp_path: Path) -> None:
    plain, more = tmp_path / "plain.csv", tmp_path / "more.csv"
    base = ["compensate", str(radii_csv), "--v0", V0, "--tau", TAU, "--out"]
    CliRunner().invoke(cli.group, [*base, str(plain)])
    edit(radii_csv, lambda lines: [f"note,{lines[0]}", *(f"x,{rest}" for rest in lines[1:])])

    with pytest.warns(CampaignWarning, match='unknown column "note" is ignored'):
        CliRunner().invoke(cli.group, [*base, str(more)])

    assert more.read_text() == plain.read_text()


def test_delay_that_is_lost_in_the_scatter_is_warned_of(radii_csv: Path, tmp_path: Path) -> None:
    speeds = write_speeds(tmp_path / "speeds.csv", 300.0, sigma_um=400.0)
    arguments = [str(radii_csv), "--v0", "5000", "--tau-from", str(speeds)]

    with pytest.warns(CampaignWarning, match="less than three times its standard uncertainty"):
        CliRunner().invoke(cli.group, ["compensate", *arguments, "--out", str(tmp_path / "t.csv")])


def test_delay_too_uncertain_for_a_prediction_is_told(
    radii_csv: Path,
    tmp_path: Path,
    refused: Program,
) -> None:
    out = tmp_path / "t.csv"
    delay = ["--tau", TAU, "--tau-uncertainty", "100"]

    error = refused("compensate", radii_csv, "--v0", V0, *delay, "--out", out)

    assert "tau of 12.68 ms with a standard uncertainty of 100 ms: in " in error
    assert not out.exists()


def test_few_azimuths_are_warned_of(tmp_path: Path) -> None:
    """With 60° between them all three lobes may look alike."""
    path = tmp_path / "radii.csv"
    rows = [f"{a},{b},1,{10 + b / 100}" for b in (0, 45) for a in range(0, 360, 60)]
    path.write_text("alpha_deg,beta_deg,run,radius_um\n" + "\n".join([*rows, "0,90,1,10"]) + "\n")

    with pytest.warns(CampaignWarning, match="6 azimuths at beta 0 may not show the three lobes"):
        CliRunner().invoke(
            cli.group,
            ["compensate", str(path), "--v0", V0, "--tau", TAU, "--out", str(tmp_path / "t.csv")],
        )


def test_old_outputs_stay_when_one_cannot_be_written(
    radii_csv: Path,
    tmp_path: Path,
    refused: Program,
) -> None:
    out = tmp_path / "table.csv"
    out.write_text("old")
    (tmp_path / "taken").mkdir()

    error = refused(
        "compensate", radii_csv, "--v0", V0, "--tau", TAU,
        "--out", out, "--nc", tmp_path / "absent" / "t.nc",
    )  # fmt: skip

    assert "t.nc: cannot write" in error
    assert out.read_text() == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["radii.csv", "table.csv", "taken"]


def test_table_before_must_have_the_directions_of_the_map(
    radii_csv: Path,
    tmp_path: Path,
    refused: Program,
) -> None:
    table = tmp_path / "old.csv"
    table.write_text("alpha_deg,beta_deg,feed_mm_min\n0,0,50\n")

    error = refused(
        "compensate", radii_csv, "--v0", V0, "--tau", TAU,
        "--previous", table, "--out", tmp_path / "t.csv",
    )  # fmt: skip

    assert "old.csv: no feed for alpha 30, beta 0, which the map has" in error


def test_spaces_blank_lines_a_full_turn_and_many_poles_are_taken(tmp_path: Path) -> None:
    """360° is 0°, and at the pole every azimuth is the same direction; both stay in the table."""
    path = tmp_path / "radii.csv"
    azimuths = range(30, 361, 30)
    rows = [f" {a} , {b} , 1 , {10 + b / 100}" for b in (0, 45, 90) for a in azimuths]
    path.write_text("alpha_deg, beta_deg, run, radius_um\n\n" + "\n".join(rows) + "\n")
    out = tmp_path / "t.csv"

    found = tmp_path / "o.json"

    arguments = ["--v0", V0, "--tau", TAU, "--out", str(out), "--json", str(found)]
    result = CliRunner().invoke(cli.group, ["compensate", str(path), *arguments])

    assert result.exit_code == 0, result.output
    lines = out.read_text().splitlines()
    assert [row.split(",")[:2] for row in lines[1:]] == [
        [str(a), str(b)] for b in (0, 45, 90) for a in azimuths
    ]
    assert len({row.split(",")[2] for row in lines[-12:]}) == 1
    inverse = [50.0 / float(row.split(",")[2]) for row in lines[1:]]
    expected = sum(inverse) / len(inverse) - 1.0
    assert json.loads(found.read_text())["time_increase"] == pytest.approx(expected, abs=1e-12)


def test_more_directions_than_anybody_measures_are_refused(tmp_path: Path) -> None:
    rows = [f"{n % 360},{n // 360},1,10" for n in range(MOST_DIRECTIONS + 1)]
    path = tmp_path / "radii.csv"
    path.write_text("alpha_deg,beta_deg,run,radius_um\n" + "\n".join(rows) + "\n")

    told = refusal(lambda: read_map(path, outside=False))

    assert told == f"{path}:2: alpha_deg: 4097 directions: a map has at most 4096"


def test_blocks_do_not_change_the_map(radii_csv: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    at_once = read_map(radii_csv, outside=False)
    monkeypatch.setattr(probe_map, "BLOCK_CELLS", 7 * len(at_once.cells))

    in_blocks = read_map(radii_csv, outside=False)

    assert len(at_once.cell_of) % 7 != 0
    assert in_blocks.cell_of.tolist() == at_once.cell_of.tolist()
