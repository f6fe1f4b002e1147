"""Tasks spread over workers: what is lost is tried again, and what stays lost is named."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from skiplatch import executors, workers
from skiplatch.commands.kept import Kept
from skiplatch.errors import InputError
from skiplatch.executors import ForeignWorkerError
from skiplatch.simulator.library import SimulationError
from skiplatch.workers import Failed, Workers, finished, in_order, opened

LIMIT_S = 0.5


class Scripted(Executor):
    """Ends each try of a task as a script says: a result, or what it fails by."""

    def __init__(self, script: dict[int, list[object]]) -> None:
        self.script = script

    def submit(self, fn: Callable[..., Any], /, *args: Any, **_: Any) -> "Future[Any]":  # noqa: ANN401
        future: Future[Any] = Future()
        come = self.script.get(args[0], [])
        outcome = come.pop(0) if come else fn(*args)
        if isinstance(outcome, BaseException):
            future.set_exception(outcome)
        else:
            future.set_result(outcome)
        return future


class Noted(Future[Any]):
    """Knows whether anybody has asked what came of it."""

    is_taken = False

    def exception(self, timeout: float | None = None) -> BaseException | None:
        self.is_taken = True
        return super().exception(timeout)


class Watched(Scripted):
    """Notes what is sent, and what is sent while nothing else is under way."""

    def __init__(self, script: dict[int, list[object]]) -> None:
        super().__init__(script)
        self.given: list[Noted] = []
        self.sent: list[int] = []
        self.sent_alone: list[int] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **_: Any) -> "Future[Any]":  # noqa: ANN401
        self.sent.append(args[0])
        if self.given and all(future.is_taken for future in self.given):
            self.sent_alone.append(args[0])
        self.given.append(Noted())
        ended = super().submit(fn, *args)
        error = ended.exception()
        if error is None:
            self.given[-1].set_result(ended.result())
        else:
            self.given[-1].set_exception(error)
        return self.given[-1]


class KilledWorker(Exception):  # noqa: N818 - as Dask calls it
    """What Dask says of a task that workers died of."""


def double(number: int) -> int:
    return 2 * number


def die_of_three(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return double(number)


def die_the_first_time(number: int, folder: Path) -> int:
    mark = folder / str(number)
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return double(number)


def wait_for(number: int, go: Path) -> int:
    while not go.exists():
        time.sleep(0.05)
    return double(number)


def hang_at_two(number: int) -> int:
    if number == 2:
        time.sleep(60.0)
    return double(number)


def outgrow_at_three(number: int, size_b: int, held_s: float) -> int:
    if number == 3:
        held = np.ones(size_b, dtype=np.uint8)
        time.sleep(held_s)
        return int(held[0])
    return double(number)


def free_port() -> int:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return int(taken.getsockname()[1])


def outcomes(executor: Executor, task: Callable[..., Any], *more: object) -> list[Any]:
    found = dict(finished(executor, task, [(number, *more) for number in range(5)]))
    return [found[number] for number in range(5)]


@pytest.fixture
def two() -> Iterator[Executor]:
    with opened(Workers(jobs=2, limit_s=LIMIT_S)) as executor:
        yield executor


@pytest.mark.parametrize(
    ("lost", "why"),
    [
        (CancelledError(), "the scheduler was lost"),
        (TimeoutError(), "it took too long"),
        (MemoryError(), "it ran out of memory"),
        (KilledWorker(), "its worker died, as out of memory or time"),
    ],
)
def test_what_is_lost_is_tried_thrice(lost: BaseException, why: str) -> None:
    assert outcomes(Scripted({1: [lost, lost]}), double) == [0, 2, 4, 6, 8]
    assert outcomes(Scripted({1: [lost, lost, lost]}), double) == [
        0,
        Failed(f"{why}, 3 times"),
        4,
        6,
        8,
    ]


def test_what_may_be_lost_by_another_is_tried_again_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(workers, "MOST_UNDER_WAY", 2)
    killed, cancelled = KilledWorker(), CancelledError()
    cluster = Watched({0: [killed, killed, killed], 1: [killed], 3: [cancelled]})

    found = dict(finished(cluster, double, [(number,) for number in range(6)]))

    assert cluster.sent == [0, 1, 2, 3, 4, 3, 5, 0, 1, 0]
    assert cluster.sent_alone == [0, 1, 0]
    assert found == {
        0: Failed("its worker died, as out of memory or time, 3 times"),
        **{number: 2 * number for number in range(1, 6)},
    }


def test_what_fails_by_itself_is_told_and_not_tried_again() -> None:
    wrong = InputError("here", 3, None, "is wrong")
    faulty = ValueError("a bug")
    executor = Scripted({1: [wrong], 2: [SimulationError("out of its range")], 3: [faulty]})

    assert outcomes(executor, double) == [
        0,
        Failed("here:3: is wrong"),
        Failed("out of its range"),
        Failed("ValueError: a bug"),
        8,
    ]


def test_a_worker_with_other_software_ends_it() -> None:
    foreign = ForeignWorkerError("host-7", None, None, "its worker has skiplatch 0.0.9")

    with pytest.raises(ForeignWorkerError, match=r"host-7: its worker has skiplatch 0\.0\.9"):
        outcomes(Scripted({4: [foreign]}), double)
    with pytest.raises(ForeignWorkerError, match="No module named 'skiplatch'; it wants skiplatch"):
        outcomes(Scripted({4: [ModuleNotFoundError("No module named 'skiplatch'")]}), double)


def test_a_worker_tells_other_software_from_its_own() -> None:
    assert executors._on_worker(executors.software(), 60.0, double, (21,), {}) == 42
    with pytest.raises(ForeignWorkerError, match=r"it wants skiplatch 0\.0\.9"):
        executors._on_worker("skiplatch 0.0.9", 60.0, double, (21,), {})


def test_no_more_are_under_way_than_a_scheduler_can_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "MOST_UNDER_WAY", 2)
    sent: list[int] = []

    def noted(number: int) -> int:
        sent.append(number)
        return number

    coming = finished(Scripted({}), noted, [(number,) for number in range(5)])

    for count in range(5):
        assert next(coming) == (count, count)
        assert len(sent) == min(5, count + 3)


def test_results_come_in_their_order_where_that_is_asked() -> None:
    tasks = [(number,) for number in range(5)]

    names = [f"trial of seed {number}" for number in range(5)]

    assert list(in_order(Scripted({0: [CancelledError()]}), double, tasks, names)) == [
        0,
        2,
        4,
        6,
        8,
    ]
    with pytest.raises(InputError, match="trial of seed 3: its worker died"):
        list(in_order(Scripted({3: [KilledWorker()] * 3}), double, tasks, names))


@dataclass(frozen=True)
class Came:
    """A result as commands have them."""

    values: np.ndarray
    names: tuple[str, ...]
    gap: float


def came(number: int) -> Came:
    return Came(np.arange(number, dtype=float)[::-1], ("a", str(number)), float("nan"))


def test_what_is_done_is_kept_and_what_is_lost_is_named_after_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tasks = [(number,) for number in range(6)]
    names = [f"trial of seed {number}" for number in range(6)]
    kept = Kept(tmp_path / "kept")
    dying = Watched({1: [TimeoutError()] * 3, 4: [MemoryError()] * 3})

    with pytest.raises(InputError, match="trial of seed 4: it ran out of memory, 3 times"):
        list(in_order(dying, came, tasks, names, kept))
    assert capsys.readouterr().err.splitlines() == [
        "skiplatch: trial of seed 1: it took too long, 3 times",
        f"4 done are kept in {tmp_path / 'kept'}; the same command goes on",
    ]

    (tmp_path / "kept" / kept.key(came, (2,))).write_bytes(b"damaged")
    healthy = Watched({})
    found = list(in_order(healthy, came, tasks, names, kept))

    assert sorted(healthy.sent) == [1, 2, 4]
    assert [one.names for one in found] == [("a", str(number)) for number in range(6)]
    for number, one in enumerate(found):
        np.testing.assert_array_equal(one.values, came(number).values)
    assert len(list((tmp_path / "kept").iterdir())) == 6


class Program:
    """What a folder of answers may hold that somebody else has written."""

    def __init__(self, made: Path) -> None:
        self.made = made

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return os.mkdir, (self.made,)


def test_an_answer_that_is_a_program_is_not_run(tmp_path: Path) -> None:
    kept = Kept(tmp_path / "kept")
    kept.keep("f" * 64, Program(tmp_path / "made"))

    assert kept.recall("f" * 64) is None
    assert not (tmp_path / "made").exists()


def test_a_process_that_dies_costs_only_its_task(two: Executor, tmp_path: Path) -> None:
    found = outcomes(two, die_of_three)

    assert found[:3] + found[4:] == [0, 2, 4, 8]
    assert found[3] == Failed("its worker died, as out of memory or time, 3 times")
    assert outcomes(two, die_the_first_time, tmp_path) == [0, 2, 4, 6, 8]


def test_a_task_that_hangs_is_ended(two: Executor) -> None:
    assert outcomes(two, hang_at_two) == [0, 2, Failed("it took too long, 3 times"), 6, 8]


def test_a_task_that_runs_out_of_memory_is_named(two: Executor) -> None:
    found = outcomes(two, outgrow_at_three, 1 << 60, 0.0)

    assert found == [0, 2, 4, Failed("it ran out of memory, 3 times"), 8]


class Gone:
    """A client of Dask whose scheduler did not come back."""

    status = "closing"


def test_a_scheduler_that_does_not_come_back_is_one_line() -> None:
    executor = executors.Cluster(Gone(), "tcp://head:8786", LIMIT_S)

    with pytest.raises(InputError, match="tcp://head:8786: the scheduler was lost, and did not"):
        outcomes(executor, double)


def test_no_scheduler_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "ANSWER_S", 0.2)

    with (
        pytest.raises(InputError, match="no Dask scheduler answers there within 0"),
        opened(Workers(cluster="tcp://127.0.0.1:9")),
    ):
        pass


def test_without_dask_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "dask", None)

    with (
        pytest.raises(InputError, match=r"distributed: not installed; pip install 'skiplatch\["),
        opened(Workers(cluster="local:1")),
    ):
        pass


@pytest.mark.long
def test_a_worker_of_a_cluster_that_dies_costs_only_time(tmp_path: Path) -> None:
    pytest.importorskip("distributed")

    with opened(Workers(cluster="local:2")) as executor:
        assert outcomes(executor, die_the_first_time, tmp_path) == [0, 2, 4, 6, 8]


def test_workers_here_keep_the_memory_that_they_need_again(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)

    with opened(Workers(cluster="local:1")) as executor:
        found = executor.submit(os.environ.get, "MALLOC_TRIM_THRESHOLD_").result()

    assert found is None


def is_profiled() -> bool:
    """Tell whether the worker that this task runs on looks at its tasks by the clock."""
    from distributed import get_worker  # noqa: PLC0415 - an optional extra

    return "profile" in get_worker().periodic_callbacks


def test_workers_here_do_not_profile_their_tasks() -> None:
    pytest.importorskip("distributed")

    with opened(Workers(cluster="local:1")) as executor:
        assert not executor.submit(is_profiled).result()


def started(*words: str) -> "subprocess.Popen[bytes]":
    """Start a part of a cluster, whose workers know this module."""
    here = {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}
    dask = Path(sys.executable).with_name("dask")
    return subprocess.Popen([dask, *words], env=here, stderr=subprocess.DEVNULL)


@contextmanager
def cluster(port: int, *options: str) -> Iterator[str]:
    """Run a scheduler and a worker with these options, and kill both as a power cut does."""
    address = f"tcp://127.0.0.1:{port}"
    parts = [
        started("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"),
        started("worker", address, "--nthreads", "1", "--no-dashboard", *options),
    ]
    try:
        yield address
    finally:
        for part in parts:
            part.kill()
            part.wait()


@pytest.mark.long
def test_what_a_scheduler_forgot_is_done_once_it_is_back(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    port = free_port()
    found: dict[int, int | Failed] = {}
    with ExitStack() as parts:
        with cluster(port, "--no-nanny") as address:
            executor = parts.enter_context(opened(Workers(cluster=address)))
            coming = finished(executor, wait_for, [(n, tmp_path / "go") for n in range(4)])
            waiting = threading.Thread(target=lambda: found.update(coming))
            waiting.start()
            time.sleep(1.0)
        (tmp_path / "go").touch()
        parts.enter_context(cluster(port, "--no-nanny"))
        waiting.join()

    assert found == {0: 0, 1: 2, 2: 4, 3: 6}


@pytest.mark.long
def test_a_task_that_a_cluster_has_no_memory_or_time_for_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "0")
    lost = Failed("its worker died, as out of memory or time, 3 times")
    with cluster(free_port(), "--nanny", "--memory-limit", "400MB") as address:
        with opened(Workers(cluster=address)) as executor:
            large = outcomes(executor, outgrow_at_three, 600_000_000, 30.0)
        with opened(Workers(cluster=address, limit_s=LIMIT_S)) as executor:
            slow = outcomes(executor, hang_at_two)

    assert large == [0, 2, 4, lost, 8]
    assert slow == [0, 2, lost, 6, 8]
