"""``skiplatch transmission``: planted errors found, gear trains told apart, bad files named."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from skiplatch import cli
from skiplatch.errors import InputError
from skiplatch.transmission.pulses import Pulses, read_pulses, write_binary, write_csv
from skiplatch.transmission.simulated import Encoder, Gear, GearStage, Machine, simulated_pulses
from skiplatch.transmission.spectrum import fit_orders

ARCSEC_PER_TURN = 1_296_000.0
ARCSEC_PER_RAD = 206_264.806
RATIO, LINES1, LINES2, SPEED = 40.7, 1024, 3600, 5.0
OPTIONS = ("--lines1", "1024", "--lines2", "3600", "--ratio", "407/10")
PLANTED = ((1.0, 4.0, 20.0), (40.7, 0.785, 100.0))
"""Order, amplitude in arcsec, phase in degrees: 9.57 arcsec peak to peak."""

TRAIN = """
[[stage]]
name = "worm and wheel"
driver_teeth = 1
driven_teeth = 37

[[stage]]
name = "spur gears"
driver_teeth = 10
driven_teeth = 11
"""


def planted(
    turns: float, waves: Sequence[tuple[float, float, float]] = PLANTED, tick_ns: int = 100
) -> Pulses:
    """Pulses of a train with an error that is known, straight from what it means."""
    input_s = np.arange(int(turns * RATIO * LINES1)) / LINES1 / SPEED
    turn = np.arange(int(turns * LINES2)) / LINES2
    error = sum(a * np.sin(2.0 * np.pi * o * turn + np.deg2rad(p)) for o, a, p in waves)
    output_s = (turn - error / ARCSEC_PER_TURN) * RATIO / SPEED
    return merged(input_s + 0.001, output_s + 0.001, tick_ns)


def merged(
    input_s: NDArray[np.float64], output_s: NDArray[np.float64], tick_ns: int = 100
) -> Pulses:
    channel = np.concatenate([np.full(len(input_s), 1), np.full(len(output_s), 2)])
    t_s = np.concatenate([input_s, output_s])
    t_ns = (np.floor(t_s * 1e9 / tick_ns) * tick_ns).astype(np.int64)
    order = np.argsort(t_ns, kind="stable")
    return Pulses(channel[order].astype(np.uint8), t_ns[order])


def run(folder: Path, *options: str, pulses: str = "pulses.bin") -> dict[str, Any]:
    out = folder / "out.json"
    arguments = ["transmission", str(folder / pulses), *OPTIONS, "--json", str(out), *options]
    result = CliRunner().invoke(cli.group, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    found: dict[str, Any] = json.loads(out.read_text())
    return found


def nearest(found: dict[str, Any], order: float) -> dict[str, Any]:
    orders: list[dict[str, Any]] = found["orders"]
    return min(orders, key=lambda each: abs(each["order"] - order))


@pytest.mark.parametrize("write", [write_csv, write_binary])
def test_planted_orders_are_found_where_they_are(
    tmp_path: Path, write: Callable[[Path, Sequence[Pulses]], int]
) -> None:
    write(tmp_path / "pulses.bin", [planted(6.0)])

    found = run(tmp_path)

    for order, amplitude, phase in PLANTED:
        seen = nearest(found, order)
        assert seen["order"] == pytest.approx(order, abs=1e-4)
        assert seen["amplitude_arcsec"] == pytest.approx(amplitude, rel=0.02)
        assert seen["phase_deg"] == pytest.approx(phase, abs=0.5)
    assert found["orders"][0]["order"] == pytest.approx(1.0, abs=1e-4)
    assert found["total_arcsec"] == pytest.approx(9.57, abs=0.04)  # 0.02 on either side
    assert found["noise_arcsec"] < 0.02
    assert (found["missing_pulses"], found["extra_pulses"]) == (0, 0)


def test_direct_counting_stays_within_its_quantum(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(3.0)])

    direct, subdivided = run(tmp_path, "--method", "direct"), run(tmp_path)

    quantum = ARCSEC_PER_TURN / (RATIO * LINES1)
    assert 1.0 < direct["noise_arcsec"] < quantum
    assert subdivided["total_arcsec"] < direct["total_arcsec"] < 9.6 + 1.01 * quantum


@pytest.mark.long
def test_equal_lines_of_a_straight_drive_suit_all_five_methods(tmp_path: Path) -> None:
    turn = np.arange(40_000) / 1000
    error = 30.0 * np.sin(2.0 * np.pi * turn) / ARCSEC_PER_TURN
    write_binary(tmp_path / "pulses.bin", [merged(turn / SPEED, (turn - error) / SPEED + 1e-4, 1)])
    options = ("--lines1", "1000", "--lines2", "1000", "--ratio", "1", "--meter-ms", "4")
    out = tmp_path / "methods.json"
    arguments = ["transmission", str(tmp_path / "pulses.bin"), *options, "--all-methods"]
    result = CliRunner().invoke(cli.group, [*arguments, "--json", str(out)])
    assert result.exit_code == 0, result.output

    methods = {each["method"]: each for each in json.loads(out.read_text())["methods"]}

    assert len(methods) == 5
    for name, found in methods.items():
        if name != "direct":  # whose line is of 1296 arcsec
            assert found["orders"][0]["order"] == pytest.approx(1.0, abs=1e-3), name
            assert found["orders"][0]["amplitude_arcsec"] == pytest.approx(30.0, rel=0.05), name


def test_a_method_that_finds_no_point_says_so_beside_the_others(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(0.2)])

    found = run(tmp_path, "--all-methods")

    faults = {each["method"] for each in found["methods"] if "fault" in each}
    assert faults == {"phase-digital", "phase-analog"}  # whose divided period is a third of a turn


def test_a_missing_and_an_extra_pulse_are_told_and_not_integrated(tmp_path: Path) -> None:
    clean = planted(4.0)
    inputs = np.flatnonzero(clean.channel == 1)
    dropped = np.delete(np.arange(len(clean)), inputs[50_000])
    at = int(np.searchsorted(dropped, inputs[90_000]))
    channel, t_ns = clean.channel[dropped], clean.t_ns[dropped]
    middle = (t_ns[at] + clean.t_ns[inputs[90_001]]) // 2
    place = int(np.searchsorted(t_ns, middle))
    spoilt = Pulses(np.insert(channel, place, np.uint8(1)), np.insert(t_ns, place, middle))
    write_binary(tmp_path / "pulses.bin", [spoilt])

    found = run(tmp_path)

    assert (found["missing_pulses"], found["extra_pulses"]) == (1, 1)
    assert found["total_arcsec"] == pytest.approx(9.57, abs=0.04)
    assert abs(found["drift_arcsec_per_turn"]) < 0.01


def test_a_gear_train_shows_its_eccentricity_its_mesh_and_its_play(tmp_path: Path) -> None:
    stages = (
        GearStage(
            driver=Gear(teeth=1),
            driven=Gear(teeth=37, eccentricity_um=10.0, mesh_um=1.5),
            module_mm=2.0,
            play_um=10.0,
        ),
        GearStage(driver=Gear(teeth=10), driven=Gear(teeth=11), module_mm=2.0),
    )
    machine = Machine(
        stages=stages, turns=244.2, both_senses=True, speed_ripple=0.02, speed_ripple_hz=7.3
    )
    write_binary(tmp_path / "pulses.bin", simulated_pulses(machine))
    (tmp_path / "train.toml").write_text(TRAIN)

    found = run(tmp_path, "--train", str(tmp_path / "train.toml"))

    at_output = ARCSEC_PER_RAD / 37_000.0 * 10.0 / 11.0  # of a µm on the wheel's pitch circle
    wheel, mesh = nearest(found, 1.1), nearest(found, 40.7)
    assert wheel["order"] == pytest.approx(1.1, abs=1e-4)
    assert wheel["amplitude_arcsec"] == pytest.approx(10.0 * at_output, rel=0.02)
    assert wheel["part"] == "shaft 2"
    assert mesh["order"] == pytest.approx(40.7, abs=1e-4)
    assert mesh["amplitude_arcsec"] == pytest.approx(1.5 * at_output, rel=0.02)
    assert mesh["part"].startswith("mesh of worm and wheel")
    assert found["backlash_arcsec"] == pytest.approx(10.0 * at_output, rel=0.02)


PLAY_UM = 10.0
PLAY_ARCSEC = PLAY_UM / 37_000.0 * ARCSEC_PER_RAD * 10.0 / 11.0
"""Of the wheel of module 2 and 37 teeth, seen from the output."""


def marked(turns: float, mark1: float, mark2: float) -> Pulses:
    """Both edges of both encoders on the way there and back."""
    stages = (
        GearStage(
            driver=Gear(teeth=1),
            driven=Gear(teeth=37, eccentricity_um=10.0),
            module_mm=2.0,
            play_um=PLAY_UM,
        ),
        GearStage(driver=Gear(teeth=10), driven=Gear(teeth=11), module_mm=2.0),
    )
    machine = Machine(
        stages=stages,
        input=Encoder(lines=1024, mark=mark1),
        output=Encoder(lines=3600, mark=mark2),
        turns=turns,
        both_senses=True,
        speed_ripple=0.02,
        speed_ripple_hz=7.3,
    )
    (block,) = simulated_pulses(machine)
    return block


def stamped(pulses: Pulses, what: str) -> Pulses:
    """Leave the edges that a port stamps."""
    falls, back = pulses.channel & 64 != 0, pulses.channel & 128 != 0
    keeps = {"both": falls | ~falls, "by sense": falls == back, "rising": ~falls}
    keeps["rising back"] = ~falls | ~back
    return Pulses(pulses.channel[keeps[what]], pulses.t_ns[keeps[what]])


@pytest.mark.parametrize(
    ("what", "turns"),
    [
        ("both", 41.0),
        ("by sense", 41.0006),
        ("rising back", 41.0),
        ("rising back", 41.0006),
        ("rising back", 41.002),
        ("rising back", 41.0025),
    ],
)
def test_backlash_is_that_of_one_flank_whichever_edges_are_stamped(
    tmp_path: Path, what: str, turns: float
) -> None:
    """Each encoder turns back on a mark, and between two of them."""
    write_binary(tmp_path / "pulses.bin", [stamped(marked(turns, 0.3, 0.62), what)])

    found = run(tmp_path)

    assert found["backlash_arcsec"] == pytest.approx(PLAY_ARCSEC, abs=0.1)
    assert not found["warnings"]
    if what != "by sense":
        assert found["mark_widths"]["input"] == pytest.approx(0.3, abs=1e-3)
        assert found["mark_widths"]["output"] == pytest.approx(0.62, abs=1e-3)


def test_rising_edges_alone_tell_no_backlash(tmp_path: Path) -> None:
    """Of 164 arcsec that are not there nothing can be told: no number is given."""
    both = marked(41.0, 0.3, 0.62)
    write_csv(tmp_path / "pulses.csv", [stamped(both, "rising")])
    told = run(tmp_path, pulses="pulses.csv")
    lines = (tmp_path / "pulses.csv").read_text().splitlines()
    (tmp_path / "untold.csv").write_text("\n".join(line.rpartition(",")[0] for line in lines))

    untold = run(tmp_path, pulses="untold.csv")

    assert told["backlash_arcsec"] is None
    assert "rising edges alone were stamped in both senses" in told["warnings"][0]
    assert abs(untold["backlash_arcsec"] - PLAY_ARCSEC) > 100.0
    assert "does not tell rising from falling edges" in untold["warnings"][0]
    assert "391.1″" in untold["warnings"][0]  # a line of either encoder


def test_a_screw_a_load_and_an_encoder_show_at_their_own_orders(tmp_path: Path) -> None:
    machine = Machine(
        stages=(GearStage(driver=Gear(teeth=10), driven=Gear(teeth=407)),),
        output=Encoder(lines=3600, jitter_ns=20.0),
        input=Encoder(lines=1024, eccentricity_um=20.0, radius_mm=25.0),
        screw_lead_mm=10.0,
        screw_error_um=0.5,
        stiffness_nm_per_rad=1e6,
        load_nm=50.0,
        load_ripple_nm=20.0,
        load_ripple_order=6.0,
        turns=162.8,
    )
    write_binary(tmp_path / "pulses.bin", simulated_pulses(machine))

    found = run(tmp_path)

    expected = {
        1.0: 0.5 / 10_000.0 * ARCSEC_PER_TURN,
        6.0: 20.0 / 1e6 * ARCSEC_PER_RAD,
        40.7: 20.0 / 25_000.0 * ARCSEC_PER_RAD / RATIO,
    }
    for order, amplitude in expected.items():
        assert nearest(found, order)["order"] == pytest.approx(order, abs=1e-4)
        assert nearest(found, order)["amplitude_arcsec"] == pytest.approx(amplitude, rel=0.02)


def test_the_page_needs_nothing_else(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(3.0)])

    run(tmp_path, "--html", str(tmp_path / "page.html"))

    page = (tmp_path / "page.html").read_text()
    assert page.count("<svg") == 2
    assert "<script" not in page
    assert "src=" not in page


def test_uneven_samples_with_holes_do_not_move_an_order() -> None:
    random = np.random.default_rng(1)
    place = np.flatnonzero(random.random(36_000) > 0.2)
    turns = place / 3600.0
    samples = 3.0 * np.sin(2.0 * np.pi * 11.577 * turns + 0.3) + random.normal(0.0, 0.1, len(turns))

    fit = fit_orders(turns, samples, 3600.0)

    assert len(fit.orders) == 1
    assert fit.orders[0] == pytest.approx(11.577, abs=1e-4)
    assert abs(fit.waves[0]) == pytest.approx(3.0, rel=0.02)
    assert fit.noise_arcsec == pytest.approx(0.1, rel=0.05)


def test_noise_alone_has_no_order() -> None:
    noise = np.random.default_rng(2).normal(0.0, 1.0, 20_000)

    assert len(fit_orders(np.arange(20_000) / 3600.0, noise, 3600.0).orders) == 0


def test_both_layouts_hold_the_same(tmp_path: Path) -> None:
    block = Pulses(
        np.array([1, 2, 3, 4, 129, 130], dtype=np.uint8), np.arange(0, 600, 100, dtype=np.int64)
    )
    write_csv(tmp_path / "pulses.csv", [block])
    write_binary(tmp_path / "pulses.bin", [block])

    for name in ("pulses.csv", "pulses.bin"):
        (read,) = read_pulses(tmp_path / name)
        assert read.channel.tolist() == block.channel.tolist()
        assert read.t_ns.tolist() == block.t_ns.tolist()


OVERLAP = "channel,t_ns\n" + "".join(f"1,{t}\n" for t in range(100)) + "2,200\n2,300\n2,400\n"
BAD = {
    "time goes back by 150 ns": "channel,t_ns\n1,100\n1,200\n2,50\n",
    "do not overlap": OVERLAP,
    "no pulse of the output": "channel,t_ns\n1,100\n1,200\n",
    ":3: expected whole numbers": "channel,t_ns\n1,100\n2,1x\n",
    ':3: expected whole numbers, found "1.5': "channel,t_ns\n1,100\n1.5,200\n",
    ':3: expected whole numbers, found "2,1_0': "channel,t_ns\n1,0\n2,1_0\n",
    ":3: expected 2 cells, found 1": "channel,t_ns\n1,100\n2",
    ":3: channel: expected 1": "channel,t_ns\n1,100\n7,200\n",
    ":2: t_ns: expected": "channel,t_ns\n1,-100\n2,200\n",
    ":1: expected the columns": "time\n1\n",
    "truncated: the head has 16 bytes": "SKLPULS1",
    "the file is truncated": "channel,t_ns\n1,100\n2,150\n1,20",
    "holds 1 and a part of one": "SKLPULS1" + "\x02" + "\0" * 7 + "\x01" * 13,
    "truncated: the head announces": "SKLPULS1" + "\x01" * 8,
}


@pytest.mark.parametrize(("message", "text"), BAD.items(), ids=BAD.keys())
def test_a_bad_file_is_named(tmp_path: Path, message: str, text: str) -> None:
    path = tmp_path / "pulses.csv"
    path.write_text(text)
    out = tmp_path / "out.json"

    with pytest.raises(InputError) as caught:
        cli.group(["transmission", str(path), *OPTIONS, "--json", str(out)], standalone_mode=False)

    assert str(caught.value).startswith(str(path))
    assert message in str(caught.value)
    assert not out.exists()


@pytest.mark.parametrize("ratio", ["0", "-3", "1/0", "much"])
def test_a_ratio_that_is_none_ends_with_status_2(tmp_path: Path, ratio: str) -> None:
    options = ["--lines1", "10", "--lines2", "10", f"--ratio={ratio}"]

    result = CliRunner().invoke(cli.group, ["transmission", str(tmp_path / "x.csv"), *options])

    assert result.exit_code == cli.BAD_INPUT
    assert "--ratio" in result.output


def test_teeth_that_make_another_ratio_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "train.toml"
    path.write_text(TRAIN.replace("37", "36"))
    options = [*OPTIONS, "--train", str(path)]

    with pytest.raises(InputError, match="ratio of 198/5"):
        cli.group(["transmission", str(tmp_path / "x.csv"), *options], standalone_mode=False)


@pytest.mark.parametrize("magic", [b"SKLPULS3", b"\x00\x01\x02\x03\x04\x05\x06\x07"])
def test_a_wrong_magic_is_told_as_such(tmp_path: Path, magic: bytes) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(0.1)])
    data = (tmp_path / "pulses.bin").read_bytes()
    (tmp_path / "pulses.bin").write_bytes(magic + data[8:])

    with pytest.raises(
        InputError, match=r'a binary file that begins with ".*", expected "SKLPULS1"'
    ):
        next(read_pulses(tmp_path / "pulses.bin"))


def test_less_than_a_turn_has_a_trend_and_no_slow_orders(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(0.6)])

    found = run(tmp_path)

    assert found["orders"][0]["order"] == pytest.approx(40.7, abs=0.02)
    assert found["orders"][0]["amplitude_arcsec"] == pytest.approx(0.785, rel=0.02)
    assert found["noise_arcsec"] < 0.15  # the slow order is no noise
    slow = 4.0 * np.sin(2.0 * np.pi * np.linspace(0.0, 0.6, 100) + np.deg2rad(20.0))
    assert found["trend_arcsec"] == pytest.approx(np.ptp(slow), abs=0.3)
    assert found["limits"]["lowest_order"] == pytest.approx(1.0 / 0.6, rel=0.01)
    assert any("orders below 1.669 are out of reach" in each for each in found["warnings"])


def refusal(folder: Path, *options: str) -> str:
    arguments = ["transmission", str(folder / "pulses.bin"), *OPTIONS, *options]
    result = CliRunner().invoke(cli.group, arguments)
    assert isinstance(result.exception, InputError)
    return str(result.exception)


def test_the_analog_meter_refuses_a_period_that_it_cannot_average(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(6.0)])

    said = refusal(tmp_path, "--method", "phase-analog")

    assert "a period of 2544 ms is too long for the meter's 10 ms" in said
    assert "less than 43.55 ms" in said


def test_digital_comparison_refuses_a_speed_that_it_takes_for_error(tmp_path: Path) -> None:
    turn = np.arange(int(6.0 * LINES2)) / LINES2
    inputs = np.arange(int(6.0 * RATIO * LINES1)) / LINES1 / RATIO

    def at_s(turns: NDArray[np.float64]) -> NDArray[np.float64]:  # by 1 % slower and faster
        return turns * RATIO / SPEED + 0.01 * np.sin(3.0 * turns) * RATIO / SPEED

    write_binary(tmp_path / "pulses.bin", [merged(at_s(inputs) + 0.1, at_s(turn) + 0.1)])

    said = refusal(tmp_path, "--method", "phase-digital")

    assert "a period is 405 000″, and the speed changes by" in said
    assert "hardly more than the speed is seen" in said
    assert run(tmp_path)["total_arcsec"] < 0.1  # which subdivided counting does not mind


def test_digital_comparison_says_which_orders_fold(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(6.0)])

    found = run(tmp_path, "--method", "phase-digital")

    assert found["limits"]["highest_order"] == pytest.approx(1.6, rel=0.01)
    assert found["limits"]["range_arcsec"] == pytest.approx(405_000.0, rel=0.01)
    assert any("orders above 1.6 are out of reach" in each for each in found["warnings"])


def test_within_its_limits_a_method_has_nothing_to_warn_of(tmp_path: Path) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(6.0)])

    for method in ("subdivided", "phase-subdivided"):
        found = run(tmp_path, "--method", method)
        assert found["warnings"] == []
        # 100 ns at 5 rev/s, i = 40.7: 0.016″
        assert found["limits"]["quantum_arcsec"] == pytest.approx(0.0159, rel=0.01)
    direct = run(tmp_path, "--method", "direct")
    assert direct["limits"]["quantum_arcsec"] == pytest.approx(31.1, abs=0.01)
    assert any("a line of the denser train is 31.10″" in each for each in direct["warnings"])


@pytest.mark.parametrize(
    ("option", "value", "turns"),
    [("--lines1", LINES1 * 1.024, 6.0 / 1.024), ("--ratio", RATIO * 1.5, 4.0)],
)
def test_trains_that_did_not_turn_alike_are_told(
    tmp_path: Path, option: str, value: float, turns: float
) -> None:
    write_binary(tmp_path / "pulses.bin", [planted(6.0)])
    given = str(round(value)) if option == "--lines1" else "1221/20"

    right, wrong = run(tmp_path), run(tmp_path, option, given)

    assert not any("check --lines1" in said for said in right["warnings"])
    (told,) = (said for said in wrong["warnings"] if "check --lines1" in said)
    by_input = float(told.split("turned ")[1].split(" times")[0])
    assert by_input == pytest.approx(turns, rel=2e-3)


def test_train_that_begins_later_is_none_of_another_ratio(tmp_path: Path) -> None:
    whole = planted(6.0)
    is_late = (whole.channel == 2) & (whole.t_ns < np.median(whole.t_ns))
    write_binary(tmp_path / "pulses.bin", [Pulses(whole.channel[~is_late], whole.t_ns[~is_late])])

    found = run(tmp_path)

    assert not any("check --lines1" in said for said in found["warnings"])


def test_tick_of_the_clock_is_that_of_both_trains(tmp_path: Path) -> None:
    """Of an input at a steady speed, whose pulses come in whole milliseconds, it is no tick."""
    turn = np.arange(4000) / 1000
    error = 30.0 * np.sin(2.0 * np.pi * turn) / ARCSEC_PER_TURN
    write_binary(tmp_path / "pulses.bin", [merged(turn, turn - error + 1e-4, 1)])
    options = ("--lines1", "1000", "--lines2", "1000", "--ratio", "1")

    found = run(tmp_path, *options)

    assert not any("a tick of the clock" in said for said in found["warnings"])
