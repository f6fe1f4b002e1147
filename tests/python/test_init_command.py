"""``skiplatch init``: a nominal.toml to begin with."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from refusals import Program
from skiplatch.campaign import KEYS, read_nominal
from skiplatch.cli import group
from skiplatch.importing.presets import PRESETS


def run(*arguments: object) -> str:
    result = CliRunner().invoke(group, ["init", *map(str, arguments)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.mark.parametrize("preset", PRESETS)
def test_preset_is_read_back_with_its_figures(tmp_path: Path, preset: str) -> None:
    run("--preset", preset, "--out", tmp_path / "nominal.toml")

    nominal = read_nominal(tmp_path / "nominal.toml")
    figures = PRESETS[preset].figures
    assert nominal.kind is PRESETS[preset].kind
    assert {key: nominal.number(*key) for key in figures} == {
        k: f.value for k, f in figures.items()
    }
    assert nominal.uncertainty == {k: f.u for k, f in figures.items() if f.u is not None}
    assert nominal.unknown == KEYS.keys() - figures.keys()


def test_every_key_stands_there_with_its_meaning_and_each_figure_with_its_source() -> None:
    text = run("--preset", "klipper")

    assert all(f"{name} = " in text for _, name in KEYS)
    joined = " ".join(line.removeprefix("# ") for line in text.splitlines())
    assert all(key.meaning in joined for key in KEYS.values())
    assert all(figure.source in joined for figure in PRESETS["klipper"].figures.values())


def test_presets_are_listed() -> None:
    assert [line.split()[0] for line in run().splitlines()] == list(PRESETS)


def test_a_file_without_a_preset_is_refused(tmp_path: Path) -> None:
    result = CliRunner().invoke(group, ["init", "--out", str(tmp_path / "nominal.toml")])

    assert result.exit_code == 2
    assert result.stderr.endswith("Error: --out needs --preset\n")


def test_file_that_is_there_is_kept(tmp_path: Path, refused: Program) -> None:
    (tmp_path / "nominal.toml").write_text("mine")

    said = refused("init", "--preset", "bench", "--out", tmp_path / "nominal.toml")

    assert said.endswith("nominal.toml: exists already\n")
    assert (tmp_path / "nominal.toml").read_text() == "mine"


def test_json_says_what_was_written(tmp_path: Path) -> None:
    out = tmp_path / "nominal.toml"
    run("--preset", "grbl-avr", "--out", out, "--json", tmp_path / "said.json")

    said = json.loads((tmp_path / "said.json").read_text())
    assert (said["out"], said["preset"], said["kind"]) == (str(out), "grbl-avr", "machine")
    nominal = read_nominal(out)
    assert said["figures"].keys() == {".".join(key) for key in KEYS.keys() - nominal.unknown}
    assert all(nominal.number(*k.split(".")) == f["value"] for k, f in said["figures"].items())
    assert said["figures"]["skip.jitter_us"]["u"] == 10.0
    assert all(figure["source"] for figure in said["figures"].values())


def test_json_lists_the_presets(tmp_path: Path) -> None:
    run("--json", tmp_path / "presets.json")

    listed = json.loads((tmp_path / "presets.json").read_text())["presets"]
    assert [one["preset"] for one in listed] == list(PRESETS)


def test_nothing_is_written_beside_a_file_that_is_kept(tmp_path: Path, refused: Program) -> None:
    out = tmp_path / "nominal.toml"
    out.write_text("mine")

    refused("init", "--preset", "bench", "--out", out, "--json", tmp_path / "said.json")

    assert not (tmp_path / "said.json").exists()


def moves_down(path: Path, count: int = 120) -> None:
    """Write conditions of touches along Z alone, at one feed."""
    rng = np.random.default_rng(1)
    time_s = np.cumsum(rng.uniform(3.0, 8.0, count))
    approach_mm, position_mm = rng.uniform(2.0, 5.0, count), rng.uniform(-60.0, 0.0, count)
    rows = [
        f"{k},{time_s[k]:.4f},skip,Z,-1,100,{approach_mm[k]:.3f},{position_mm[k]:.3f},,,,,"
        for k in range(count)
    ]
    head = "touch,time_s,path,axis,sign,feed_mm_min,approach_mm,position_mm"
    outcomes = "edge_us,latch_us,report_us,deviation_um,status"
    path.write_text("\n".join([f"{head},{outcomes}", *rows, ""]))


@pytest.mark.long
@pytest.mark.parametrize("preset", PRESETS)
def test_a_sound_rig_of_a_preset_has_no_gap(tmp_path: Path, preset: str) -> None:
    """Of grbl's, whose reports come at once, an effect of less than a nanosecond made one."""
    nominal, moves, sound = (tmp_path / name for name in ("nominal.toml", "moves.csv", "sound"))
    run("--preset", preset, "--out", nominal)
    moves_down(moves)
    played = ["simulate", "--nominal", nominal, "--conditions", moves, "--out", sound]
    told = ["diagnose", sound, "--seed", "1", "--json", tmp_path / "found.json"]
    for words in (played, told):
        result = CliRunner().invoke(group, [*map(str, words)], catch_exceptions=False)
        assert result.exit_code == 0, result.output

    assert json.loads((tmp_path / "found.json").read_text())["verdict"] == "no_gap"
