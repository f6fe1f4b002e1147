"""Options that describe a rig: single figures, or all from a campaign's nominal.toml."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Any

import click

from skiplatch.campaign import KEYS, Nominal, read_nominal
from skiplatch.commands.inputs import FILE
from skiplatch.commands.numbers import NumberType
from skiplatch.latch.probing import DEFAULT_RIG, on_bench
from skiplatch.played_files import all_faults_told
from skiplatch.stand_ins import refuse_unplayable


@dataclass(frozen=True, slots=True)
class RigOption:
    """A figure of the rig: the section and key of nominal.toml, and what the simulation takes."""

    section: str
    key: str
    low: float
    high: float

    @property
    def default(self) -> float:
        """The figure of the rig that is taken where none is given."""
        return float(getattr(getattr(DEFAULT_RIG, self.section), self.key))

    def add_to(self, command: Callable[..., Any], flag: str) -> Callable[..., Any]:
        """Give the command this option."""
        known = KEYS[self.section, self.key]
        option = click.option(
            flag,
            type=NumberType(self.low, self.high),
            show_default=f"{self.default:g}",
            help=f"{known.meaning[0].upper()}{known.meaning[1:]}, {known.unit}.",
        )
        return option(command)


RIG_OPTIONS: dict[str, RigOption] = {
    "--filter-us": RigOption("input", "filter_us", 0.0, 1e6),
    "--latency-us": RigOption("skip", "latency_us", 0.0, 1e6),
    "--jitter-us": RigOption("skip", "jitter_us", 0.0, 1e6),
    "--tick-us": RigOption("skip", "tick_us", 1e-3, 1e3),
    "--scan-us": RigOption("plc", "scan_us", 100.0, 20_000.0),
    "--resolution-um": RigOption("axis", "resolution_um", 1e-4, 100.0),
    "--accel": RigOption("axis", "accel_mm_s2", 1.0, 1e6),
}


def rig_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options, and hand it what they describe as ``rig``."""

    @wraps(command)
    def with_rig(*args: Any, nominal_path: Path | None, **values: Any) -> Any:  # noqa: ANN401
        rig = DEFAULT_RIG if nominal_path is None else _on_bench(nominal_path)
        for flag, option in RIG_OPTIONS.items():
            value = values.pop(flag.removeprefix("--").replace("-", "_"))
            if value is not None:
                section = replace(getattr(rig, option.section), **{option.key: value})
                rig = replace(rig, **{option.section: section})
        if nominal_path is not None:
            refuse_unplayable(nominal_path, rig)
        return command(*args, rig=rig, **values)

    described: Callable[..., Any] = _nominal_option(with_rig)
    for flag, option in reversed(RIG_OPTIONS.items()):
        described = option.add_to(described, flag)
    return described


def _on_bench(path: Path) -> Nominal:
    """Read a rig and take its probe away, whose figures are not played."""
    with all_faults_told(path, as_played=on_bench):
        return on_bench(read_nominal(path))


def rig_json(rig: Nominal) -> dict[str, float]:
    """Give the rig's figures by option, without the dashes."""
    return {
        option.key: float(getattr(getattr(rig, option.section), option.key))
        for option in RIG_OPTIONS.values()
    }


_nominal_option = click.option(
    "--nominal",
    "nominal_path",
    type=FILE,
    help="Take the rig from this nominal.toml, without its probe; the options above overrule it.",
)
