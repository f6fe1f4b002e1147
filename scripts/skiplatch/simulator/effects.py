"""The simulator's table of effects, and effects switched on."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from numbers import Real

from skiplatch.former_names import PRESENT, present_names
from skiplatch.simulator.library import CData, SimulationError, connection
from skiplatch.span import ALWAYS, Span


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of an effect; `low` and `high` are the range that makes sense."""

    name: str
    unit: str
    meaning: str
    low: float
    high: float

    @property
    def when_unset(self) -> float:
        """What it is where nothing is given: 0, or the nearest admitted value."""
        return min(max(0.0, self.low), self.high)

    @property
    def expected(self) -> str:
        """Say which values there are."""
        return f"expected a number from {self.low:g} to {self.high:g}"

    def admits(self, value: object) -> bool:
        """Tell whether it is a number within the range; NaN is not."""
        return isinstance(value, Real) and self.low <= float(value) <= self.high


@dataclass(frozen=True, slots=True)
class EffectDescription:
    """A row of the simulator's table of effects, ``host_sim/effects/table.c``."""

    index: int
    id: str
    stage: str
    paths: str
    """``both``, ``skip`` or ``plc``."""
    physics: str
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True, slots=True)
class Effect:
    """An effect switched on. Former names of parameters become the present ones.

    Attributes:
        id: Its name in the table, which ``skiplatch effects`` prints.
        parameters: Values by name, in the units of the table. One that is not given is 0, or the
            admitted value nearest to it.
        span: The touches at which it acts: `span.since` is the first and `span.until` the last,
            each None for no end. Without it: all.
    """

    id: str
    parameters: Mapping[str, float]
    span: Span = ALWAYS

    def __post_init__(self) -> None:
        if self.parameters.keys() & PRESENT.keys():
            object.__setattr__(self, "parameters", present_names(self.parameters))


@cache
def effects() -> Mapping[str, EffectDescription]:
    """Give the table of all effects by id, in the order of the chain."""
    ffi, library = connection()
    rows: dict[str, EffectDescription] = {}
    while row := library.sim_effect_describe(len(rows)):
        described = _description(ffi, len(rows), row)
        rows[described.id] = described
    return rows


def _description(ffi: CData, index: int, row: CData) -> EffectDescription:
    def text(value: CData) -> str:
        return str(ffi.string(value).decode())

    parameters = tuple(
        Parameter(text(p.name), text(p.unit), text(p.meaning), p.low, p.high)
        for p in row.parameters
        if p.name
    )
    return EffectDescription(
        index, text(row.id), text(row.stage), text(row.paths), text(row.physics), parameters
    )


def parameter_of(effect_id: str, name: str) -> Parameter:
    """Give a parameter of an effect by its name."""
    return next(p for p in effects()[effect_id].parameters if p.name == name)


def refuse_unknown(effect: Effect) -> None:
    """Raise if the table does not know an effect, a parameter of it, or a value of that.

    Raises:
        SimulationError: It does not.
    """
    if effect.id not in effects():
        raise SimulationError(f"{effect.id}: no such effect")
    known = {parameter.name: parameter for parameter in effects()[effect.id].parameters}
    for name, value in effect.parameters.items():
        if name not in known:
            raise SimulationError(f"{effect.id}: no parameter {name}")
        if not known[name].admits(value):
            raise SimulationError(f"{effect.id}.{name}: {known[name].expected}, got {value!r}")
