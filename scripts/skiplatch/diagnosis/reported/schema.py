"""What may stand in the document of a diagnosis: one rule for all that read one.

A key that no version wrote is left alone, and one that not every version wrote may be missing; what
is there has to be as the table says, whether or not a command reads it.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import NoReturn, TypeVar

from skiplatch.campaign.constraints import LARGEST
from skiplatch.diagnosis.verdict.verdict import Verdict
from skiplatch.errors import InputError, hint, one_line, quoted, shortened
from skiplatch.files import Json, read_json
from skiplatch.former_names import renewed
from skiplatch.simulator.effects import effects

FORMAT = "skiplatch-diagnosis/2"
FORMATS = ("skiplatch-diagnosis/1", FORMAT)
"""Those that can be read."""
LIMITS = f"from {-LARGEST:g} to {LARGEST:g}"

Taken = TypeVar("Taken")
Check = Callable[[str, Json], None]
"""Raises ValueError for a value, given the path of its key."""


def whole(document: Json, *needed: str) -> dict[str, Json]:
    """Give the document of a diagnosis, by the present names of parameters.

    Args:
        document: Of a file, or made by hand.
        *needed: Paths of keys that have to be there besides; a ``*`` is every key or entry.

    Raises:
        ValueError: With the path of the key and what was expected there.
    """
    if not isinstance(document, dict) or document.get("format") not in FORMATS:
        raise ValueError(f'expected a diagnosis of the format "{FORMAT}"')
    try:
        present: dict[str, Json] = renewed(document)
    except RecursionError as error:
        raise ValueError("nested too deeply for a diagnosis") from error
    DOCUMENT("", present)
    for path in needed:
        _need("", present, path.split("."))
    return present


def read_diagnosis_json(path: Path, take: Callable[[Json], Taken]) -> Taken:
    """Read the document of a diagnosis.

    Args:
        path: The file.
        take: What is made of the document; raises ValueError where that cannot be.

    Raises:
        InputError: The file cannot be read, or not be taken.
    """
    document = read_json(path)
    try:
        return take(document)
    except ValueError as error:
        raise InputError(path, None, None, str(error)) from error


def need_intervals(document: dict[str, Json]) -> None:
    """Refuse a whole diagnosis in which a parameter of an effect has no interval.

    Raises:
        ValueError: With the path of the key.
    """
    for index, entry in enumerate(document["effects"]):
        for name in entry["params"]:
            _need(f"effects[{index}]", entry, ["intervals", name])


def _need(where: str, value: Json, parts: list[str]) -> None:
    if not parts:
        return
    if parts[0] == "*":
        for place, inner in _entries(where, value):
            _need(place, inner, parts[1:])
    elif parts[0] not in value:
        raise ValueError(f"{key_path(where, parts[0])}: missing from the diagnosis")
    else:
        _need(key_path(where, parts[0]), value[parts[0]], parts[1:])


def _entries(where: str, value: Json) -> Iterator[tuple[str, Json]]:
    if isinstance(value, list):
        yield from ((f"{where}[{index}]", inner) for index, inner in enumerate(value))
    else:
        yield from ((key_path(where, name), inner) for name, inner in value.items())


def key_path(where: str, name: str) -> str:
    """Give the path of a key, as messages show it."""
    shown = one_line(shortened(name))
    return f"{where}.{shown}" if where else shown


def _refuse(where: str, expected: str, value: Json) -> NoReturn:
    raise ValueError(f"{where}: expected {expected}, got {_described(value)}")


def _described(value: Json) -> str:
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case str():
            return quoted(value)
        case dict():
            return "an object"
        case list():
            is_pair = len(value) == 2 and all(isinstance(one, int | float) for one in value)
            return f"{value[0]:g} and {value[1]:g}" if is_pair else "a list"
    return f"{value:g}"


def _is_whole(value: Json) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: Json) -> bool:
    return (_is_whole(value) or isinstance(value, float)) and -LARGEST <= value <= LARGEST


def _number(where: str, value: Json) -> None:
    if not _is_number(value):
        _refuse(where, f"a number {LIMITS}", value)


def _share(where: str, value: Json) -> None:
    if not (_is_number(value) and 0.0 <= value <= 1.0):
        _refuse(where, "a number from 0 to 1", value)


def _interval(where: str, value: Json) -> None:
    is_pair = isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))
    if not is_pair or value[0] > value[1]:
        _refuse(where, f"two numbers {LIMITS}, low first", value)


def _text(where: str, value: Json) -> None:
    if not isinstance(value, str):
        _refuse(where, "a text", value)


def _text_or_null(where: str, value: Json) -> None:
    if value is not None and not isinstance(value, str):
        _refuse(where, "a text or null", value)


def _whole(where: str, value: Json) -> None:
    if value is not None and not _is_whole(value):
        _refuse(where, "a whole number or null", value)


def _touch(where: str, value: Json) -> None:
    if value is not None and not (_is_whole(value) and value >= 0):
        _refuse(where, "the number of a touch or null", value)


def _verdict(where: str, value: Json) -> None:
    if value not in list(Verdict):
        _refuse(where, ", ".join(Verdict), value)


def _each(check: Check) -> Check:
    """Make a check of a list from that of an entry."""
    return partial(_all_in, list, "a list", check)


def _by_name(check: Check) -> Check:
    """Make a check of an object with any keys from that of a value."""
    return partial(_all_in, dict, "an object", check)


def _all_in(kind: type, words: str, check: Check, where: str, value: Json) -> None:
    if not isinstance(value, kind):
        _refuse(where, words, value)
    for place, inner in _entries(where, value):
        check(place, inner)


def _record(has_to: Mapping[str, Check], may: Mapping[str, Check]) -> Check:
    """Make a check of an object with the keys that it has to and may have."""

    def checked(where: str, value: Json) -> None:
        if not isinstance(value, dict):
            _refuse(where, "an object", value)
        for name in has_to:
            _need(where, value, [name])
        for name, check in {**has_to, **may}.items():
            if name in value:
                check(key_path(where, name), value[name])

    return checked


def _effect(where: str, value: Json) -> None:
    """Check an effect by itself, then against the table of effects."""
    FIELDS_OF_EFFECT(where, value)
    if value["id"] not in effects():
        known = hint(value["id"], effects())
        raise ValueError(f"{where}.id: no effect is called {quoted(value['id'])}{known}")
    ranges = {parameter.name: parameter for parameter in effects()[value["id"]].parameters}
    there_are = f"there are {', '.join(ranges)}"
    for key in ("params", "intervals"):
        for name in value.get(key, {}):
            if name not in ranges:
                raise ValueError(
                    f"{key_path(f'{where}.{key}', name)}: no such parameter; {there_are}"
                )
    for name, number in value["params"].items():
        if not ranges[name].low <= number <= ranges[name].high:
            expected = f"{ranges[name].low:g} to {ranges[name].high:g}"
            _refuse(f"{where}.params.{name}", expected, number)
    since, until = value.get("since"), value.get("until")
    if since is not None and until is not None and since > until:
        _refuse(f"{where}.until", f"a touch from since = {since} on", until)


def _effects(where: str, value: Json) -> None:
    _each(_effect)(where, value)
    ids = [entry["id"] for entry in value]
    for index, name in enumerate(ids):
        if name in ids[:index]:
            raise ValueError(f"{where}[{index}].id: {name} stands there a second time")


FIELDS_OF_EFFECT = _record(
    {"id": _text, "params": _by_name(_number)},
    {
        "stage": _text,
        "intervals": _by_name(_interval),
        "since": _touch,
        "until": _touch,
        "alternatives": _each(_text),
        "confidence": _share,
    },
)
GAP = _record(
    {},
    {
        "unit": _text,
        "before": _number,
        "after": _number,
        "noise_floor": _number,
        "shrink": _number,
        "shrink_interval": _interval,
    },
)
OBJECT = _record({}, {})
NEXT_EXPERIMENT = _record(
    {},
    {
        "why": _text,
        "record": _text_or_null,
        "touches": _each(OBJECT),
        "expected_bits": _number,
        "bits_per_touch": _number,
        "touches_needed": _whole,
        "separates": _each(_each(_text)),
    },
)
DOCUMENT = _record(
    {"effects": _effects},
    {
        "verdict": _verdict,
        "where": _each(_record({"stage": _text}, {"effects": _each(_text)})),
        "gap": _by_name(GAP),
        "beliefs": _by_name(_record({"fitted": _number}, {})),
        "models": _each(_effects),
        "left": _each(OBJECT),
        "outliers": _each(_whole),
        "failed": _each(OBJECT),
        "closest": _each(_text),
        "material": OBJECT,
        "touches": _whole,
        "touches_searched": _whole,
        "next_experiment": NEXT_EXPERIMENT,
        "transmission": _each(OBJECT),
        "notes": _each(_text),
        "fingerprint": _text,
        "seed": _whole,
    },
)
