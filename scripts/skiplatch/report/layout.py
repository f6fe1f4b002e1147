"""Pages of HTML from templates: no script, nothing from elsewhere, light and dark."""

from collections.abc import Sequence
from dataclasses import dataclass

from jinja2 import Environment, PackageLoader, StrictUndefined

from skiplatch.figures.colours import DARK, VARIABLES


@dataclass(frozen=True, slots=True)
class Table:
    """A table of a page: cells are text, the first of a row names it."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


def render(template: str, **content: object) -> str:
    """Fill a template of this package, and give it the colours of both schemes."""
    environment = Environment(
        loader=PackageLoader("skiplatch.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    dark = {variable: DARK[colour] for variable, colour in VARIABLES.items()}
    return environment.get_template(template).render(
        **{"glossary": {}, **content}, light=VARIABLES, dark=dark
    )
