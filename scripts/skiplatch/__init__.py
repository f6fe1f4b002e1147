"""Simulate probing with a latched or a polled skip input, and explain the gap.

What is exported here is the documented interface, docs/API.md. Each name is loaded when it is first
asked for, so that a command starts with what it needs alone.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from skiplatch.api.diagnosed import Diagnosis, FoundEffect, ObservableGap, read_diagnosis
    from skiplatch.api.predicted import Prediction
    from skiplatch.api.work import design, diagnose, predict, simulate
    from skiplatch.campaign import (
        Campaign,
        Nominal,
        Touches,
        read_campaign,
        read_conditions,
        read_nominal,
        write_campaign,
    )
    from skiplatch.diagnosis.experiment import Experiment
    from skiplatch.errors import CampaignWarning, InputError
    from skiplatch.simulator.effects import Effect
    from skiplatch.simulator.library import SimulationError

    __version__: str

_MODULES = {
    "api.diagnosed": ("Diagnosis", "FoundEffect", "ObservableGap", "read_diagnosis"),
    "api.predicted": ("Prediction",),
    "api.work": ("design", "diagnose", "predict", "simulate"),
    "campaign": (
        "Campaign",
        "Nominal",
        "Touches",
        "read_campaign",
        "read_conditions",
        "read_nominal",
        "write_campaign",
    ),
    "diagnosis.experiment": ("Experiment",),
    "errors": ("CampaignWarning", "InputError"),
    "simulator.effects": ("Effect",),
    "simulator.library": ("SimulationError",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "Campaign",
    "CampaignWarning",
    "Diagnosis",
    "Effect",
    "Experiment",
    "FoundEffect",
    "InputError",
    "Nominal",
    "ObservableGap",
    "Prediction",
    "SimulationError",
    "Touches",
    "design",
    "diagnose",
    "predict",
    "read_campaign",
    "read_conditions",
    "read_diagnosis",
    "read_nominal",
    "simulate",
    "write_campaign",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401
    if name == "__version__":  # as installed; looked up when asked for, as that takes a while
        from importlib.metadata import version  # noqa: PLC0415

        return version("skiplatch")
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})
