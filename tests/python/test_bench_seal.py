"""Sealed commands: SipHash in both languages, and the host beside the firmware's own guard."""

import os
import subprocess
from pathlib import Path

import can
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from siphash24 import siphash24

from bench_rig import CODEC, GuardedBench
from skiplatch import cli
from skiplatch.bench import run, station
from skiplatch.bench.protocol import Kind, Verdict
from skiplatch.bench.run import Rig
from skiplatch.bench.seal import read_key
from skiplatch.bench.station import Pulse, Station
from skiplatch.errors import InputError

KEY = bytes.fromhex("00112233445566778899aabbccddeeff")
OTHER_KEY = bytes.fromhex("00112233445566778899aabbccddeefe")
PULSE = Pulse(line=0, level=1, width_us=1000)
INJECTOR = Path(__file__).parents[2] / "build" / "host" / "skiplatch-injector"
BAD = {
    "short": b"0" * 31,
    "long": b"0" * 33,
    "empty": b"",
    "no digit": b"0" * 31 + b"g",
    "sign": b"+" + b"0" * 31,
    "spaces": b" " + b"0" * 31,
    "two lines": b"0" * 32 + b"\n\n",
    "a carriage return": b"0" * 32 + b"\r",
    "not ASCII": "٣".encode() * 16,
}


@pytest.fixture
def channel(request: pytest.FixtureRequest) -> str:
    return str(request.node.name)


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(station, "ANSWER_S", 0.3)


def key_file(folder: Path, content: bytes, mode: int = 0o600) -> Path:
    path = folder / "bench.key"
    path.write_bytes(content)
    path.chmod(mode)
    return path


def play(channel: str, bench: GuardedBench, key: bytes | None, count: int) -> None:
    """Connect and trigger so often."""
    with can.Bus(interface="virtual", channel=channel) as bus:
        host = Station(bus, channel, key=key)
        host.connect()
        for _ in range(count):
            host.trigger(PULSE, 0)
            host.listen(1.0, lambda: host.edges)
            host.edges.clear()


def kinds(bench: GuardedBench) -> list[Kind]:
    return [Kind(frame[0]) for frame in bench.heard]


# ---- the sum ----


@given(st.binary(min_size=16, max_size=16), st.lists(st.binary(max_size=80), max_size=50))
def test_siphash_is_the_same_in_both_languages(key: bytes, texts: list[bytes]) -> None:
    lines = "".join(f"siphash {key.hex()}{text.hex()}\n" for text in texts)
    done = subprocess.run([CODEC], input=lines, capture_output=True, text=True, check=True)

    assert done.stdout.split() == [siphash24(text, key=key).digest()[::-1].hex() for text in texts]


# ---- host and guard ----


def test_a_host_with_the_key_triggers_past_the_wrap_of_the_counter(channel: str) -> None:
    with GuardedBench(channel, KEY) as bench:
        play(channel, bench, KEY, 140)

    assert bench.triggers == 140
    assert set(bench.verdicts) == {Verdict.OBEYED}
    assert kinds(bench).count(Kind.ARM) == 1


def test_a_host_without_the_key_triggers_nothing_and_is_told_what_to_do(channel: str) -> None:
    with GuardedBench(channel, KEY) as bench, pytest.raises(InputError) as error:
        play(channel, bench, None, 1)

    assert bench.triggers == 0
    assert str(error.value).endswith("refuses to trigger: forged; it has a key: give --key FILE")


def test_a_host_with_another_key_triggers_nothing(channel: str) -> None:
    with GuardedBench(channel, KEY) as bench, pytest.raises(InputError) as error:
        play(channel, bench, OTHER_KEY, 1)

    assert bench.triggers == 0
    assert bench.verdicts.count(Verdict.FORGED) == 3
    assert str(error.value).endswith("refuses to trigger: forged; it has another key")


def test_a_host_with_a_key_arms_no_injector_without_one(channel: str) -> None:
    with GuardedBench(channel) as bench, pytest.raises(InputError) as error:
        play(channel, bench, KEY, 1)

    assert Kind.ARM not in kinds(bench)
    assert str(error.value).endswith("the injector has no key; start it with --key FILE")


def test_without_a_key_nothing_is_sealed(channel: str) -> None:
    with GuardedBench(channel) as bench:
        play(channel, bench, None, 3)

    assert bench.triggers == 3
    assert kinds(bench) == [Kind.ASK, Kind.ARM, Kind.PULSE, Kind.TRAIN, *[Kind.TRIGGER] * 3]


@pytest.mark.parametrize("way", ["drops", "mutes"])
@pytest.mark.parametrize("number", range(2, 11))
def test_a_lost_frame_costs_time_and_never_plays_twice(channel: str, way: str, number: int) -> None:
    """Command by command: challenge, SEAL, ARM, PULSE, TRAIN, SEAL, TRIGGER, SEAL, TRIGGER."""
    with GuardedBench(channel, KEY) as bench:
        getattr(bench, way).add(number)
        play(channel, bench, KEY, 2)

    assert bench.triggers == 2


def test_a_recorded_session_played_again_triggers_nothing(channel: str) -> None:
    with GuardedBench(channel, KEY) as bench:
        play(channel, bench, KEY, 2)
        before = bench.triggers
        with can.Bus(interface="virtual", channel=channel) as bus:
            for _ in range(2):
                for frame in [*bench.heard]:
                    bus.send(can.Message(arbitration_id=0x300, data=frame, is_extended_id=False))
            host = Station(bus, channel, key=KEY)
            host.connect()

    assert before == bench.triggers == 2


def test_forged_commands_are_among_the_counts(channel: str) -> None:
    with GuardedBench(channel, KEY) as bench, can.Bus(interface="virtual", channel=channel) as bus:
        with pytest.raises(InputError):
            play(channel, bench, None, 1)
        assert Station(bus, channel, key=KEY).counts()["Forged"] == 3
        assert "Forged" not in Station(bus, channel).counts()


# ---- the file ----


@pytest.mark.parametrize("ending", [b"", b"\n", b"\r\n"])
def test_a_key_is_32_digits_of_either_case(tmp_path: Path, ending: bytes) -> None:
    digits = b"00112233445566778899AABBCCddeeff"

    assert read_key(key_file(tmp_path, digits + ending, 0o400)) == KEY


@pytest.mark.parametrize("mode", [0o604, 0o640, 0o602, 0o620, 0o601, 0o610])
def test_a_key_that_others_may_read_or_change_is_refused(tmp_path: Path, mode: int) -> None:
    path = key_file(tmp_path, KEY.hex().encode(), mode)
    with pytest.raises(InputError) as error:
        read_key(path)

    assert str(error.value) == f"{path}: others may read or change this key; chmod 600 it"


@pytest.mark.parametrize("bad", BAD)
def test_a_bad_key_is_refused_and_never_shown(tmp_path: Path, bad: str) -> None:
    path = key_file(tmp_path, BAD[bad])
    with pytest.raises(InputError) as error:
        read_key(path)

    assert str(error.value) == f"{path}: not a key: expected 32 hexadecimal digits"


def test_the_commands_refuse_a_bad_key_in_one_line(tmp_path: Path) -> None:
    path = key_file(tmp_path, KEY.hex().encode(), 0o644)
    plan = Path(__file__).parents[2] / "scripts" / "samples" / "plans" / "nominal.toml"
    rig = ["--can", "none", "--attached", "--out", str(tmp_path / "out")]
    for command in (["run", str(plan), *rig], ["monitor", "none", "--can-backend", "virtual"]):
        result = CliRunner().invoke(cli.group, ["bench", *command, "--key", str(path)])

        assert isinstance(result.exception, InputError)
        assert "chmod 600" in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_the_injector_that_is_started_gets_the_file_and_not_the_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    got: list[str] = []
    monkeypatch.setattr(run, "compiled", lambda *words: got.extend(words))
    path = key_file(tmp_path, KEY.hex().encode())
    run.injector(Rig("can0", "gpiochip0", 0, False, ("--line", "x:1"), 0x181, key_path=path))

    assert got[-2:] == ["--key", str(path)]
    assert not any(KEY.hex() in word for word in got)


needs_injector = pytest.mark.skipif(
    not INJECTOR.is_file(), reason="skiplatch-injector is not built: no libgpiod 2 here"
)


def injector_says(path: Path) -> str:
    """Start the injector on an interface that is not there; give its one line."""
    command = [str(INJECTOR), "--can", "absent0", "--line", "absent:0", "--key", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    return line.removeprefix("skiplatch-injector: ")


@needs_injector
@pytest.mark.parametrize("bad", BAD)
def test_the_injector_refuses_the_same_keys(tmp_path: Path, bad: str) -> None:
    path = key_file(tmp_path, BAD[bad])

    assert injector_says(path) == f"{path}: not a key: expected 32 hexadecimal digits"


@needs_injector
def test_the_injector_refuses_what_is_open_or_special_or_missing(tmp_path: Path) -> None:
    path = key_file(tmp_path, KEY.hex().encode(), 0o640)
    assert injector_says(path) == f"{path}: others may read or change this key; chmod 600 it"
    path.unlink()
    assert injector_says(path) == f"{path}: No such file or directory"
    os.mkfifo(path, 0o600)
    assert injector_says(path) == f"{path}: not a regular file"


@needs_injector
@pytest.mark.parametrize("ending", [b"", b"\n", b"\r\n"])
def test_the_injector_takes_a_good_key(tmp_path: Path, ending: bytes) -> None:
    path = key_file(tmp_path, b"00112233445566778899AABBCCddeeff" + ending)

    assert "CAN" in injector_says(path)  # it has come to the interface, which is not there
