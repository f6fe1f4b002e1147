"""``skiplatch bench`` end to end on a virtual bus, with injector and controller of Python."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cantools
import numpy as np
import pytest
from click.testing import CliRunner, Result

from bench_rig import FakeBench, Faults
from documents import ROOT, examples
from skiplatch import cli
from skiplatch.bench import processes, run, station
from skiplatch.bench.protocol import Kind, Verdict
from skiplatch.bench.recording import VirtualAxis
from skiplatch.campaign import read_campaign
from skiplatch.errors import InputError

PLANS = Path(__file__).parents[2] / "scripts" / "samples" / "plans"
FEED = 600.0
BUSY = """
[load]
cpu_share = 0.02
cpu_period_us = 7300
"""
PLAN = """format = "skiplatch-bench-plan/1"
nominal = "believed.toml"
paths = ["skip"]
touches = {touches}
feeds_mm_min = 600
scan_us = {scan_us}
rate_per_s = 25
pulse_us = 2000
approach_mm = 0.1
"""


@pytest.fixture
def channel(request: pytest.FixtureRequest) -> str:
    return str(request.node.name)


@pytest.fixture(autouse=True)
def interruptible() -> Iterator[None]:
    """What a shell starts in the background ignores Ctrl-C, and so would the tests of it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "LATCH_PATIENCE_S", 0.1)
    monkeypatch.setattr(run, "EDGE_PATIENCE_S", 0.3)
    monkeypatch.setattr(station, "ANSWER_S", 0.5)


@pytest.fixture
def plan(tmp_path: Path) -> Callable[..., Path]:
    def written(touches: int = 12, scan_us: str = "1000") -> Path:
        (tmp_path / "believed.toml").write_text((PLANS / "believed.toml").read_text())
        (tmp_path / "plan.toml").write_text(PLAN.format(touches=touches, scan_us=scan_us))
        return tmp_path / "plan.toml"

    return written


def bench(*arguments: object) -> Result:
    return CliRunner().invoke(cli.group, ["bench", *map(str, arguments)])


def play(plan: Path, channel: str, *arguments: object) -> Result:
    out = plan.parent / "out"
    fixed = ("--can-backend", "virtual", "--attached", "--can", channel, "--out", out)
    return bench("run", plan, *fixed, *arguments)


@pytest.mark.parametrize("command", ["run", "monitor", "believe"])
def test_help_has_an_example(command: str) -> None:
    text = bench(command, "--help").output

    assert f"  skiplatch bench {command} " in text
    assert "--json" in text
    assert ("--seed" in text) == (command != "monitor")


def test_plan_becomes_a_campaign(plan: Callable[..., Path], channel: str) -> None:
    with FakeBench(channel, delay_us=50.0, feed_mm_min=FEED) as fake:
        result = play(plan(), channel, "--json", plan().parent / "a.json")

    assert result.exit_code == 0, result.output
    touches = read_campaign(plan().parent / "out").touches
    assert len(touches) == fake.triggers == 12
    assert touches.ok.all()
    after_us = touches.latch_us - touches.edge_us
    assert np.all((after_us > 49.8) & (after_us <= 50.0))  # rounded down to a tick
    assert np.all(np.abs(touches.deviation_um - 0.5) < 0.11)  # 10 mm/s for 50 µs
    # One that is played late, on a busy machine, is nearer to the next: most are not.
    assert np.median(np.diff(touches.time_s)) > 0.03
    document: dict[str, Any] = json.loads((plan().parent / "a.json").read_text())
    assert document["complete"] is True
    assert document["campaigns"][0]["touches"] == 12
    assert fake.commands[-1]["Kind"] == Kind.DISARM


def test_session_of_the_page_hears_its_edge_and_its_latch(
    channel: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """On a virtual bus in place of the kernel's."""
    _, session, encoding = [
        one.text for one in examples(ROOT / "docs/INJECTION.md") if one.language == "python"
    ]
    virtual = session.replace("socketcan", "virtual").replace("vcan0", channel)
    assert virtual != session

    with FakeBench(channel) as fake:
        exec(compile(virtual, "INJECTION.md", "exec"), {})  # noqa: S102 - the page's own

    assert "Edge(" in capsys.readouterr().out
    assert fake.triggers == 1
    known: dict[str, object] = {"cantools": cantools}
    exec(compile(encoding, "INJECTION.md", "exec"), known)  # noqa: S102 - the page's own
    assert known["database"]


def test_restart_of_the_controller_loses_no_touch_and_is_told(
    plan: Callable[..., Path], channel: str
) -> None:
    with FakeBench(channel, Faults(restarts={4, 9}), feed_mm_min=FEED):
        result = play(plan(), channel, "--json", plan().parent / "a.json")

    assert result.exit_code == 0, result.output
    assert read_campaign(plan().parent / "out").touches.ok.all()
    document: dict[str, Any] = json.loads((plan().parent / "a.json").read_text())
    assert document["campaigns"][0]["restarts"] == 2
    assert "2 restarts of the controller" in result.stderr


def test_restart_is_told_by_the_monitor(channel: str) -> None:
    def latch_and_restart(fake: FakeBench, stopped: threading.Event) -> None:
        while not stopped.wait(0.03):
            fake.latch(time.monotonic_ns())
            fake.restart()

    stopped = threading.Event()
    with FakeBench(channel) as fake:
        sender = threading.Thread(target=latch_and_restart, args=(fake, stopped))
        sender.start()
        options = ("--can-backend", "virtual", "--latches", "3", "--quiet-injector")
        result = bench("monitor", channel, *options)
        stopped.set()
        sender.join()

    assert result.exit_code == 0, result.output
    assert "the controller has started anew; records lost up to now: 0" in result.output
    assert re.search(r"^restarts +[2-9]$", result.output, re.MULTILINE)


def test_delays_fall_anywhere_in_a_scan_and_follow_the_seed(
    plan: Callable[..., Path], channel: str, tmp_path: Path
) -> None:
    delays = []
    for number, seed in enumerate((3, 3, 4)):
        with FakeBench(channel, feed_mm_min=FEED) as fake:
            out = ("--out", tmp_path / f"out{number}", "--seed", seed)
            result = play(plan(), channel, *out)
        assert result.exit_code == 0, result.output
        delays.append([c["DelayUs"] for c in fake.commands if c["Kind"] == Kind.TRIGGER])

    assert delays[0] == delays[1] != delays[2]
    assert max(delays[0]) < 1000
    assert len(set(delays[0])) > 6


def test_delays_fall_anywhere_in_the_period_of_the_busy_process_too(
    plan: Callable[..., Path], channel: str
) -> None:
    path = plan(24)
    path.write_text(path.read_text() + BUSY)
    with FakeBench(channel, feed_mm_min=FEED) as fake:
        result = play(path, channel)

    assert result.exit_code == 0, result.output
    delays_us = [c["DelayUs"] for c in fake.commands if c["Kind"] == Kind.TRIGGER]
    assert max(delays_us) > 6000
    assert max(delays_us) < 7300 + 1000
    assert min(delays_us) < 2000


def test_several_scan_periods_make_a_campaign_each(plan: Callable[..., Path], channel: str) -> None:
    path = plan(3, "[1000, 2000]")
    with FakeBench(channel, feed_mm_min=FEED):
        result = play(path, channel)

    assert result.exit_code == 0, result.output
    for scan_us in (1000, 2000):
        campaign = read_campaign(path.parent / "out" / f"scan_{scan_us}_us")
        assert campaign.nominal.plc.scan_us == scan_us
        assert len(campaign.touches) == 3


def test_missed_and_false_latches_stand_in_the_campaign(
    plan: Callable[..., Path], channel: str
) -> None:
    with FakeBench(channel, Faults(missed={3}, doubled={5}), feed_mm_min=FEED):
        result = play(plan(8), channel)

    assert "8 touches, 1 missed, 1 false" in result.output
    touches = read_campaign(plan().parent / "out").touches
    assert touches.missed.tolist().index(True) == 2
    assert touches.false.tolist().index(True) == 5
    assert np.isnan(touches.edge_us[touches.false]).all()


def test_touch_that_took_long_does_not_push_the_next_ones_together(
    plan: Callable[..., Path], channel: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "LATCH_PATIENCE_S", 0.3)  # as long as seven touches
    with FakeBench(channel, Faults(missed={2}), feed_mm_min=FEED):
        result = play(plan(8), channel)

    assert result.exit_code == 0, result.output
    steps_s = np.diff(read_campaign(plan().parent / "out").touches.time_s)
    assert steps_s[1] > 0.3
    assert np.median(steps_s[2:]) > 0.03


def test_edge_report_that_is_lost_leaves_its_cell_empty(
    plan: Callable[..., Path], channel: str
) -> None:
    with FakeBench(channel, Faults(damaged_edges={2}), feed_mm_min=FEED):
        result = play(plan(4), channel)

    assert result.exit_code == 0, result.output
    touches = read_campaign(plan().parent / "out").touches
    assert np.isnan(touches.edge_us).tolist() == [False, True, False, False]
    assert np.isnan(touches.deviation_um).tolist() == [False, True, False, False]
    assert touches.ok.all()


@pytest.mark.parametrize(
    "verdict", [Verdict.UNARMED, Verdict.WRONG_TOKEN, Verdict.INCOMPLETE, Verdict.BUSY]
)
def test_refused_trigger_is_armed_for_anew_and_played_once(
    plan: Callable[..., Path], channel: str, verdict: Verdict
) -> None:
    with FakeBench(channel, Faults(refused={5: verdict}), feed_mm_min=FEED) as fake:
        result = play(plan(4), channel)

    assert result.exit_code == 0, result.output
    assert fake.triggers == 4
    assert sum(command["Kind"] == Kind.ARM for command in fake.commands) == 2


def test_token_that_expired_meanwhile_is_asked_for_anew(
    plan: Callable[..., Path], channel: str
) -> None:
    with FakeBench(channel, Faults(expired={2}), feed_mm_min=FEED) as fake:
        result = play(plan(4), channel)

    assert result.exit_code == 0, result.output
    assert fake.triggers == 4
    assert sum(command["Kind"] == Kind.ARM for command in fake.commands) == 2


def test_trigger_whose_answer_is_lost_is_not_played_twice(
    plan: Callable[..., Path], channel: str
) -> None:
    with FakeBench(channel, Faults(mute_answers={5}), feed_mm_min=FEED) as fake:
        result = play(plan(4), channel)

    assert result.exit_code == 0, result.output
    assert fake.triggers == 4
    assert read_campaign(plan().parent / "out").touches.ok.all()


def test_injector_that_always_refuses_ends_in_one_line_and_keeps_what_was_played(
    plan: Callable[..., Path], channel: str
) -> None:
    refused = dict.fromkeys(range(8, 100), Verdict.BUSY)
    with FakeBench(channel, Faults(refused=refused), feed_mm_min=FEED):
        result = play(plan(9), channel, "--json", plan().parent / "a.json")

    assert isinstance(result.exception, InputError)
    assert "refuses to trigger: busy" in str(result.exception)
    assert len(read_campaign(plan().parent / "out").touches) == 4
    assert json.loads((plan().parent / "a.json").read_text())["complete"] is False


def test_silent_injector_is_told_with_what_to_start(
    plan: Callable[..., Path], channel: str
) -> None:
    with FakeBench(channel, Faults(is_silent=True)):
        result = play(plan(), channel)

    assert isinstance(result.exception, InputError)
    assert "start skiplatch-injector --can" in str(result.exception)
    assert not (plan().parent / "out").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupt_leaves_a_valid_campaign(
    plan: Callable[..., Path], channel: str, number: signal.Signals
) -> None:
    path = plan(1000)

    def interrupt_later(fake: FakeBench) -> None:
        while fake.triggers < 5:
            time.sleep(0.01)
        os.kill(os.getpid(), number)

    with FakeBench(channel, feed_mm_min=FEED) as fake:
        killer = threading.Thread(target=interrupt_later, args=(fake,))
        killer.start()
        result = play(path, channel, "--json", path.parent / "a.json")
        killer.join()

    assert result.exit_code == 130
    assert "interrupted" in result.output
    assert 4 <= len(read_campaign(path.parent / "out").touches) <= 6
    assert json.loads((path.parent / "a.json").read_text())["complete"] is False


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--can", "vcan0"], "--chip and --line are missing"),
        (["--can", "vcan0", "--chip", "x", "--line", "0"], "give one of --inject-line and"),
        (["--chip", "x", "--line", "0"], "Missing option '--can'"),
        (["--can", "vcan0", "--attached", "--latch-id", "0x800"], "expected a CAN id from 0 to"),
    ],
)
def test_incomplete_rig_is_told_and_ends_with_2(
    plan: Callable[..., Path], tmp_path: Path, arguments: list[str], message: str
) -> None:
    result = bench("run", plan(), "--out", tmp_path / "out", *arguments)

    assert result.exit_code == 2
    assert message in result.output


@pytest.mark.parametrize("interface", ["nosuchcan0", "../net", "a/b"])
def test_unknown_interface_is_told_with_its_remedy(interface: str) -> None:
    result = bench("monitor", interface)

    assert isinstance(result.exception, InputError)
    assert "no such CAN interface" in str(result.exception)
    assert "ip link add" in str(result.exception)


def test_interface_without_can_is_told_as_such() -> None:
    result = bench("monitor", "lo")

    assert isinstance(result.exception, InputError)
    assert str(result.exception).startswith("lo: ")


def test_folder_that_is_occupied_is_refused_before_anything_is_played(
    plan: Callable[..., Path], channel: str
) -> None:
    (plan().parent / "out").mkdir()
    (plan().parent / "out" / "x").touch()
    with FakeBench(channel) as fake:
        result = play(plan(), channel)

    assert "not an empty folder" in str(result.exception)
    assert fake.commands == []


def test_monitor_shows_latches_and_counters(channel: str, tmp_path: Path) -> None:
    with FakeBench(channel) as fake:
        stopped = threading.Event()

        def latch_now_and_then() -> Iterator[None]:
            while not stopped.wait(0.03):
                fake.latch(time.monotonic_ns())
                yield

        sender = threading.Thread(target=lambda: list(latch_now_and_then()))
        sender.start()
        result = bench(
            *("monitor", channel, "--can-backend", "virtual", "--latches", 3),
            *("--json", tmp_path / "m.json"),
        )
        stopped.set()
        sender.join()

    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert all("skip  record" in line for line in lines[:3])
    document: dict[str, Any] = json.loads((tmp_path / "m.json").read_text())
    assert document["latches"] >= 3
    assert document["lost_latches"] == 0
    assert document["injector"]["Obeyed"] == 10
    assert document["injector"]["DroppedFrames"] == 61


def test_monitor_ends_when_its_time_is_up(channel: str) -> None:
    fixed = ("--can-backend", "virtual", "--seconds", 0.1, "--quiet-injector")
    result = bench("monitor", channel, *fixed)

    assert result.exit_code == 0
    assert "latches                  0" in result.output


def test_way_of_the_virtual_axis_survives_the_wrap_of_its_counter() -> None:
    axis = VirtualAxis(feed_mm_min=3000.0, resolution_um=0.1)
    wrap_ns = round(2**32 / (3000 / 60 * 1000 / 0.1 / 1e9))

    for since_ns in (0, wrap_ns - 500_000, 7 * wrap_ns + 123_456):
        counts = int((since_ns + 1_000_000) * 5e-4) % 2**32
        signed = counts - 2**32 if counts >= 2**31 else counts
        assert axis.travel_um(signed, since_ns) == pytest.approx(50.0, abs=0.11)


def script(tmp_path: Path, text: str) -> list[str]:
    (tmp_path / "program.py").write_text(text)
    return [sys.executable, str(tmp_path / "program.py")]


def test_program_that_refuses_to_start_is_told_in_its_own_words(tmp_path: Path) -> None:
    text = "import sys; print('tool: line in use', file=sys.stderr); sys.exit(2)"
    with pytest.raises(InputError) as caught, processes.Program("tool", script(tmp_path, text)):
        pass

    assert str(caught.value) == "tool: line in use"


def test_program_that_is_not_there_is_told() -> None:
    with pytest.raises(InputError, match="cannot be started"), processes.Program("x", ["/no/x"]):
        pass


def test_counters_of_a_program_are_taken_when_it_ends(tmp_path: Path) -> None:
    text = (
        "import signal\n"
        "try:\n  print('ready', flush=True)\n  signal.pause()\n"
        "except KeyboardInterrupt: print('{\"edges\": 3}')\n"
    )
    with processes.Program("tool", script(tmp_path, text)) as program:
        program.check()

    assert program.counters == {"edges": 3}


def test_program_that_dies_meanwhile_is_noticed(tmp_path: Path) -> None:
    text = "import sys; print('ready', flush=True); sys.exit('tool: chip removed')"
    with processes.Program("tool", script(tmp_path, text)) as program:
        time.sleep(0.5)
        with pytest.raises(InputError, match="chip removed"):
            program.check()


def test_busy_process_takes_its_share_and_says_what_it_lacks() -> None:
    with processes.module("skiplatch.bench.busy", "0", "0.5", "10000", "0") as program:
        assert program._process is not None
        start = os.times()
        time.sleep(0.5)
        used = Path(f"/proc/{program._process.pid}/stat").read_text().split()
        elapsed = os.times().elapsed - start.elapsed
    assert int(used[13]) / os.sysconf("SC_CLK_TCK") > 0.1 * elapsed

    with (
        pytest.raises(InputError, match="run as root, or set load"),
        processes.module("skiplatch.bench.busy", "100000", "0.5", "1000", "0"),
    ):
        pass


def test_program_of_the_command_line_ends_with_2_and_one_line(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "skiplatch.cli", "bench", "monitor", "nosuchcan0"],
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("skiplatch: nosuchcan0: ")
