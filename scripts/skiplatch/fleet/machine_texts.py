"""Findings for machines: JUnit XML for a CI bench, OpenMetrics text for Prometheus."""

from collections.abc import Callable
from datetime import UTC
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET  # written here, never parsed

from skiplatch.errors import InputError
from skiplatch.fleet.changes import Change
from skiplatch.fleet.findings import Findings, change_text

if TYPE_CHECKING:
    from prometheus_client import Gauge

MISSING = "not installed; pip install 'skiplatch[fleet]' brings it"
SUITE = "skiplatch fleet check"


def junit_xml(findings: Findings) -> str:
    """Give a test case for each rig: failed where it has changed lately, skipped if not judged."""
    changed, rigs = _by_rig(findings.recent), sorted({*findings.history, *findings.unjudged})
    numbers = {
        "tests": len(rigs),
        "failures": len(changed),
        "errors": 0,
        "skipped": len(findings.unjudged),
    }
    counts = {name: str(number) for name, number in numbers.items()}
    suite = ET.Element("testsuite", {"name": SUITE, **counts})
    for rig in rigs:
        case = ET.SubElement(suite, "testcase", {"classname": SUITE, "name": rig})
        if rig in findings.unjudged:
            ET.SubElement(case, "skipped", {"message": findings.unjudged[rig]})
        elif changes := changed.get(rig):
            lines = [change_text(change) for change in changes]
            failure = ET.SubElement(case, "failure", {"type": "changed", "message": lines[0]})
            failure.text = "\n".join(lines)
    ET.indent(suite)
    declaration = '<?xml version="1.0" encoding="UTF-8"?>\n'
    return declaration + ET.tostring(suite, encoding="unicode") + "\n"


def _by_rig(changes: list[Change]) -> dict[str, list[Change]]:
    found: dict[str, list[Change]] = {}
    for change in changes:
        found.setdefault(change.rig, []).append(change)
    return found


def open_metrics(findings: Findings) -> str:
    """Give gauges of the fleet and of each rig.

    Raises:
        InputError: prometheus_client is not installed.
    """
    try:
        from prometheus_client import CollectorRegistry, Gauge  # noqa: PLC0415 - an extra
        from prometheus_client.openmetrics.exposition import generate_latest  # noqa: PLC0415
    except ImportError as error:
        raise InputError("prometheus_client", None, None, MISSING) from error
    registry = CollectorRegistry()

    def gauge(name: str, words: str, *labels: str) -> Gauge:
        return Gauge(f"skiplatch_fleet_{name}", words, labels, registry=registry)

    totals = {
        ("rigs", "Rigs of the store."): findings.rigs,
        ("unjudged_rigs", "Rigs that tell too little of a change."): len(findings.unjudged),
        ("changed_rigs", "Rigs that changed lately."): len(_by_rig(findings.recent)),
        ("undiagnosed_campaigns", "Campaigns without a diagnosis."): findings.undiagnosed,
        ("later_than_clock_campaigns", "Campaigns later than this clock."): findings.to_come,
    }
    for described, number in totals.items():
        gauge(*described).set(number)
    _of_rigs(gauge, findings)
    text: bytes = generate_latest(registry)  # type: ignore[no-untyped-call]
    return text.decode()


def _of_rigs(gauge: Callable[..., "Gauge"], findings: Findings) -> None:
    changed = gauge("rig_changes", "Changes of a rig that were seen lately.", "rig")
    gap_um = gauge("rig_gap_um", "Largest gap of the newest diagnosis in micrometres.", "rig")
    gap_arcsec = gauge("rig_gap_arcsec", "And where all axes turn, in arcseconds.", "rig")
    newest = gauge("rig_newest_seconds", "When its newest campaign was recorded (UNIX).", "rig")
    by_rig = _by_rig(findings.recent)
    for rig, entries in findings.history.items():
        changed.labels(rig).set(len(by_rig.get(rig, ())))
        newest.labels(rig).set(entries[-1].time.replace(tzinfo=UTC).timestamp())
        told = next((entry for entry in reversed(entries) if entry.gap), entries[-1])
        newest_gaps = {gap_um: told.gap_um, gap_arcsec: told.gap_arcsec}
        for known, gap in newest_gaps.items():
            if gap is not None:
                known.labels(rig).set(gap)
