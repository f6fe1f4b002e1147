"""Plans of the bench: what is read, and what is refused with its line and a way out."""

import re
from pathlib import Path

import pytest

from skiplatch.bench.plan import read_plan
from skiplatch.campaign import InputPath
from skiplatch.errors import InputError

PLANS = Path(__file__).parents[2] / "scripts" / "samples" / "plans"
NAMES = ("nominal", "cpu_load", "bus_load", "debounce")

GOOD = """format = "skiplatch-bench-plan/1"
nominal = "believed.toml"
paths = ["plc"]
touches = 7
feeds_mm_min = 300
scan_us = [1000, 4000]
rate_per_s = 10
pulse_us = 20000
approach_mm = 0.2

[load]
debounce_us = 100
"""


def write(folder: Path, text: str) -> Path:
    (folder / "believed.toml").write_text((PLANS / "believed.toml").read_text())
    (folder / "plan.toml").write_text(text)
    return folder / "plan.toml"


def test_period_of_a_busy_process_counts_among_what_a_touch_takes(tmp_path: Path) -> None:
    busy = GOOD.replace("rate_per_s = 10", "rate_per_s = 15")
    read_plan(write(tmp_path, busy))

    with pytest.raises(InputError, match=r"plan.toml:7: 15 touches a second leave 66667 µs"):
        read_plan(write(tmp_path, busy + "cpu_share = 0.5\ncpu_period_us = 20000\n"))


@pytest.mark.parametrize("name", NAMES)
def test_shipped_plans_are_read_and_differ_in_their_load_alone(name: str) -> None:
    plan, nominal = read_plan(PLANS / f"{name}.toml"), read_plan(PLANS / "nominal.toml")

    assert plan.touches == nominal.touches
    assert plan.nominal == nominal.nominal
    assert (plan.load == nominal.load) == (name == "nominal")


def test_single_figures_and_lists_are_both_taken(tmp_path: Path) -> None:
    plan = read_plan(write(tmp_path, GOOD))

    assert plan.paths == (InputPath.PLC,)
    assert plan.feeds_mm_min == (300.0,)
    assert plan.scan_us == (1000, 4000)
    assert plan.load.debounce_us == 100
    assert plan.load.cpu_share == 0.0
    assert plan.believed(1000).plc.scan_us == 1000.0


def test_another_nominal_may_be_given(tmp_path: Path) -> None:
    other = tmp_path / "other.toml"
    other.write_text(
        (PLANS / "believed.toml").read_text().replace("latency_us = 5.0", "latency_us = 9")
    )

    assert read_plan(write(tmp_path, GOOD), other).nominal.skip.latency_us == 9.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("plan/1", "plan/2", r'plan.toml:1: format: expected "skiplatch-bench-plan/1"'),
        ("touches = 7", "touch = 7", r'plan.toml:4: unknown key "touch"; did you mean "touches"'),
        ("touches = 7\n", "", r'plan.toml: missing key "touches"'),
        ("touches = 7", "touches = 0", r"plan.toml:4: touches: expected a whole number from 1 to"),
        ("touches = 7", "touches = 1.5", r"touches: expected a whole number"),
        ("touches = 7", "touches = true", r"touches: expected a whole number"),
        ("touches = 7", "touches = [7]", r"touches: expected a whole number"),
        ("= 300", "= []", r"feeds_mm_min: expected a number from 0.1 to 100000, or a list"),
        ("= 300", '= ["fast"]', r"feeds_mm_min: expected a number"),
        ("4000]", "99]", r"plan.toml:6: scan_us: expected a whole number from 100 to 20000"),
        ('["plc"]', '["plc", "plc"]', r'plan.toml:3: paths: expected a list of "skip", "plc" or'),
        ('["plc"]', '"plc"', r"paths: expected a list"),
        ('["plc"]', "[[]]", r"paths: expected a list"),
        ("debounce_us = 100", "debounce = 1", r'unknown key "load.debounce"'),
        ("[load]\ndebounce_us = 100", "load = 3", r"load: expected a table"),
        ("= 100", "= 65536", r"plan.toml:12: load.debounce_us: expected a whole number from 0"),
        ('"believed.toml"', '"none.toml"', r"none.toml: cannot read: No such file"),
        ('"believed.toml"', "3", r"nominal: expected a text"),
    ],
)
def test_bad_plan_is_told_with_its_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(InputError, match=message) as caught:
        read_plan(write(tmp_path, GOOD.replace(old, new)))
    assert "\n" not in str(caught.value)


def test_machine_is_no_bench(tmp_path: Path) -> None:
    plan = write(tmp_path, GOOD)
    beliefs = tmp_path / "believed.toml"
    beliefs.write_text(beliefs.read_text().replace('"bench"', '"machine"', 1))

    with pytest.raises(InputError, match='kind: expected "bench"'):
        read_plan(plan)


def test_impossible_rate_is_refused_with_one_that_is_possible(tmp_path: Path) -> None:
    fast = GOOD.replace("rate_per_s = 10", "rate_per_s = 50")
    with pytest.raises(InputError, match=r"plan.toml:7: 50 touches a second leave 20000") as caught:
        read_plan(write(tmp_path, fast))

    found = re.search(r"give at most ([0-9.]+)", str(caught.value))
    assert found is not None
    possible = float(found[1])
    assert read_plan(write(tmp_path, GOOD.replace("= 10\n", f"= {possible}\n"))).rate_per_s > 10
    with pytest.raises(InputError, match="touches a second"):
        read_plan(write(tmp_path, GOOD.replace("= 10\n", f"= {possible * 1.02}\n")))
