"""Writing what was read as a campaign whose nominal.toml says where each figure is from."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isinf
from pathlib import Path
from textwrap import wrap

import numpy as np

from skiplatch.campaign import (
    FORMATS,
    KEYS,
    NOMINAL_FILE,
    TOUCHES_FILE,
    DatumFreedom,
    Kind,
    Touches,
    format_touches,
)
from skiplatch.campaign.constraints import PLACE_MM
from skiplatch.campaign.datum import Datum
from skiplatch.campaign.far_off import surfaces_apart
from skiplatch.campaign.nominal import Key
from skiplatch.campaign.nominal_text import format_nominal
from skiplatch.campaign.nominal_toml import parse_nominal, read_nominal
from skiplatch.campaign.writing import InadmissibleError
from skiplatch.errors import InputError
from skiplatch.files import atomic_write_folder
from skiplatch.importing.model import Figure, Figures, Imported, Touch
from skiplatch.importing.placing import as_touches, machine_thermometer
from skiplatch.importing.presets import PRESETS
from skiplatch.importing.probe_move import LINEAR
from skiplatch.importing.scatter import told_in_a_row
from skiplatch.tables import counted

WIDTH = 98
REPEATABILITY = ("probe", "repeatability_um")


def write_imported(
    out: Path, imported: Imported, sources: Sequence[Path], nominal: Path | None = None
) -> None:
    """Write a campaign folder, all of it or nothing.

    Args:
        out: The folder.
        imported: What the log holds.
        sources: The log first.
        nominal: The nominal.toml of the rig, in place of what the log and the preset say.

    Raises:
        InputError: The folder cannot be written, or something stands there already, or the log
            tells something impossible, such as a feed below 0.
    """
    if imported.columns is not None:
        touches: Touches = imported.columns
        lines: Sequence[int | None] = imported.lines
        free = imported.free or Datum.of_kind(imported.kind).free
    else:
        _leave_out_unknown_feeds(imported)
        touches, free, surfaces = as_touches(
            imported.touches,
            is_plc=imported.path_is_plc,
            place_is_surface=imported.place_is_surface,
        )
        lines = [touch.line for touch in imported.touches]
        _refuse_impossible_places(sources[0], imported.touches)
        imported.known.append(_surfaces(surfaces))
        place = machine_thermometer(imported.touches)
        if place and not any("temp_c" in touch.also for touch in imported.touches):
            imported.assumed.append(f"the temperature of the machine, temp_c, is that of {place}")
        imported.assumed += [apart.line for apart in surfaces_apart(touches)]
        single = sum(1 for n in surfaces.values() if n == 1)
        if single:
            imported.assumed.append(
                f"of {len(surfaces)} surfaces {single} touched once only, whose deviation is "
                "left empty: they tell nothing of the scatter"
            )
    _refuse_impossible(sources[0], imported.figures)
    if nominal is None:
        toml = _toml(imported, sources, free, touches)
    else:
        toml = _given(nominal, imported, free)
    try:
        text = format_touches(touches)
    except InadmissibleError as error:  # a log can tell what is impossible
        line = lines[error.row] if lines else None
        raise InputError(sources[0], line, error.column, error.message) from error
    atomic_write_folder(out, {NOMINAL_FILE: toml, TOUCHES_FILE: text})


def _toml(imported: Imported, sources: Sequence[Path], free: DatumFreedom, touches: Touches) -> str:
    figures = {**PRESETS[imported.preset].figures, **imported.figures}
    if REPEATABILITY in figures and REPEATABILITY not in imported.figures:
        guessed = parse_nominal(sources[0], nominal_text(imported.kind, figures, free))
        if scatter := told_in_a_row(touches, guessed):
            figures[REPEATABILITY] = scatter
    notes = {
        "made_from": ", ".join(path.name for path in sources),
        "known": imported.known,
        "assumed": imported.assumed,
        "unread": imported.unread,
    }
    return nominal_text(imported.kind, figures, free, notes)


def _given(path: Path, imported: Imported, free: DatumFreedom) -> str:
    """Give the nominal.toml of the rig, with its datum unless it is known better of these touches.

    Where a log does not say how far a touch was off, each surface was held against its own middle,
    and an instrument with a zero has that zero.
    """
    nominal = read_nominal(path)
    if nominal.kind is not imported.kind:
        expected = f"expected that of a {imported.kind}, as the log is of one, got a {nominal.kind}"
        raise InputError(path, None, "kind", expected)
    said = f"what is believed of the rig is that of {path}, whatever is said of it here"
    if imported.columns is not None and imported.free is None:
        datum = nominal.datum
    else:
        datum = Datum(free)
        if nominal.datum != datum:
            said += f', but for its [datum]: free = "{free}" is that of these touches'
    imported.known.append(said)
    return format_nominal(replace(nominal, datum=datum))


def _refuse_impossible_places(source: Path, touches: Sequence[Touch]) -> None:
    """Refuse a place that no machine reaches, by the line of its touch.

    No column holds those on the other axes, and the middle of a surface hides the one measured.
    """
    for touch in touches:
        places = [("place of the touch", value) for value in touch.place]
        if touch.axis in LINEAR and touch.coordinate is not None:
            places.append(("position_mm", touch.coordinate))
        for name, value in places:
            if not abs(value) <= PLACE_MM.high:
                message = f"expected {PLACE_MM.words_against(value)} in mm, got {value:g}"
                raise InputError(source, touch.line, name, message)


def _refuse_impossible(source: Path, figures: Figures) -> None:
    """Refuse a figure of the rig that no campaign may hold."""
    for (section, name), figure in figures.items():
        constraint = KEYS[section, name].constraint
        if not constraint.holds(np.array([figure.value])).all():
            found = f"{figure.value:g} ({figure.source})"
            message = f"expected {constraint.words_against(figure.value)}, got {found}"
            raise InputError(source, None, f"{section}.{name}", message)


def _leave_out_unknown_feeds(imported: Imported) -> None:
    """Leave out the touches whose feed no line says, where that of most others is known.

    A diagnosis refuses a campaign in which a feed is missing.
    """
    known = [touch for touch in imported.touches if touch.feed is not None]
    without = len(imported.touches) - len(known)
    if 0 < without < len(known):
        imported.touches = known
        imported.unread.append(
            f"{without} touches of unknown feed are left out; --feed says what it was, and "
            "keeps them"
        )


def nominal_text(
    kind: Kind,
    figures: Figures,
    free: DatumFreedom,
    notes: Mapping[str, str | Sequence[str]] | None = None,
) -> str:
    """Give nominal.toml with every key in it: with its source, or as a comment where unknown."""
    lines = [
        "# What is believed of the rig. A line that begins with # is not known: its default is",
        "# taken. Take the # away and put the figure in; {value = …, u = …} gives its uncertainty.",
        f'format = "{FORMATS[2]}"',
        f'kind = "{kind}"',
    ]
    previous = ""
    for (section, name), key in KEYS.items():
        if section != previous:
            lines += ["", f"[{section}]"]
            previous = section
        lines += _entry(name, key, figures.get((section, name)))
    lines += ["", "# What shares one unknown place of the surface.", "[datum]", f'free = "{free}"']
    lines += _notes(notes or {})
    return "\n".join(lines) + "\n"


def _entry(name: str, key: Key, figure: Figure | None) -> list[str]:
    unit = f" in {key.unit}" if key.unit else ""
    if figure is None:
        default = "0.0" if isinf(key.default) else repr(key.default)
        return [f"# {key.meaning}{unit}; unknown", f"# {name} = {default}"]
    comment = [f"# {line}" for line in wrap(f"{key.meaning}{unit}; {figure.source}", WIDTH)]
    u = "" if figure.u is None else f", u = {float(figure.u)!r}}}"
    value = repr(float(figure.value))
    return [*comment, f"{name} = {value}" if not u else f"{name} = {{value = {value}{u}"]


def _notes(notes: Mapping[str, str | Sequence[str]]) -> list[str]:
    if not notes:
        return []
    lines = ["", "[notes]"]
    for name, said in notes.items():
        if isinstance(said, str):
            lines.append(f"{name} = {_quoted(said)}")
        elif said:
            lines += [f"{name} = [", *(f"    {_quoted(line)}," for line in said), "]"]
    return lines


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else "?" for c in escaped)[:900] + '"'


def _surfaces(surfaces: Mapping[str, int]) -> str:
    n = sum(surfaces.values())
    if len(surfaces) == 1:
        return f"{counted(n, 'touch')} of one surface"
    return f"{counted(n, 'touch')} of {len(surfaces)} surfaces"
