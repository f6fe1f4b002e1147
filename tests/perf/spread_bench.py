"""What spreading work over workers costs: campaigns, workers that are killed, empty tasks.

Campaigns on one and on two workers are timed in turn with as many plain loops, in one run. Then
workers of a cluster are killed while it diagnoses, and the answers are held beside the plain ones,
byte for byte. `make bench` does a size that takes minutes. What the goal asks for is

  python tests/perf/spread_bench.py --killed 1000 --kill-every-s 30 --killed-touches 16

``--figures docs/spread.json`` writes what docs/FLEET.md shows; with ``--only killed``, or another
kind of figures, of that alone. What each campaign costs beside its diagnosis is measured with the
answer ready: the difference of two diagnoses that take seconds would not tell it.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import asdict, dataclass
from importlib import import_module
from importlib.util import find_spec
from operator import getitem
from pathlib import Path
from statistics import median
from typing import Any, cast

from diagnosis_bench import SKIPLATCH
from fleet_bench import record
from spread_figures import FIGURES, Campaigns, Empty, Figures, Handed, Killed

from skiplatch.commands.diagnose_many import Told, tell
from skiplatch.commands.examining import Asked
from skiplatch.commands.kept import Kept, key_of
from skiplatch.commands.options import json_text
from skiplatch.executors import client_of, software
from skiplatch.files import atomic_write_text
from skiplatch.played_files import read_playable
from skiplatch.workers import Failed, Workers, finished, opened

EMPTY = (1_000, 10_000)
SIZE = 4, 400
"""Campaigns for each worker, and touches of each."""
ROUNDS = 3
KILLED, KILLED_TOUCHES, KILL_EVERY_S = 24, 60, 10.0
"""A task that dies three times is given up: most have to end between two kills of their worker."""
HANDED, HANDED_TOUCHES = 200, 400
WORKERS = (1, 2)
KINDS = ("beside", "handed", "killed", "empty")
"""Of figures."""
FEWEST = 2
"""Campaigns, for an answer of one is no list."""
PLAIN_LOOP = Path(__file__).with_name("plain_loop.py")


@dataclass(frozen=True, slots=True)
class Run:
    """How long it took, and what was written."""

    seconds: float
    text: str


def plain_loops(campaigns: Sequence[Path], processes: int, out: Path) -> Run:
    """Diagnose in so many processes side by side, each with every so-manieth campaign."""
    parts = [out.with_suffix(f".{at}") for at in range(processes)]
    begin = time.perf_counter()
    started = [
        subprocess.Popen([sys.executable, PLAIN_LOOP, part, *campaigns[at::processes]])
        for at, part in enumerate(parts)
    ]
    for process in started:
        if process.wait():
            raise SystemExit("spread_bench: a plain loop failed")
    seconds = time.perf_counter() - begin
    documents: list[Any] = [None] * len(campaigns)
    for at, part in enumerate(parts):
        documents[at::processes] = json.loads(part.read_text(encoding="utf-8"))
    return Run(seconds, json_text(documents))


def spread(campaigns: Sequence[Path], place: Sequence[str], out: Path) -> Run:
    """Diagnose by one command that spreads."""
    begin = time.perf_counter()
    process = start(campaigns, place, out)
    if process.wait():
        raise SystemExit(f"spread_bench: diagnose {' '.join(place)} failed")
    return Run(time.perf_counter() - begin, out.read_text(encoding="utf-8"))


def start(campaigns: Sequence[Path], place: Sequence[str], out: Path) -> "subprocess.Popen[bytes]":
    """Start a command that spreads."""
    words: list[str | Path] = [SKIPLATCH, "diagnose", *campaigns, *place, "--json", out]
    return subprocess.Popen(words, stdout=subprocess.DEVNULL)


@contextmanager
def places(workers: int) -> Iterator[dict[str, list[str]]]:
    """Name where tasks can run here, on so many workers; those of the cluster run already."""
    found = {"processes": ["--jobs", str(workers)]}
    has_cluster = find_spec("distributed") is not None
    with client_of(f"local:{workers}") if has_cluster else nullcontext() as client:
        if client is not None:
            found["cluster"] = ["--cluster", client.scheduler.address]
        yield found


def recorded(folder: Path, count: int, touches: int) -> list[Path]:
    """Write campaigns, each of its own seed."""
    campaigns = [folder / f"{touches}_touches_{number}" for number in range(count)]
    for number, campaign in enumerate(campaigns):
        record(campaign, touches, number)
    return campaigns


def bench_campaigns(folder: Path, workers: int, count: int, touches: int) -> list[Campaigns]:
    """Time so many campaigns a worker, in turn with plain loops; medians of the rounds."""
    campaigns = recorded(folder, count * workers, touches)
    out = folder / "out.json"
    plain_s: list[float] = []
    seconds: dict[str, list[float]] = {}
    with places(workers) as found:
        if "cluster" in found:  # let its workers load everything, as they have after a minute
            spread(campaigns, found["cluster"], out)
        for _ in range(ROUNDS):
            plain = plain_loops(campaigns, workers, out)
            plain_s.append(plain.seconds)
            for name, place in found.items():
                run = spread(campaigns, place, out)
                seconds.setdefault(name, []).append(run.seconds)
                if run.text != plain.text:
                    raise SystemExit(f"spread_bench: {name} wrote other bytes than plain loops")
    sizes = workers, len(campaigns), touches, median(plain_s)
    return [Campaigns(name, *sizes, *_held(s, plain_s)) for name, s in seconds.items()]


def _held(seconds: Sequence[float], plain_s: Sequence[float]) -> tuple[float, float]:
    """Give medians over the rounds: the share of plain loops, and the seconds more."""
    pairs = list(zip(seconds, plain_s, strict=True))
    return median(plain / s for s, plain in pairs), median(s - plain for s, plain in pairs)


def bench_killed(folder: Path, count: int, touches: int, every_s: float) -> Killed:
    """Kill a worker of a cluster every so often while it diagnoses."""
    campaigns = recorded(folder, count, touches)
    plain = plain_loops(campaigns, max(WORKERS), folder / "plain.json")
    out = folder / "killed.json"
    begin = time.perf_counter()
    process = start(campaigns, ["--cluster", f"local:{max(WORKERS)}"], out)
    kills = kill_workers(process, every_s, out.with_name(out.name + ".part"))
    status = process.wait()
    seconds = time.perf_counter() - begin
    is_same = status == 0 and out.read_text(encoding="utf-8") == plain.text
    return Killed(count, touches, every_s, kills, seconds / plain.seconds, is_same)


def kill_workers(process: "subprocess.Popen[bytes]", every_s: float, since: Path) -> int:
    """Kill a worker of a command so often, from when a folder is there; gives how many were."""
    psutil: Any = import_module("psutil")  # comes with the extra cluster
    kills = 0
    due_s = time.perf_counter() + every_s
    while process.poll() is None:
        time.sleep(0.1)
        if not since.exists() or time.perf_counter() < due_s:
            continue
        due_s = time.perf_counter() + every_s
        with suppress(psutil.NoSuchProcess):  # one has just ended by itself
            children = psutil.Process(process.pid).children(recursive=True)
            found = [child for child in children if "spawn_main" in " ".join(child.cmdline())]
            for child in found[kills % 2 : kills % 2 + 1]:
                child.kill()
                kills += 1
    return kills


def workers_here() -> dict[str, Workers]:
    """Name two workers each of the kinds there are."""
    workers = max(WORKERS)
    found = {"processes": Workers(jobs=workers)}
    if find_spec("distributed") is not None:
        found["cluster"] = Workers(cluster=f"local:{workers}")
    return found


def bench_handed(folder: Path) -> list[Handed]:
    """Time all that is done for a campaign beside its diagnosis: it goes there with its answer."""
    paths = recorded(folder, HANDED, HANDED_TOUCHES)
    campaigns, asked = [read_playable(path) for path in paths], Asked(seed=1)
    told = tell(campaigns[0], asked)
    found = []
    for name, place in workers_here().items():
        kept = Kept(folder / f"{name}.part")
        with opened(place) as executor:
            list(finished(executor, abs, [(0,)] * max(WORKERS)))
            begin = time.perf_counter()
            keys = [key_of(path, asked, software()) for path in paths]
            tasks = [((campaign, told), 1) for campaign in campaigns]
            for number, answer in finished(executor, getitem, tasks):
                if isinstance(answer, Failed):
                    raise SystemExit(f"spread_bench: {name}: {answer.why}")
                kept.put(keys[number], asdict(cast(Told, answer)))
            each_ms = 1e3 * (time.perf_counter() - begin) / HANDED
        found.append(Handed(name, HANDED, HANDED_TOUCHES, each_ms))
    return found


def bench_empty() -> list[Empty]:
    """Time tasks that do nothing; of the cluster, client and scheduler are of this process."""
    found = []
    for name, place in workers_here().items():
        with opened(place) as executor:
            list(finished(executor, abs, [(0,)]))
            for count in EMPTY:
                tasks = [(number,) for number in range(count)]
                begin, begin_cpu = time.perf_counter(), time.process_time()
                list(finished(executor, abs, tasks))
                wall_ms = 1e3 * (time.perf_counter() - begin) / count
                cpu_ms = 1e3 * (time.process_time() - begin_cpu) / count
                found.append(Empty(name, count, wall_ms, cpu_ms))
    return found


def measure_killed(count: int, touches: int, every_s: float) -> Killed | None:
    """Measure what deaths cost; nothing where Dask is not installed."""
    if find_spec("distributed") is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        return bench_killed(Path(folder), count, touches, every_s)


def measure_beside(sizes: Sequence[tuple[int, int]]) -> list[Campaigns]:
    """Measure campaigns beside plain loops, of each size on each number of workers."""
    found = []
    for size in sizes:
        for workers in WORKERS:
            with tempfile.TemporaryDirectory() as folder:
                found += bench_campaigns(Path(folder), workers, *size)
    return found


def _size(text: str) -> tuple[int, int]:
    """Read CAMPAIGNSxTOUCHES."""
    campaigns, touches = map(int, text.split("x"))
    if campaigns < FEWEST or touches < 1:
        raise ValueError(text)
    return campaigns, touches


def measure_handed() -> list[Handed]:
    """Measure what a campaign costs beside its diagnosis."""
    with tempfile.TemporaryDirectory() as folder:
        return bench_handed(Path(folder))


def bench_spread() -> None:
    """Run everything in the size of `make bench`."""
    beside = measure_beside([SIZE])
    killed = measure_killed(KILLED, KILLED_TOUCHES, KILL_EVERY_S)
    print(Figures(beside, killed, bench_empty(), measure_handed()).as_text())


def main() -> None:
    """Read the command line, and run everything."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--size",
        type=_size,
        action="append",
        metavar="CAMPAIGNSxTOUCHES",
        help=f"campaigns for each worker, at least {FEWEST}; may be given several times",
    )
    parser.add_argument("--killed", type=int, default=KILLED, help="campaigns while workers die")
    parser.add_argument("--killed-touches", type=int, default=KILLED_TOUCHES, help="of each")
    parser.add_argument("--kill-every-s", type=float, default=KILL_EVERY_S)
    parser.add_argument(
        "--only", choices=KINDS, action="append", help="leave the other figures as they are"
    )
    parser.add_argument("--figures", type=Path, help="write what docs/FLEET.md shows")
    given = parser.parse_args()
    if given.killed < FEWEST or given.kill_every_s <= 0.0:
        parser.error(f"expected at least {FEWEST} campaigns each, and a time above 0")
    measures: dict[str, Callable[[], Any]] = {
        "beside": lambda: measure_beside(given.size or [SIZE]),
        "killed": lambda: measure_killed(given.killed, given.killed_touches, given.kill_every_s),
        "empty": bench_empty,
        "handed": measure_handed,
    }
    found = {kind: measures[kind]() for kind in given.only or KINDS}
    measured = Figures(
        found.get("beside", []),
        found.get("killed"),
        found.get("empty", []),
        found.get("handed", []),
    )
    print(measured.as_text())
    if given.figures:
        atomic_write_text(given.figures, measured.or_before(FIGURES).as_json())


if __name__ == "__main__":
    main()
