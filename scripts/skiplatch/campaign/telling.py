"""What a campaign cannot tell, because it was not recorded or not varied."""

import numpy as np

from skiplatch.arrays import BoolArray, FloatArray
from skiplatch.campaign.columns import COLUMNS
from skiplatch.campaign.datum_names import datum_names
from skiplatch.campaign.folder import Campaign
from skiplatch.campaign.kind import Kind
from skiplatch.campaign.nominal import KEYS, Nominal
from skiplatch.campaign.touches import Touches
from skiplatch.tables import counted

# What a column or a key is for; where there is none of that, nobody misses it.
_OF_A_BENCH = {"edge_us"}
_OF_A_MACHINE = {"alpha_deg", "beta_deg", "sign"}
_ROTARY = {"position_mm": "position_deg", "deviation_um": "deviation_arcsec"}
"""What stands in place of a column of a linear axis."""
_OF_A_TOUCH = {
    "path",
    "alpha_deg",
    "beta_deg",
    "feed_mm_min",
    "approach_mm",
    "edge_us",
    "latch_us",
    "report_us",
}
_RARE = {"rotary_deg", "session", "status"}
_FEW_TOUCHES = 20
HIDES_BACKLASH = (
    "each surface is met in one sense and may lie anywhere: a backlash looks like where they lie; "
    "touch a gauge of known width from both sides, and import how far each touch is off its "
    "faces (import csv)"
)


def missing_columns(campaign: Campaign) -> dict[str, str]:
    """Give what is lost by each column in which nothing stands, for this kind of campaign."""
    other_kind = _OF_A_MACHINE if campaign.nominal.kind is Kind.BENCH else _OF_A_BENCH
    unmissed = {"touch", "path"} | other_kind | set(_ROTARY.values()) | _RARE
    if campaign.nominal.datum.is_at_rest:
        unmissed |= _OF_A_TOUCH
    columns = campaign.touches.columns()

    def is_recorded(name: str) -> bool:
        return bool(COLUMNS[name].recorded(columns[name]).any())

    return {
        name: column.lost
        for name, column in COLUMNS.items()
        if name not in unmissed
        and not is_recorded(name)
        and not (name in _ROTARY and is_recorded(_ROTARY[name]))
    }


def missing_keys(campaign: Campaign) -> dict[str, str]:
    """Give what is lost by each key that was left out and that these touches depend on."""
    touches, kind = campaign.touches, campaign.nominal.kind
    unmissed = {"axis.min_mm", "axis.max_mm", "probe.calibrated_at_c"}
    if np.isnan(touches.latch_us).all():
        unmissed.add("skip.tick_us")
    is_touch = not campaign.nominal.datum.is_at_rest
    sections = {
        "probe": kind is Kind.MACHINE and is_touch,
        "input": is_touch,
        "bench": kind is Kind.BENCH,
        "plc": bool(touches.on_plc.any()),
        "skip": bool(touches.on_skip.any()) and is_touch,
        "report": not bool(np.isnan(touches.report_us).all()),
    }
    return {
        f"{section}.{name}": KEYS[section, name].lost
        for section, name in sorted(campaign.nominal.unknown, key=list(KEYS).index)
        if sections.get(section, True) and f"{section}.{name}" not in unmissed
    }


def cannot_be_told(campaign: Campaign) -> list[str]:
    """Say what was not varied, and which touches would help."""
    touches = _with_an_outcome(campaign.touches)
    said, at_rest = [], campaign.nominal.datum.is_at_rest
    if at_rest:
        said.append("positions at rest: nothing shows that goes by time or comes with a touch")
    elif _one_value(touches.feed_mm_min):
        said.append("one feed: a delay and a length look alike; touch at a second feed")
    elif _feeds_are_apart(campaign.nominal, touches):
        said.append(
            "one feed a session: a delay and a place look alike; touch at two feeds in one session"
        )
    if campaign.nominal.kind is Kind.MACHINE:
        said += _not_varied_on_a_machine(touches, at_rest=at_rest)
        said += [HIDES_BACKLASH] if hides_backlash(campaign.nominal, touches) else []
    if _one_value(touches.temp_c):
        said.append("one temperature: growth with it does not show; touch while the rig warms up")
    count = len(campaign.touches)
    if count < _FEW_TOUCHES:
        said.append(f"{counted(count, 'touch')}: only what stands far out of the scatter shows")
    return said + _order_lost(campaign.touches)


def _with_an_outcome(touches: Touches) -> Touches:
    """Leave touches out that tell nothing; all stay where none does."""
    outcomes = (touches.deviation_um, touches.deviation_arcsec, touches.latch_us)
    known = np.any([np.isfinite(values) for values in outcomes], axis=0)
    return touches.select(known) if known.any() else touches


def hides_backlash(nominal: Nominal, touches: Touches) -> bool:
    """Tell whether an axis meets no place in both senses, and each place may lie anywhere."""
    names = datum_names(nominal, touches)
    if names is None or nominal.datum.u_um is not None:
        return False
    places = np.char.add(names, touches.axis.astype(str))

    def has_both(rows: BoolArray) -> bool:
        return {-1.0, 1.0} <= set(touches.sign[rows].tolist())

    return any(
        has_both(here) and not any(has_both(places == place) for place in np.unique(places[here]))
        for here in (touches.axis == axis for axis in np.unique(touches.axis))
    )


def _not_varied_on_a_machine(touches: Touches, *, at_rest: bool) -> list[str]:
    said = []
    if _one_value(touches.sign):
        said.append("one sense of motion: backlash does not show; touch from the other side too")
    if _one_value(touches.position_mm) and not np.isfinite(touches.position_deg).any():
        said.append("one place: errors along the axis do not show; touch at other positions")
    if _one_value(touches.alpha_deg) and not at_rest:
        said.append("one direction: the probe's lobes do not show; touch from others")
    return said


def _feeds_are_apart(nominal: Nominal, touches: Touches) -> bool:
    """Tell whether feeds differ only where the surface may lie elsewhere, too."""
    names, feeds = datum_names(nominal, touches), touches.feed_mm_min
    if names is None or not np.isfinite(feeds).all() or _one_value(feeds):
        return False
    return all(_one_value(feeds[names == name]) for name in np.unique(names))


def _one_value(values: FloatArray) -> bool:
    known = values[np.isfinite(values)]
    return len(known) > 0 and bool((known == known[0]).all())


def _order_lost(touches: Touches) -> list[str]:
    unknown = np.isnan(touches.time_s)
    if not unknown.any() or np.isfinite(touches.edge_us).all():
        return []
    if unknown.all():
        return ["no times: the order of the rows counts as that of the touches"]
    return [f"no time of {unknown.sum()} touches: each counts as made after the row before it"]
