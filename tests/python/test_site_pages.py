"""The pages of the site: links lead somewhere, all pages are in its contents, man shows --help."""

import re
import shutil
import subprocess
from pathlib import Path

import click
import pytest

import site_pages
from skiplatch import cli
from skiplatch.commands import columns

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def in_project(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


def test_links_point_at_pages_of_the_site() -> None:
    text = (
        "[a](docs/WITHHELD.md#add-an-effect) [b](README.md) [c](Makefile) [d](#e) [f](https://g.h)"
    )

    said = site_pages.relinked(text, Path())

    assert said == "[a](WITHHELD.md#add-an-effect) [b](index.md) c [d](#e) [f](https://g.h)"


def test_pictures_stand_beside_the_pages() -> None:
    assert site_pages.relinked("![a](docs/latch.svg)", Path()) == "![a](latch.svg)"


def test_a_link_that_leads_nowhere_is_refused() -> None:
    with pytest.raises(ValueError, match=r"link to NONE\.md, which is not there"):
        site_pages.relinked("[a](NONE.md)", Path("docs"))


def test_every_page_is_in_the_contents() -> None:
    listed = set(re.findall(r": ([\w.]+\.md)$", Path("scripts/mkdocs.yml").read_text(), re.M))
    written = {name for name, _ in site_pages.written_pages()}

    assert listed == written | {"commands.md", "effects.md", "hal.md"}


def test_man_shows_the_help_as_it_stands(tmp_path: Path) -> None:
    if shutil.which("man") is None:
        pytest.skip("no man here")
    found = click.Context(
        columns.command, info_name="columns", parent=click.Context(cli.group, info_name="skiplatch")
    )
    (tmp_path / "page.1").write_text(site_pages.man_page(found))

    words = ["man", "--warnings", "-E", "UTF-8", "-l", str(tmp_path / "page.1")]
    shown = subprocess.run(words, capture_output=True, text=True, check=True)

    assert shown.stderr == ""
    plain = re.sub(r".\x08", "", shown.stdout)
    assert "skiplatch-columns" in plain
    for line in found.get_help().splitlines():
        assert line.strip() in plain
