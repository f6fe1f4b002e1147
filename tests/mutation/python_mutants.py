"""Mutants of a Python source: small changes, each of which a test should notice.

Docstrings, annotations and decorators are left alone. What stands outside of functions, as the
thresholds of rules do, is changed too; mutmut changes functions alone.
"""

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

COMPARED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
COMPUTED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
CALLED = {"any": "all", "all": "any", "max": "min", "min": "max"}
LEFT_ALONE = {"annotation", "returns", "decorator_list"}
CONDITIONS = {"test", "ifs"}
SLIGHTLY = 0.1
"""By such a share a number with a point is changed: what is exact notices."""


@dataclass(frozen=True, slots=True)
class PythonMutant:
    """One change: where and what it is, and the source that has it."""

    change: str
    text: str


def mutants_of(text: str) -> Iterator[PythonMutant]:
    """Give every mutant of a source.

    They have other comparisons, operators, conditions, numbers 1 or a tenth off, empty texts,
    returns of nothing, and statements left out.
    """
    tree = ast.parse(text)
    for parent, name, index, node in list(_places(tree)):
        for new in (*_instead_of(node), *_without(node), *_negated(name, node)):
            _put(parent, name, index, new)
            where = f"{getattr(node, 'lineno', 0)}:{getattr(node, 'col_offset', 0) + 1}"
            yield PythonMutant(f"{where}: {_shown(node)} => {_shown(new)}", ast.unparse(tree))
        _put(parent, name, index, node)


def _places(parent: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Give each node with where it hangs: its parent, the field there, and where in a list."""
    for name, value in ast.iter_fields(parent):
        if name in LEFT_ALONE:
            continue
        several = isinstance(value, list)
        for index, node in enumerate(value if several else [value]):
            if isinstance(node, ast.AST) and not _is_docstring(node):
                yield parent, name, index if several else None, node
                yield from _places(node)


def _is_docstring(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _put(parent: ast.AST, name: str, index: int | None, node: ast.AST) -> None:
    if index is None:
        setattr(parent, name, node)
    else:
        getattr(parent, name)[index] = node


def _shown(node: ast.AST) -> str:
    """Give the first line of a node's text; of a statement with a body, its condition."""
    return ast.unparse(node).splitlines()[0] if not isinstance(node, ast.JoinedStr) else "text"


def _instead_of(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.Compare(ops=[*several]):
            for index, old in enumerate(several):
                for new in COMPARED[type(old)]:
                    yield _with(node, ops=[*several[:index], new(), *several[index + 1 :]])
        case ast.BoolOp(op=old):
            yield _with(node, op=ast.Or() if isinstance(old, ast.And) else ast.And())
        case ast.BinOp(op=old) if type(old) in COMPUTED:
            yield _with(node, op=COMPUTED[type(old)]())
        case ast.Name(id=name) if name in CALLED:
            yield _with(node, id=CALLED[name])
        case ast.Constant(value=value):
            yield from map(ast.Constant, _other_values(value))


def _without(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand):
            yield operand
        case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
            yield _with(node, value=ast.Constant(None))
        case ast.Expr(value=ast.Call()):
            yield ast.Pass()


def _negated(name: str, node: ast.AST) -> Iterator[ast.AST]:
    """Give the contrary of a condition, but of those that have it already."""
    if name in CONDITIONS and not isinstance(node, ast.Compare | ast.UnaryOp):
        yield ast.UnaryOp(ast.Not(), cast(ast.expr, node))


def _with(node: ast.AST, **fields: object) -> ast.AST:
    changed = copy.copy(node)
    for name, value in fields.items():
        setattr(changed, name, value)
    return changed


def _other_values(value: object) -> Iterator[bool | int | float | str]:
    match value:
        case bool():
            yield not value
        case int():
            yield from (value + 1, value - 1)
        case float():
            near = (value * (1.0 + SLIGHTLY), value * (1.0 - SLIGHTLY)) if value else (SLIGHTLY,)
            yield from (float(f"{other:.6g}") for other in near)
        case str():
            yield "" if value else "mutant"
