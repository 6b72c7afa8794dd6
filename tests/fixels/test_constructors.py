"""The constructors that an editor shows are those that the tables of fields make."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest

from workhold import Fence, FlatJaw, Plate, Vise
from workhold.fixels.toolkit import Toolkit


def shown_to_editors(kind: type[Toolkit]) -> ast.arguments:
    """The arguments of the constructor that stands in the source for editors and mypy."""
    tree = ast.parse(Path(str(inspect.getsourcefile(kind))).read_text())
    own = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == kind.__name__)
    [shown] = [
        one
        for node in own.body
        if isinstance(node, ast.If)
        for one in node.body
        if isinstance(one, ast.FunctionDef) and one.name == "__init__"
    ]
    return shown.args


@pytest.mark.parametrize("kind", [Vise, Plate, Fence, FlatJaw])
def test_an_editor_shows_the_constructor_that_there_is(kind: type[Toolkit]) -> None:
    """The same names in the same order, the same ones by name alone, with the same defaults."""
    shown, made = shown_to_editors(kind), inspect.signature(kind).parameters.values()
    empty = inspect.Parameter.empty
    first = len(shown.args) - len(shown.defaults)
    defaults = [empty] * first + [ast.literal_eval(one) for one in shown.defaults]
    by_name = [empty if one is None else ast.literal_eval(one) for one in shown.kw_defaults]
    wanted = [(one.name, one.default) for one in made]
    names = [one.arg for one in (*shown.args, *shown.kwonlyargs)]
    assert list(zip(names[1:], [*defaults[1:], *by_name], strict=True)) == wanted
    assert [one.arg for one in shown.kwonlyargs] == [
        one.name for one in made if one.kind is inspect.Parameter.KEYWORD_ONLY
    ]
