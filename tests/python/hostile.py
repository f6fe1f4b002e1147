"""Files that nobody means, and every place of the command line that takes a file."""

import os
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import click

from skiplatch.cli import group

SAMPLES = Path(__file__).parents[2] / "scripts" / "samples"
CAMPAIGN = SAMPLES / "bench_isr_latency"
KINEMATICS = SAMPLES / "kinematics"
LOGS = Path(__file__).parent / "data" / "logs"
NOTHING_FOUND = Path(__file__).parent / "data" / "nothing_found.json"
IMPORTED = {
    "linuxcnc": "linuxcnc_probe.txt",
    "grbl": "grbl_serial.log",
    "klipper": "klippy.log",
    "marlin": "marlin_m48.log",
    "edges": "capture.vcd",
    "can": "bus.log",
    "iso230": "iso230_x.csv",
    "mdf": "bench.mf4",
}
"""A log for each kind of import; that of a bus and that in MDF are not there, and so refused."""
DEEP = 100_000


def _text(text: str) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(text.encode())


def _bytes(data: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(data)


def _sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(1 << 40)


def _loop(path: Path) -> None:
    path.symlink_to(path)


HOSTILE: dict[str, Callable[[Path], object]] = {
    "missing": lambda _: None,
    "empty": _text(""),
    "folder": Path.mkdir,
    "fifo": os.mkfifo,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "link to itself": _loop,
    "a terabyte": _sparse,
    "zeros": _bytes(bytes(4096)),
    "no UTF-8": _bytes(b"\xff\xfe\x00a" * 64),
    "mark alone": _bytes(b"\xef\xbb\xbf"),
    "one long line": _text("9" * 200_000),
    "long dotted key": _text("a." * 30_000 + "b = 1\n"),
    "deep list": _text("[" * DEEP),
    "deep value": _text("a = " + "[" * 900 + "]" * 900),
    "deep object": _text('{"a":' * DEEP + "1" + "}" * DEEP),
    "a number": _text("17"),
    "a list": _text("[[], {}, null]"),
    "huge numbers": _text('{"format": 1e999, "x": ' + "9" * 5000 + "}"),
    "null values": _text('{"format": null, "effects": null, "parts": {"a": null}}'),
    "quotes": _text('"a,b\n"c""'),
    "controls": _bytes(bytes(range(32)) * 32),
    "not a picture": _bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + bytes(64)),
    "packed": _bytes(b"\x1f\x8b\x08\x00" + bytes(64)),
}


@dataclass(frozen=True, slots=True)
class Place:
    """One parameter of one command that takes a path.

    Attributes:
        command: Words of the command.
        option: Its longest name; None for an argument.
        index: Place among the arguments.
        is_output: It is written to.
        ending: Of the file's name.
    """

    command: tuple[str, ...]
    option: str | None
    index: int
    is_output: bool
    ending: str = ""

    def __str__(self) -> str:
        words = (*self.command, self.option or f"argument {self.index + 1}", self.ending)
        return " ".join(filter(None, words))


ENDINGS: dict[tuple[str, ...], tuple[str, ...]] = {
    ("import", "can"): (".log", ".asc", ".blf", ".csv", ".db", ".mf4", ".trc", ".log.gz"),
    ("import", "edges"): (".csv", ".vcd", ".sr"),
}
"""Of commands that go by the ending of a file."""

WRITTEN = {
    *("--out", "--json", "--html", "--pictures", "--picture", "--header", "--nc"),
    *("--record", "--corrected", "--points", "--junit", "--metrics"),
}
"""Options that name what is written; any other is read, new ones too."""


def commands(
    command: click.Command = group, words: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    """Give every command that does something, and its words."""
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            assert inner is not None
            yield from commands(inner, (*words, name))
    else:
        yield words, command


def places() -> list[Place]:
    """Find every parameter of every command that takes a path."""
    found = []
    for words, command in commands():
        arguments = [p for p in command.params if isinstance(p, click.Argument)]
        for parameter in command.params:
            if isinstance(parameter.type, click.Path):
                is_option = isinstance(parameter, click.Option)
                option = max(parameter.opts, key=len) if is_option else None
                index = arguments.index(parameter) if isinstance(parameter, click.Argument) else -1
                is_output = option in WRITTEN
                endings = ("",) if is_output else ENDINGS.get(words, ("",))
                found += [Place(words, option, index, is_output, ending) for ending in endings]
    return found


def base(command: tuple[str, ...], out: Path) -> tuple[list[str], dict[str, str]]:
    """Give arguments and options that call a command the cheap way; KeyError for an unknown one."""
    nominal = str(CAMPAIGN / "nominal.toml")
    conditions = str(CAMPAIGN / "touches.csv")
    points = str(KINEMATICS / "points.csv")
    nothing_found = str(NOTHING_FOUND)
    written = str(out)
    known: dict[tuple[str, ...], tuple[list[str], dict[str, str]]] = {
        ("latch",): ([], {"--touches": "10"}),
        ("simulate",): (
            [],
            {"--nominal": nominal, "--conditions": conditions, "--out": written},
        ),
        ("check",): ([str(CAMPAIGN)], {}),
        ("columns",): ([], {}),
        ("compare",): ([str(CAMPAIGN)], {}),
        ("diagnose",): ([str(CAMPAIGN)], {}),
        ("predict",): ([str(CAMPAIGN)], {"--conditions": conditions, "--out": written}),
        ("adopt",): ([str(CAMPAIGN)], {"--diagnosis": nothing_found, "--out": written}),
        ("design",): ([str(CAMPAIGN)], {"--out": written}),
        ("settle",): ([str(CAMPAIGN), str(CAMPAIGN)], {}),
        ("effects",): ([], {}),
        ("transmission",): (
            [points],
            {"--lines1": "100", "--lines2": "100", "--ratio": "1"},
        ),
        ("plan",): ([], {"--path": "skip", "--uncertainty-um": "5"}),
        ("pretravel",): ([], {"--rig": "A"}),
        ("compensate",): ([points], {"--v0": "0.5", "--out": written}),
        ("kinematics", "fit"): ([points], {"--machine": str(KINEMATICS / "machine_bc.toml")}),
        ("kinematics", "probing"): ([points], {}),
        ("kinematics", "run"): (
            [str(KINEMATICS / "save_and_check.h")],
            {"--memory": f"{written}.bin", "--html": f"{written}.html"},
        ),
        ("bench", "believe"): ([str(CAMPAIGN)], {"--out": written}),
        ("bench", "monitor"): (
            ["hostile"],
            {"--can-backend": "virtual", "--seconds": "0.01", "--quiet-injector": ""},
        ),
        ("bench", "run"): (
            [str(SAMPLES / "plans" / "nominal.toml")],
            {"--out": written, "--can": "none", "--attached": ""},
        ),
        ("fleet", "add"): ([str(CAMPAIGN)], {"--store": written}),
        ("fleet", "list"): ([], {"--store": written}),
        ("fleet", "show"): (["bench"], {"--store": written}),
        ("fleet", "query"): (["SELECT 1"], {"--store": written}),
        ("fleet", "check"): ([], {"--store": written}),
        ("fleet", "report"): ([], {"--store": written, "--html": f"{written}.html"}),
        ("fleet", "watch"): (
            [str(SAMPLES)],
            {"--store": written, "--settle-s": "1e9", "--once": ""},
        ),
        ("fleet", "export"): (["bench"], {"--store": written, "--out": f"{written}.new"}),
        ("fleet", "remove"): (["bench"], {"--store": written}),
        ("fleet", "verify"): ([], {"--store": written}),
        ("demo",): ([], {"--out": written}),
        ("init",): ([], {"--preset": "bench", "--out": written}),
        ("repeat",): ([str(CAMPAIGN)], {}),
        ("kinematics", "sphere"): ([points], {}),
        ("import", "csv"): (
            [str(LOGS / "table.csv")],
            {"--map": "deviation_um=Error [mm]", "--out": written},
        ),
        **{
            ("import", kind): ([str(LOGS / log)], {"--out": written})
            for kind, log in IMPORTED.items()
        },
    }
    return known[command]


def call(place: Place, path: Path, out: Path) -> list[str]:
    """Give the command line that takes the path at that place."""
    arguments, options = base(place.command, out)
    if place.option is None:
        arguments = [*arguments]
        arguments[place.index] = str(path)
    else:
        options = {**options, place.option: str(path)}
        if place.option == "--from-campaign":
            arguments = []
    words = [word for pair in options.items() for word in pair if word]
    return [*place.command, *words, *arguments]


def make(kind: str, folder: Path, ending: str = "") -> Path:
    """Make the hostile file of that kind."""
    path = folder / f"hostile{ending}"
    HOSTILE[kind](path)
    return path
