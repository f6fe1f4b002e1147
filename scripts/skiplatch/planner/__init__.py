"""The best probing strategy for a wanted uncertainty, within the limits of a machine."""

from skiplatch.planner.model import Limits, Strategy
from skiplatch.planner.plan import Plan, make_plan
from skiplatch.planner.text import as_json, as_text

__all__ = ["Limits", "Plan", "Strategy", "as_json", "as_text", "make_plan"]
