"""Uncertainty of a compensated probe: a GUM budget, and a Monte Carlo of the same model beside it.

Model: a touch in direction i at the table's feed triggers at r_i = w_i + v_i·τ, and the table is
v_i = v0_i + (W − r̂_i)/τ̂ from a measured map r̂ and a measured delay τ̂. The budget propagates
standard uncertainties to first order (JCGM 100); the Monte Carlo draws map, delay and touches and
computes each table anew through the firmware (JCGM 101). Only it can tell what becomes of V_r: a
range is no linear function of its parts.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from skiplatch.compensation.budget import COVERAGE, Budget, Inputs, budget_of, resolution_um
from skiplatch.compensation.compensate import Compensation
from skiplatch.compensation.monte_carlo import MonteCarlo, draw_tables


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """Budget and Monte Carlo, and the expanded uncertainty of V_r before.

    Attributes:
        budget: See `Budget`.
        monte_carlo: See `MonteCarlo`.
        vr_before_expanded_um: k = 2, to first order: of the difference of two mean radii.
    """

    budget: Budget
    monte_carlo: MonteCarlo
    vr_before_expanded_um: float


def assess(done: Compensation, inputs: Inputs, *, seed: int) -> Uncertainty:
    """Give the budget and the Monte Carlo of a table.

    Raises:
        InputError: The delay is so uncertain that most draws allow no table.
    """
    measured = done.probe_map.repeatability_um
    given = inputs.repeatability_um
    known = replace(inputs, repeatability_um=(measured or 0.0) if given is None else given)
    sigma_um = known.repeatability_um or 0.0
    of_mean_um = math.hypot(sigma_um, resolution_um(known)) / math.sqrt(done.probe_map.runs)
    return Uncertainty(
        budget=budget_of(done, known, measured=given is None),
        monte_carlo=draw_tables(done, known, np.random.default_rng(seed)),
        vr_before_expanded_um=COVERAGE * math.sqrt(2.0) * of_mean_um,
    )
