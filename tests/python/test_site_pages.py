"""The pages of the site: links lead somewhere, all pages are in its contents, man shows --help."""

import re
import shutil
import subprocess
from pathlib import Path

import click
import pytest

import site_pages
from browser import browser, chromium
from skiplatch import cli
from skiplatch.commands import columns
from test_figures import READABLE, contrast

ROOT = Path(__file__).parents[2]
GROUND_OF_DARK_CODE = "#272a35"
"""As the theme's scheme slate has it."""


@pytest.fixture(autouse=True)
def in_project(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


def test_links_point_at_pages_of_the_site() -> None:
    text = (
        "[a](docs/WITHHELD.md#add-an-effect) [b](README.md) [c](Makefile) [d](#e) [f](https://g.h)"
    )

    said = site_pages.relinked(text, Path())

    assert said == "[a](WITHHELD.md#add-an-effect) [b](index.md) c [d](#e) [f](https://g.h)"


def test_a_notebook_is_in_the_site_and_linked() -> None:
    said = site_pages.relinked("[first](first_diagnosis.ipynb)", Path("docs"))

    assert said == "[first](first_diagnosis.ipynb)"
    assert Path("docs/first_diagnosis.ipynb") in site_pages.copied()


@pytest.mark.parametrize("width_px", [400, 1280])
def test_names_in_tables_stay_whole_and_tables_scroll(width_px: int, tmp_path: Path) -> None:
    if (program := chromium()) is None:
        pytest.skip("chromium is not installed: scripts/setup/system.sh test")
    name = "deviation_beyond_stamp_um_and_more_of_it"
    row = f"<td><code>{name}</code></td>" * 5
    text = f"<p><code>{'x' * 300}</code></p><table><tr>{row}</tr></table>"
    theirs = ".md-typeset code { word-break: break-word; }"
    (tmp_path / "page.html").write_text(
        f"<style>{theirs}{site_pages.STYLE}</style><article class=md-typeset>{text}</article>"
    )

    with browser(program, tmp_path / "profile") as page:
        page.open(tmp_path / "page.html", "light", width_px)
        lines = page.evaluate("document.querySelector('td code').getClientRects().length")
        beyond_px = page.evaluate(
            "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        )
        scrolls = page.evaluate(
            "(t => t.scrollWidth > t.clientWidth)(document.querySelector('table'))"
        )

    assert lines == 1
    assert beyond_px == 0
    assert scrolls


def test_pictures_stand_beside_the_pages() -> None:
    assert site_pages.relinked("![a](docs/latch.svg)", Path()) == "![a](latch.svg)"


def test_bar_within_code_of_a_table_has_no_backslash_in_the_site() -> None:
    row = r"| `a \| b` | c \| d |"

    assert site_pages.barred(f"{row}\n`a \\| b`\n") == "| `a | b` | c \\| d |\n`a \\| b`\n"
    shown = dict(site_pages.written_pages())["STATUSES.md"]
    assert "`skiplatch effects | head -1`" in shown


def test_site_goes_with_the_system_until_a_reader_chooses() -> None:
    theme = Path("scripts/mkdocs.yml").read_text()

    media = re.findall(r'media: "(.*)"', theme)

    assert media[0] == "(prefers-color-scheme)"  # what comes first counts for who has not chosen
    assert media[1:] == ["(prefers-color-scheme: light)", "(prefers-color-scheme: dark)"]


def test_links_and_code_stand_out_from_the_dark_ground_of_code() -> None:
    colours = re.findall(r"--[\w-]+: (#[0-9a-f]{6})", site_pages.STYLE)

    assert len(colours) == 3
    assert min(contrast(colour, GROUND_OF_DARK_CODE) for colour in colours) >= READABLE


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
