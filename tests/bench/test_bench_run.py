"""`skiplatch bench run` on the devices: what it is told, and what it leaves behind."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from skiplatch.campaign import read_campaign
from tests.bench.programs import controller
from tests.bench.rig import PROJECT, Line, Rig

PLANS = PROJECT / "scripts" / "samples" / "plans"
PATIENCE_S = 180.0  # Python itself takes seconds to start on an emulated machine
PLAYING_S = 6.0
BAD_INPUT, INTERRUPTED = 2, 130
PLAN = """format = "skiplatch-bench-plan/1"
nominal = "believed.toml"
paths = ["skip"]
touches = {touches}
feeds_mm_min = 3000
scan_us = 4000
rate_per_s = 20
pulse_us = 10000
approach_mm = 0.2
"""


def skiplatch(*arguments: object) -> Sequence[str]:
    """Give the command line of the program."""
    return [sys.executable, "-m", "skiplatch.cli", *map(str, arguments)]


def bench_run(rig: Rig, line: Line, folder: Path, touches: int, /, **changes: str) -> Sequence[str]:
    """Give the command that plays a plan of so many touches, with some options changed."""
    (folder / "believed.toml").write_bytes((PLANS / "believed.toml").read_bytes())
    (folder / "plan.toml").write_text(PLAN.format(touches=touches), encoding="ascii")
    options = {
        "--can": rig.can,
        "--chip": str(rig.chip),
        "--line": str(line.offset),
        "--sim-pull": str(line.pull),
        "--json": str(folder / "run.json"),
        **{f"--{name.replace('_', '-')}": value for name, value in changes.items()},
    }
    pairs = [part for pair in options.items() for part in pair]
    return skiplatch("bench", "run", folder / "plan.toml", "--out", folder / "out", *pairs)


def outcome(command: Sequence[str]) -> tuple[int, str]:
    """Run to the end; return status and complaint."""
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=PATIENCE_S, check=False, cwd=PROJECT
    )
    return done.returncode, done.stderr


def check_refused(status: int, complaint: str, folder: Path, *words: str) -> None:
    """One line that names the remedy, status 2, and nothing left behind."""
    assert status == BAD_INPUT, complaint
    assert len(complaint.splitlines()) == 1, complaint
    for word in words:
        assert word in complaint
    assert not (folder / "out").exists()


def test_a_plan_is_played_under_a_key(rig: Rig, line: Line, tmp_path: Path) -> None:
    path = tmp_path / "bench.key"
    path.touch(mode=0o600)
    path.write_text("00112233445566778899aabbccddeeff\n", encoding="ascii")
    status, complaint = outcome(bench_run(rig, line, tmp_path, 5, key=str(path)))

    assert status == 0, complaint
    report = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert report["complete"] is True
    assert report["campaigns"][0]["touches"] == 5
    assert report["campaigns"][0]["without_edge"] == 0
    check_nothing_runs_on()


def test_ctrl_c_leaves_a_valid_campaign(rig: Rig, line: Line, tmp_path: Path) -> None:
    command = bench_run(rig, line, tmp_path, 2000)
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=PROJECT
    ) as playing:
        try:
            wait_for_touches(playing)
            playing.send_signal(signal.SIGINT)
            _, errors = playing.communicate(timeout=PATIENCE_S)
        finally:
            playing.kill()

    assert playing.returncode == INTERRUPTED, errors
    assert errors.splitlines()[-1] == "interrupted"
    report = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert report["complete"] is False
    assert 10 < report["campaigns"][0]["touches"] < 2000
    assert len(read_campaign(tmp_path / "out").touches) == report["campaigns"][0]["touches"]
    # A diagnosis would take minutes on an emulated processor; this begins as one does.
    status, complaint = outcome(skiplatch("compare", tmp_path / "out"))
    assert status == 0, complaint
    keep(tmp_path / "out")
    check_nothing_runs_on()
    with controller(rig, line) as free:
        assert free.is_running(), "the line is free again"


def keep(campaign: Path) -> None:
    """Leave it where the host finds it: skiplatch diagnose build/bench-vm/interrupted."""
    if "BENCH_OUT" in os.environ:
        shutil.copytree(campaign, Path(os.environ["BENCH_OUT"], "interrupted"), dirs_exist_ok=True)


def wait_for_touches(playing: subprocess.Popen[str]) -> None:
    """Wait until the programs of the bench run, and then for some touches."""
    end_s = time.monotonic() + PATIENCE_S
    while not running_programs():
        assert playing.poll() is None, playing.communicate()
        assert time.monotonic() < end_s
        time.sleep(0.2)
    time.sleep(PLAYING_S)


def running_programs() -> list[str]:
    """Give the command lines of the controllers that run."""
    found = []
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # it has just ended
            found.append(file.read_text(errors="replace"))
    return [line for line in found if "skiplatch-controller\0--" in line]


def check_nothing_runs_on() -> None:
    """The programs that the bench started have ended with it."""
    assert running_programs() == []


def test_a_line_that_somebody_has_is_told_with_who_has_it(
    rig: Rig, line: Line, tmp_path: Path
) -> None:
    with controller(rig, line) as first:
        status, complaint = outcome(bench_run(rig, line, tmp_path, 5))
        assert first.is_running()

    check_refused(status, complaint, tmp_path, "in use", "skiplatch-controller")


def test_an_interface_that_is_down_is_told_with_the_command(
    rig: Rig, line: Line, tmp_path: Path
) -> None:
    rig.set_link(up=False)
    status, complaint = outcome(bench_run(rig, line, tmp_path, 5))

    check_refused(status, complaint, tmp_path, f"ip link set {rig.can} up")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"can": "can99"}, ("can99", "modprobe vcan", "ip link add")),
        ({"chip": "gpiochip99"}, ("gpiochip99", "gpiodetect")),
        ({"line": "4000"}, ("4000", "gpioinfo")),
        ({"sim_pull": "/sys/no/pull"}, ("/sys/no/pull", "modprobe gpio-sim")),
    ],
)
def test_what_is_not_there_is_told_with_the_way_to_it(
    rig: Rig, line: Line, tmp_path: Path, changes: dict[str, str], words: tuple[str, ...]
) -> None:
    status, complaint = outcome(bench_run(rig, line, tmp_path, 5, **changes))

    check_refused(status, complaint, tmp_path, *words)
