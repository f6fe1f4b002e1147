"""What ``skiplatch compensate`` reads of files or a campaign, and makes of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from skiplatch.campaign import COLUMNS, InputPath
from skiplatch.campaign.column_kinds import ChoiceColumn
from skiplatch.compensation.budget import Inputs
from skiplatch.compensation.compensate import Compensation, Limits, compensate
from skiplatch.compensation.delay import Delay, estimate_delay
from skiplatch.compensation.formats import (
    read_table,
)
from skiplatch.compensation.from_campaign import Recorded, recorded
from skiplatch.compensation.probe_figures import ProbeFigures, probe_figures, warn_off_centre
from skiplatch.compensation.probe_map import ProbeMap, read_map
from skiplatch.compensation.speeds import read_speeds
from skiplatch.compensation.uncertainty import Uncertainty, assess
from skiplatch.played_files import read_playable
from skiplatch.units import PER_CENT


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """All that is told."""

    done: Compensation
    figures: ProbeFigures
    known: Uncertainty
    after_map: ProbeMap | None
    after: ProbeFigures | None


def result_of(radii: Path | None, given: Mapping[str, Any]) -> Result:
    """Read the map and the delay, and compute all that is told."""
    probe_map, delay = _from_campaign(given) if radii is None else _from_files(radii, given)
    v0 = given["v0"]
    before = np.full(len(probe_map), v0)
    if given["previous"] is not None:
        before = read_table(given["previous"], probe_map)
    done = compensate(
        probe_map,
        delay,
        base_mm_min=v0,
        before_mm_min=before,
        target=given["target"],
        limits=_limits(given),
    )
    inputs = Inputs(
        repeatability_um=given["repeatability"],
        resolution_um=given["resolution"] or 0.0,
        feed_error=(given["feed_error"] or 0.0) / PER_CENT,
    )
    after_map = _after(given)
    figures, known = probe_figures(probe_map), assess(done, inputs, seed=given["seed"])
    if radii is not None:
        warn_off_centre(figures, known.vr_before_expanded_um, radii)
    return Result(
        done=done,
        figures=figures,
        known=known,
        after_map=after_map,
        after=None if after_map is None else probe_figures(after_map),
    )


def _after(given: Mapping[str, Any]) -> ProbeMap | None:
    """Read what was measured with a table, if it was."""
    path: Path | None = given["after"]
    if path is None:
        return None
    if path.is_dir():
        return _recorded(path, given).as_measured(fit_centre=given["centre"] == "fit")
    return read_map(path, outside=not given["map_inside"])


def _delay(given: Mapping[str, Any]) -> Delay | None:
    if given["tau"] is not None:
        return Delay(given["tau"], given["tau_uncertainty"] or 0.0)
    if given["tau_from"] is not None:
        return estimate_delay(read_speeds(given["tau_from"], outside=not given["inside"]))
    return None


def _from_files(radii: Path, given: Mapping[str, Any]) -> tuple[ProbeMap, Delay]:
    probe_map = read_map(radii, outside=not given["map_inside"])
    delay = _delay(given)
    assert delay is not None  # noqa: S101  the options were checked
    return probe_map, delay


def _recorded(folder: Path, given: Mapping[str, Any]) -> Recorded:
    column = COLUMNS["path"]
    assert isinstance(column, ChoiceColumn)  # noqa: S101  for the type checker
    path = None if given["path"] is None else InputPath(column.codes[given["path"]])
    return recorded(read_playable(folder), path)


def _from_campaign(given: Mapping[str, Any]) -> tuple[ProbeMap, Delay]:
    found = _recorded(given["campaign"], given)
    delay = _delay(given) or estimate_delay(found.speeds())
    return found.probe_map(delay, given["v0"], fit_centre=given["centre"] == "fit"), delay


def _limits(given: Mapping[str, Any]) -> Limits:
    def limit(name: str) -> float:
        return math.inf if given[name] is None else float(given[name])

    return Limits(
        max_feed_mm_min=limit("max_feed"),
        overtravel_mm=limit("overtravel"),
        accel_mm_s2=limit("accel"),
        approach_mm=limit("approach"),
        reaction_ms=given["reaction_ms"] or 0.0,
    )
