"""docs/CAMPAIGN.md and the commands that print its tables."""

import json
from pathlib import Path

from click.testing import CliRunner

from skiplatch.campaign import COLUMNS, KEYS, read_nominal
from skiplatch.campaign.reference import columns_table, keys_table
from skiplatch.cli import group

DOCUMENT = Path(__file__).parents[2] / "docs" / "CAMPAIGN.md"


def run(*arguments: str) -> str:
    result = CliRunner().invoke(group, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_document_has_the_tables_of_the_code() -> None:
    text = DOCUMENT.read_text()

    assert f"\n\n{columns_table()}\n" in text, "paste what 'skiplatch columns' prints"
    assert f"\n\n{keys_table()}\n" in text, "paste what 'skiplatch columns --nominal' prints"


def test_commands_print_the_tables(tmp_path: Path) -> None:
    assert run("columns") == columns_table()
    assert run("columns", "--nominal", "--json", str(tmp_path / "c.json")) == keys_table()

    tables = json.loads((tmp_path / "c.json").read_text())
    assert tables["keys"].keys() == {".".join(key) for key in KEYS}
    assert tables["columns"].keys() == {*COLUMNS, "time", "temp_NAME_c"}
    assert [name for name, c in tables["columns"].items() if c["required"]] == ["touch"]


def test_every_column_and_key_says_what_is_lost_and_gives_an_example() -> None:
    assert all(column.example and column.lost for column in COLUMNS.values())
    assert all(key.lost for key in KEYS.values())


def test_example_of_the_document_is_read(tmp_path: Path) -> None:
    examples = [part.split("```")[0] for part in DOCUMENT.read_text().split("```toml\n")[1:]]

    (tmp_path / "nominal.toml").write_text("\n".join(examples))

    nominal = read_nominal(tmp_path / "nominal.toml")
    assert nominal.uncertainty == {("probe", "delay_us"): 50.0}
    assert nominal.believed_effects[0].uncertainty == {"backlash_um": 0.5}
