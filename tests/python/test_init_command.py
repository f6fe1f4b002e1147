"""``skiplatch init``: a nominal.toml to begin with."""

import json
from pathlib import Path

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
