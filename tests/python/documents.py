"""The pages taken apart: blocks of commands, and what stands below them as their output."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import click

from skiplatch.cli import group

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.DOTALL | re.MULTILINE)
COMMANDS, OUTPUT = ("sh", "python"), ""
COMMAND = re.compile(r"^\s*(?:Example: )?(?:\.venv/bin/|python -m )?skiplatch (.+)$")
ASSIGNMENT = re.compile(r"^(\w+)='([^']*)'$", re.MULTILINE)


@dataclass(frozen=True)
class Example:
    """A block of commands, or of Python, with the output that the page shows of it, if any."""

    page: str
    language: str
    text: str
    output: str = ""

    def __str__(self) -> str:
        return f"{self.page}: {self.text.splitlines()[0]}"

    @property
    def lines(self) -> list[str]:
        """Each command in a line, what lies between backslashes put together."""
        text = self.text.replace("\\\n", " ")
        for name, value in ASSIGNMENT.findall(text):
            text = ASSIGNMENT.sub("", text).replace(f"${name}", value)
        return [line.strip() for line in text.splitlines() if line.strip()]


def examples(path: Path) -> list[Example]:
    """Give the examples of a page; a block without a language is the output of the one before."""
    found: list[Example] = []
    for _, language, text in FENCE.findall(path.read_text(encoding="utf-8")):
        if language in COMMANDS:
            found.append(Example(path.name, language, text))
        elif language == OUTPUT:
            assert found, f"{path.name}: an output without a command; is it ```text?"
            assert not found[-1].output, f"{found[-1]}: two outputs; is one ```text?"
            found[-1] = replace(found[-1], output=text)
    return found


def words_of(line: str) -> list[str]:
    """Give the words of a command behind `skiplatch`; none if it is another program's."""
    command = COMMAND.match(line)
    return shlex.split(command[1], comments=True) if command else []


def commands_in(text: str) -> Iterator[list[str]]:
    """Give the words of each command of skiplatch."""
    for line in Example("", "sh", text).lines:
        if words := words_of(line):
            yield words


def leaves(command: click.Command, name: str) -> Iterator[tuple[str, click.Command]]:
    """Give all commands by their names, groups first."""
    yield name, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for inner in command.list_commands(context):
            found = command.get_command(context, inner)
            assert found is not None
            yield from leaves(found, f"{name} {inner}")


def shown_by_help() -> list[tuple[str, list[str]]]:
    """Give the examples of each --help, with where they stand."""
    return [
        (f"{name} --help", words)
        for name, command in leaves(group, "skiplatch")
        for words in commands_in(f"{command.epilog or ''}\n{command.help or ''}")
    ]
