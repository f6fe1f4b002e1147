"""Put the pages of the site together: ``site_pages.py PAGES MAN``, in the project's folder.

PAGES gets docs/ and the project's own pages, and reference pages of what the code says of itself:
commands, effects, headers of the HAL. MAN gets a page for man for each command. Links to files that
are no pages become plain text, pictures and notebooks of docs/ are copied.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

import skiplatch
from skiplatch.cli import group

if TYPE_CHECKING:
    from collections.abc import Iterator

START = "README.md"
OWN = (START, "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")
PICTURE = re.compile(r"(!\[[^\]]*\])\(docs/([\w.]+\.svg)\)")
SHOWN = (".md", ".ipynb")
"""What is in the site, the notebook as a file to take."""
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#\s]*)(#[^)\s]*)?\)")
ELSEWHERE = ("http:", "https:", "mailto:")
STYLE = """.md-typeset table:not([class]) { display: block; overflow-x: auto; }
.md-typeset :not(pre, td, th) > code { overflow-wrap: anywhere; }
.md-typeset table code { overflow-wrap: normal; word-break: normal; }
.md-typeset table:not([class]) td:has(br) { min-width: 14rem; }
.md-nav .md-nav__title { color: var(--md-default-fg-color); }
[data-md-color-scheme="slate"][data-md-color-primary] { --md-typeset-a-color: #7ba6f2;
  --md-code-hl-number-color: #f0877a; --md-code-hl-constant-color: #ab9df0; }
"""
CODE = re.compile(r"`[^`\n]+`")


def relinked(text: str, folder: Path) -> str:
    """Point links at the pages of the site, all in one folder.

    Raises:
        ValueError: A link leads nowhere.
    """

    def link(found: re.Match[str]) -> str:
        words, target, anchor = found[1], found[2], found[3] or ""
        if not target or target.startswith(ELSEWHERE):
            return found[0]
        path = (folder / target).resolve()
        if not path.exists():
            raise ValueError(f"link to {target}, which is not there")
        known = path.relative_to(Path.cwd())
        is_page = known.parent == Path("docs") or str(known) in OWN
        name = "index.md" if str(known) == START else known.name
        return f"[{words}]({name}{anchor})" if is_page and known.suffix in SHOWN else words

    return LINK.sub(link, PICTURE.sub(r"\1(\2)", text))


def barred(text: str) -> str:
    """Take the backslash off a bar within code in a table, which GitHub wants and MkDocs shows."""
    lines = (
        CODE.sub(lambda code: code[0].replace(r"\|", "|"), line) if line[:1] == "|" else line
        for line in text.splitlines(keepends=True)
    )
    return "".join(lines)


def copied() -> list[Path]:
    """Give the files of docs/ that go into the site as they are."""
    return [path for pattern in ("*.svg", "*.ipynb") for path in Path("docs").glob(pattern)]


def written_pages() -> Iterator[tuple[str, str]]:
    """Give the pages that people wrote."""
    for path in (*map(Path, OWN), *sorted(Path("docs").glob("*.md"))):
        name = "index.md" if str(path) == START else path.name
        try:
            yield name, barred(relinked(path.read_text(encoding="utf-8"), path.parent))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from error


def leaves(command: click.Command, context: click.Context) -> Iterator[click.Context]:
    """Give the context of a command and of all below it."""
    yield context
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            if inner is not None:
                yield from leaves(inner, click.Context(inner, info_name=name, parent=context))


def commands() -> list[click.Context]:
    """Give all commands, ``skiplatch`` itself first."""
    return list(leaves(group, click.Context(group, info_name="skiplatch", max_content_width=88)))


def commands_page() -> str:
    """Give what --help prints of each command."""
    shown = (f"## {one.command_path}\n\n```text\n{one.get_help()}\n```" for one in commands())
    return "\n\n".join(["# Commands\n\nWhat `--help` prints of each.", *shown]) + "\n"


def effects_page() -> str:
    """Give the table of effects."""
    table = subprocess.run(
        [sys.executable, "-m", "skiplatch", "effects", "--markdown"],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    head = (
        "# Effects\n\nWhat `skiplatch effects --markdown` prints. [GAP.md](GAP.md) explains them."
    )
    return f"{head}\n\n{table}"


def hal_page() -> str:
    """Give the headers of the HAL, which are its contract."""
    head = (
        "# HAL\n\nThe headers in `hal/include`. [PORTING.md](PORTING.md) says how to supply them."
    )
    shown = (
        f"## {header.name}\n\n```c\n{header.read_text(encoding='utf-8')}```"
        for header in sorted(Path("hal/include").glob("*.h"))
    )
    return "\n\n".join([head, *shown]) + "\n"


def roff(text: str) -> str:
    """Give text as roff shows it unchanged."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", escaped, flags=re.MULTILINE)


def man_page(context: click.Context) -> str:
    """Give the page of a command, section 1: its --help as it stands."""
    name = context.command_path.replace(" ", "-")
    short = context.command.get_short_help_str(limit=100)
    return (
        f'.TH "{name.upper()}" 1 "" "skiplatch {skiplatch.__version__}"\n'
        f".SH NAME\n{roff(name)} \\- {roff(short)}\n.SH DESCRIPTION\n.nf\n"
        f"{roff(context.get_help())}\n.fi\n"
    )


def write(folder: Path, pages: dict[str, str]) -> None:
    """Make the folder anew with these files."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")


def main() -> int:
    """Write both folders."""
    pages, man = map(Path, sys.argv[1:])
    made = {
        "commands.md": commands_page(),
        "effects.md": effects_page(),
        "hal.md": hal_page(),
        "site.css": STYLE,
        **{path.name: path.read_text(encoding="utf-8") for path in copied()},
    }
    try:
        write(pages, dict(written_pages()) | made)
    except ValueError as error:
        print(f"site_pages: {error}", file=sys.stderr)
        return 1
    manual = commands()
    write(man, {f"{one.command_path.replace(' ', '-')}.1": man_page(one) for one in manual})
    return 0


if __name__ == "__main__":
    sys.exit(main())
