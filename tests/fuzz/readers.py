"""Every reader of files in Python, each with what its fuzzing starts from."""

import signal
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from types import FrameType

import fuzz_campaign
import fuzz_import
import numpy as np
from mutations import expect_one_line, expect_refusal

from skiplatch.api.diagnosed import read_diagnosis
from skiplatch.bench.plan import read_plan
from skiplatch.campaign import Axis, InputPath, read_campaign, read_nominal
from skiplatch.compensation.formats import read_table
from skiplatch.compensation.probe_map import ProbeMap, read_map
from skiplatch.compensation.speeds import read_speeds
from skiplatch.diagnosis import rig_from_json
from skiplatch.diagnosis.experiment import models_from_json
from skiplatch.diagnosis.reported.adoption import adopted
from skiplatch.diagnosis.reported.schema import read_diagnosis_json
from skiplatch.errors import InputError
from skiplatch.files import read_json
from skiplatch.fleet.diagnosed import DIAGNOSIS_FILE, diagnosed
from skiplatch.importing.detect import read_any
from skiplatch.kinematics.control import read_control
from skiplatch.kinematics.machine import Machine, read_machine, read_preset, read_spindle
from skiplatch.kinematics.memory import SHOW, Memory, StoreRefusedError
from skiplatch.kinematics.points import read_points
from skiplatch.kinematics.probing_test import read_test
from skiplatch.kinematics.program import read_program
from skiplatch.kinematics.sphere import read_sphere_points
from skiplatch.kinematics.truth import read_truth
from skiplatch.simulator.library import connection
from skiplatch.transmission.pulses import read_pulses
from skiplatch.transmission.source import read_axis_train

FUZZ = Path(__file__).parent
KEPT = FUZZ / "corpus" / "readers"
SAMPLES = FUZZ.parents[1] / "scripts" / "samples"
KINEMATICS = SAMPLES / "kinematics"
PLANS = SAMPLES / "plans"
TOLD_BY_CONTENT = (".log", ".txt", ".csv", ".sr")
MOST_SECONDS = 5.0  # of processor time that one small file may take


@dataclass(frozen=True, slots=True)
class Reader:
    """One kind of file.

    Attributes:
        name: The file's name.
        read: Reads it all; raises InputError for what it refuses.
            samples: What mutations start from, besides what is kept, by name.
        has_other: A fuzzer of its own mutates it blindly; this one is for Atheris alone.
    """

    name: str
    read: Callable[[Path], object]
    samples: Mapping[str, bytes] = field(default_factory=dict)
    has_other: bool = False


def _files(*paths: Path) -> Mapping[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(paths)}


@cache
def _machine() -> Machine:
    return read_machine(KINEMATICS / "machine_bc.toml")


@cache
def _map() -> ProbeMap:
    return read_map(min((KEPT / "radii").glob("seed*")), outside=False)


def _machine_file(path: Path) -> None:
    read_machine(path)
    read_control(path, input_path=InputPath.SKIP, tip_radius_mm=3.0)
    read_spindle(path)
    read_preset(path)


def _store(path: Path) -> None:
    _, lib = connection()
    path.write_bytes(
        path.read_bytes()[: lib.sim_kinematics_memory_bytes()].ljust(
            lib.sim_kinematics_memory_bytes(), b"\0"
        )
    )
    memory = Memory(path)
    memory.names()
    try:
        memory.run(float(SHOW), 0.0)
    except StoreRefusedError as error:  # as the cycle says it to the program
        raise InputError(path, None, None, str(error)) from error


def _stored(path: Path) -> None:
    touches = read_campaign(SAMPLES / "bench_isr_latency").touches
    for axes in ([Axis.X], [Axis.A], [Axis.X, Axis.A]):
        diagnosed(path.parent, replace(touches, axis=np.resize(axes, len(touches))))


def _findings(path: Path) -> None:
    """Read a diagnosis as every command does that takes one; each may refuse it for itself."""
    document = read_json(path)
    nominal = read_nominal(SAMPLES / "bench_isr_latency" / "nominal.toml")
    refused = []
    for read in (lambda: rig_from_json(document, nominal), lambda: adopted(document)):
        try:
            read()
        except ValueError as error:
            refused.append(str(error))
    for message in refused:
        expect_one_line(message)
    read_diagnosis(path)


def _models(path: Path) -> None:
    read_diagnosis_json(path, models_from_json)


def _importers() -> Mapping[str, Reader]:
    """Give a reader for each kind of log that is imported, and each ending it goes by."""
    logs: dict[tuple[str, str], dict[str, bytes]] = {}
    for name, data in fuzz_import.read_seeds().items():
        kind = fuzz_import.pattern_of(name).split("*")[0]
        logs.setdefault((kind, fuzz_import.ending_of(name)), {})[name] = data
    return {
        f"{kind}{ending}": Reader(
            f"log{ending}", partial(_import, next(iter(named))), named, has_other=True
        )
        for (kind, ending), named in logs.items()
    }


def _any_log() -> Reader:
    """Give the reader that finds out by itself of what kind a log is."""
    logs = {n: data for n, data in fuzz_import.read_seeds().items() if n.endswith(TOLD_BY_CONTENT)}
    return Reader("log.txt", read_any, logs)


def _import(name: str, path: Path) -> None:
    fuzz_import.check(name, path.read_bytes())


READERS: Mapping[str, Reader] = {
    "pulses": Reader("pulses", lambda path: [len(block) for block in read_pulses(path)]),
    "train": Reader("train.toml", read_axis_train),
    "radii": Reader("radii.csv", lambda path: read_map(path, outside=False)),
    "speeds": Reader("speeds.csv", lambda path: read_speeds(path, outside=False)),
    "table": Reader("table.csv", lambda path: read_table(path, _map())),
    "points": Reader("points.csv", lambda path: read_points(path, _machine())),
    "sphere": Reader("sphere.csv", read_sphere_points),
    "probing": Reader("probing.csv", read_test),
    "machine": Reader("machine.toml", _machine_file, _files(KINEMATICS / "machine_bc.toml")),
    "truth": Reader(
        "truth.toml",
        lambda path: read_truth(path, _machine()),
        _files(*KINEMATICS.glob("truth*.toml")),
    ),
    "program": Reader("program.h", read_program, _files(*KINEMATICS.glob("*.h"))),
    "store": Reader("store.bin", _store),
    "plan": Reader(
        "plan.toml",
        lambda path: read_plan(path, PLANS / "believed.toml"),
        _files(*(p for p in PLANS.glob("*.toml") if not p.name.startswith("believed"))),
    ),
    "diagnosis": Reader("found.json", _findings),
    "models": Reader("found.json", _models),
    "stored": Reader(DIAGNOSIS_FILE, _stored),
    "nominal": Reader(
        "nominal.toml",
        fuzz_campaign.check_nominal,
        _files(*fuzz_campaign.CORPUS.glob("*.toml")),
        has_other=True,
    ),
    "touches": Reader(
        "touches.csv",
        fuzz_campaign.check_touches,
        _files(*fuzz_campaign.CORPUS.glob("*.csv")),
        has_other=True,
    ),
    "any": _any_log(),
    **_importers(),
}
SHARED = {"models": "diagnosis", "stored": "diagnosis"}
"""Readers of the same files keep them in the same folder."""


def kept(name: str) -> Path:
    """Give the folder with the seeds and findings of a reader."""
    return KEPT / SHARED.get(name, name)


def seeds(name: str) -> Mapping[str, bytes]:
    """Give what the fuzzing of a reader starts from, by name."""
    return {**READERS[name].samples, **_files(*kept(name).glob("*"))}


@contextmanager
def patience() -> Iterator[None]:
    """Raise where something takes more processor time than a small file may."""

    def too_long(number: int, frame: FrameType | None) -> None:
        raise AssertionError("takes too long")

    before = signal.signal(signal.SIGPROF, too_long)
    signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def check(name: str, data: bytes) -> str:
    """Read the data and tell whether they were "read" or "refused"; raise if neither is so."""
    reader = READERS[name]
    with tempfile.TemporaryDirectory(prefix="skiplatch-fuzz-") as folder, patience():
        path = Path(folder) / reader.name
        path.write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                reader.read(path)
            except InputError as error:
                expect_refusal(error)
                return "refused"
    return "read"
