"""What the documented functions refuse: one line that names the argument, as the commands do."""

import math
from collections.abc import Callable
from typing import Any

import pytest

import skiplatch
from hostile import CAMPAIGN
from skiplatch import admitted
from skiplatch.commands import design, diagnose, predict, simulate
from skiplatch.simulator.playing import play
from skiplatch.simulator.rig import Controller

FUNCTIONS: dict[str, Callable[..., Any]] = {
    name: getattr(skiplatch, name) for name in ("simulate", "diagnose", "predict", "design")
}
COMMANDS = {
    "simulate": simulate.command,
    "diagnose": diagnose.command,
    "predict": predict.command,
    "design": design.command,
}
DIAGNOSIS: dict[str, object] = {"diagnosis": {}}
OUT_OF_RANGE = [
    *((name, {"jobs": jobs}) for name in FUNCTIONS for jobs in (0, -1, 2000)),
    *((name, {"seed": seed}) for name in FUNCTIONS for seed in (-1, 2**63)),
    *(("predict", {"replicates": count}) for count in (0, -1)),
    *(("design", {"touches": count}) for count in (0, -1, 1001)),
    *(
        ("diagnose", {name: size})
        for name in ("material_fraction", "material_us", "material_um")
        for size in (math.nan, -1.0, 0.0, math.inf)
    ),
]
OF_NO_KIND = [
    *((name, {"seed": seed}) for name in FUNCTIONS for seed in (1.5, "1", None)),
    *((name, {"jobs": 2.0}) for name in FUNCTIONS),
    ("diagnose", {"material_us": "3"}),
    ("predict", DIAGNOSIS),
    ("predict", {"diagnosis": "d.json"}),
    ("design", DIAGNOSIS),
    ("simulate", {"conditions": "touches.csv"}),
    ("simulate", {"effects": "backlash"}),
    ("simulate", {"effects": ["backlash"]}),
    ("simulate", {"effects": skiplatch.Effect("backlash", {})}),
]


@pytest.fixture(scope="module")
def campaign() -> skiplatch.Campaign:
    return skiplatch.read_campaign(CAMPAIGN)


@pytest.mark.parametrize(("name", "argument"), OUT_OF_RANGE, ids=str)
def test_an_argument_out_of_range_is_named_with_its_range(
    name: str, argument: dict[str, object], campaign: skiplatch.Campaign
) -> None:
    ((key, value),) = argument.items()

    with pytest.raises(ValueError, match=rf"^{key}: expected a .* from \S+ to \S+, got ") as told:
        FUNCTIONS[name](campaign, **argument)

    assert str(told.value).endswith(repr(value))


@pytest.mark.parametrize(("name", "argument"), OF_NO_KIND, ids=str)
def test_an_argument_of_another_kind_is_named_with_what_was_expected(
    name: str, argument: dict[str, object], campaign: skiplatch.Campaign
) -> None:
    with pytest.raises(TypeError, match=rf"^{next(iter(argument))}(\[0\])?: expected ") as told:
        FUNCTIONS[name](campaign, **argument)

    assert "\n" not in str(told.value)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_folder_is_no_campaign(name: str) -> None:
    with pytest.raises(
        TypeError, match=r"expected a Campaign, as read_campaign gives it.* 'camp'$"
    ):
        FUNCTIONS[name]("camp")


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e30])
def test_a_parameter_that_an_effect_cannot_have_is_named(
    value: float, campaign: skiplatch.Campaign
) -> None:
    effect = skiplatch.Effect("isr_latency", {"latency_us": value})

    with pytest.raises(
        skiplatch.SimulationError,
        match=r"^isr_latency\.latency_us: expected a number from -1000 to 5000, got ",
    ):
        skiplatch.simulate(campaign, effects=[effect])


def test_a_parameter_that_is_no_number_is_named(campaign: skiplatch.Campaign) -> None:
    text: Any = "40"

    with pytest.raises(skiplatch.SimulationError, match=r"^isr_latency\.latency_us: .* got '40'$"):
        skiplatch.simulate(
            campaign, effects=[skiplatch.Effect("isr_latency", {"latency_us": text})]
        )


def test_more_effects_than_can_be_played_are_counted(campaign: skiplatch.Campaign) -> None:
    effects = [skiplatch.Effect("isr_latency", {"latency_us": 1.0})] * 9

    with pytest.raises(skiplatch.SimulationError, match="expected at most 8 effects, got 9"):
        skiplatch.simulate(campaign, effects=effects)


def test_nothing_is_played_by_no_thread(campaign: skiplatch.Campaign) -> None:
    controller = Controller.for_campaign(campaign.nominal, campaign.touches)

    with pytest.raises(ValueError, match="jobs: expected a whole number from 1 to 1024, got 0"):
        play(campaign.nominal, controller, campaign.touches, seed=1, jobs=0)


@pytest.mark.parametrize(
    ("name", "option", "table"),
    [
        *((name, "seed", admitted.SEED) for name in COMMANDS),
        *((name, "jobs", admitted.JOBS) for name in COMMANDS),
        ("predict", "replicates", admitted.REPLICATES),
        ("design", "touches", admitted.TOUCHES),
        ("diagnose", "material_fraction", admitted.MATERIAL_FRACTION),
        ("diagnose", "material_us", admitted.MATERIAL_SIZE),
        ("diagnose", "material_um", admitted.MATERIAL_SIZE),
    ],
)
def test_a_command_takes_what_its_function_takes(
    name: str, option: str, table: admitted.Count | admitted.Number
) -> None:
    found = {param.name: param.type for param in COMMANDS[name].params}[option]

    assert (found.min, found.max) == (table.low, table.high)  # type: ignore[attr-defined]
